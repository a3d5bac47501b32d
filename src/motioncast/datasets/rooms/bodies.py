"""A body seen as a rod puppet: where it faces, and its bones of constant length."""

from __future__ import annotations

import numpy as np

from motioncast.core.skeletons import CMU31

PELVIS, LEFT_HIP, RIGHT_HIP = (CMU31.index(name) for name in ("root", "lhipjoint", "rhipjoint"))
BONES = CMU31.bones


def facing(positions: np.ndarray) -> np.ndarray:
    """Direction in which people look by their hips, angle about the vertical from the x axis, ``(...)`` radians.

    Args:
        positions: ``(..., 31, 3)``.
    """
    across = positions[..., LEFT_HIP, :2] - positions[..., RIGHT_HIP, :2]
    return np.arctan2(-across[..., 0], across[..., 1])


def turned(points: np.ndarray, angle: np.ndarray | float) -> np.ndarray:
    """Points ``(..., 2)`` or ``(..., 3)`` turned about the vertical by angles ``(...)`` that broadcast."""
    cosine, sine = np.cos(angle), np.sin(angle)
    x, y = points[..., 0], points[..., 1]
    return np.stack([cosine * x - sine * y, sine * x + cosine * y, *np.moveaxis(points[..., 2:], -1, 0)], -1)


def bone_lengths(positions: np.ndarray) -> np.ndarray:
    """Median length of the bone that ends in each joint, ``(31,)`` metres; the root's is 0.

    Args:
        positions: One person, ``(time, 31, 3)``.
    """
    lengths = np.zeros(len(CMU31))
    for joint, parent in BONES:
        lengths[joint] = np.median(np.linalg.norm(positions[:, joint] - positions[:, parent], axis=-1))
    return lengths


def with_lengths(positions: np.ndarray, lengths: np.ndarray) -> np.ndarray:
    """The same root and the same directions of bones, with the given lengths, ``(time, 31, 3)``."""
    mended = np.array(positions)
    for joint, parent in BONES:
        bone = positions[:, joint] - positions[:, parent]
        size = np.linalg.norm(bone, axis=-1, keepdims=True)
        mended[:, joint] = mended[:, parent] + bone * (lengths[joint] / np.maximum(size, 1e-9))
    return mended
