"""The grid of characteristic poses: a cube of voxels around a person's hip.

Diller, Funkhouser and Dai, "Forecasting Characteristic 3D Poses of Human Actions" (CVPR 2022), Sec. 3.4: 16 voxels of
0.125 m along each edge of a cube of 2 m. The cube does not lean: its z axis is the world's, and x points from the
person's left to its right, so that a scene that is turned has the same voxels.
"""

from __future__ import annotations

import numpy as np

from motioncast.core.skeleton import Skeleton

SIDE_M = 2.0
CELLS = 16
"""Voxels along an edge."""


def cell_of(points: np.ndarray, cells: int = CELLS) -> np.ndarray:
    """The voxel that holds each point, ``(..., 3)`` whole numbers; points outside count to the nearest one.

    Args:
        points: ``(..., 3)`` metres, hip-centred.
        cells: Voxels along an edge.

    Example:
        >>> cell_of(np.array([[0.0, -0.01, 3.0]])).tolist()
        [[8, 7, 15]]
    """
    return np.clip(np.floor((points / SIDE_M + 0.5) * cells), 0, cells - 1).astype(int)


def corner_of(cell: np.ndarray, cells: int = CELLS) -> np.ndarray:
    """The lower corner of voxels, ``(..., 3)`` metres: offsets are counted from there.

    Example:
        >>> corner_of(np.array([8, 7, 15])).tolist()
        [0.0, -0.125, 0.875]
    """
    return (cell / cells - 0.5) * SIDE_M


def numbered(cells: int = CELLS) -> np.ndarray:
    """The voxel of each number, ``(cells^3, 3)``: z runs fastest."""
    return np.stack(np.unravel_index(np.arange(cells**3), (cells,) * 3), -1)


def across(pose: np.ndarray, skeleton: Skeleton) -> np.ndarray:
    """The x axis of people's cubes: from left to right along hips and shoulders, a horizontal unit vector.

    Args:
        pose: ``(..., joints, 3)`` metres, z up.
        skeleton: Which joint is which.

    Returns:
        ``(..., 2)``; world x where hips and shoulders lie one above the other.
    """
    left, right = (
        [skeleton.landmarks.index(f"{side}_{place}") for place in ("hip", "shoulder")] for side in ("left", "right")
    )
    line = (pose[..., right, :2] - pose[..., left, :2]).sum(-2)
    length = np.linalg.norm(line, axis=-1, keepdims=True)
    return np.where(length > 1e-3, line / np.maximum(length, 1e-3), [1.0, 0.0])


def turned_back(vectors: np.ndarray, axis: np.ndarray) -> np.ndarray:
    """World vectors ``(..., 3)`` as seen in a cube whose x axis is ``axis`` ``(..., 2)``."""
    return turned(vectors, axis * np.array([1.0, -1.0]))


def turned(vectors: np.ndarray, axis: np.ndarray) -> np.ndarray:
    """Vectors ``(..., 3)`` of a cube in the world; the inverse of :func:`turned_back`.

    Example:
        >>> turned(np.array([1.0, 0.0, 5.0]), np.array([0.0, 1.0])).tolist()
        [0.0, 1.0, 5.0]
    """
    cosine, sine = axis[..., 0], axis[..., 1]
    x, y, z = np.moveaxis(vectors, -1, 0)
    return np.stack([cosine * x - sine * y, sine * x + cosine * y, z + 0 * cosine], -1)


def hip_centred(motion: np.ndarray, axis: np.ndarray, root: int = 0) -> np.ndarray:
    """Motion as the model sees it: each frame around its own hip, turned into the cube.

    The hip itself would always be at the origin; its row tells where it was as seen from the last frame instead.

    Args:
        motion: ``(..., time, joints, 3)`` metres, world.
        axis: x axes of the cubes (:func:`across` of the last frame), ``(..., 2)``.
        root: The joint of the hip.
    """
    hip = motion[..., root, :]
    around = motion - hip[..., None, :]
    around[..., root, :] = hip - hip[..., -1:, :]
    return turned_back(around, axis[..., None, None, :])
