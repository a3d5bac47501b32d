"""Basis point sets: an object as its distances to fixed points around the person who sees it.

Mueller, Tanke, Gall, "Massively Multi-Person 3D Human Motion Forecasting with Scene Context" (2024), Sec. 3.1;
Prokudin, Lassner, Romero, "Efficient Learning on Point Clouds with Basis Point Sets" (2019). The points are fixed in
the person's own frame and the object is brought there, so one object has another code for everybody who sees it.
Distances are exact instead of to sampled surface points.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache

import numpy as np

from motioncast.core.scene_object import CATEGORIES, SceneObject
from motioncast.core.shapes import surface_distance
from motioncast.core.skeleton import Skeleton

POINTS = 2048
WIDTH = POINTS + len(CATEGORIES)
"""Numbers of a code: distances in metres, then one of thirteen types."""


@cache
def basis_points() -> np.ndarray:
    """The fixed points, ``(2048, 3)`` metres in the person's frame: normal around it, none under the floor.

    The published points follow the same law (x and y with 2 m, z the absolute value of one with 1 m); these are drawn
    anew.

    Example:
        >>> basis_points().shape, float(basis_points()[:, 2].min()) >= 0
        ((2048, 3), True)
    """
    drawn = np.random.default_rng(2061).normal(0, (2.0, 2.0, 1.0), (POINTS, 3))
    drawn[:, 2] = np.abs(drawn[:, 2])
    points = drawn.round(3).astype(np.float32)
    points.setflags(write=False)
    return points


def hip_frame(pose: np.ndarray, skeleton: Skeleton) -> tuple[np.ndarray, np.ndarray]:
    """The frame from which people see objects: the middle of the hips on the floor, x towards the right hip.

    Args:
        pose: ``(..., joints, 3)`` metres, floor at height 0.
        skeleton: Which joint is which.

    Returns:
        Its origin ``(..., 3)`` and the direction of its x axis ``(..., 2)``, for :func:`codes`.

    Example:
        >>> from motioncast.core.skeletons import MRT15
        >>> pose = np.zeros((15, 3))
        >>> pose[MRT15.index("left_hip")], pose[MRT15.index("right_hip")] = (1, 0, 0.9), (1, 0.2, 0.9)
        >>> [part.round(3).tolist() for part in hip_frame(pose, MRT15)]
        [[1.0, 0.1, 0.0], [0.0, 1.0]]
    """
    left, right = (pose[..., skeleton.landmarks.index(f"{side}_hip"), :2] for side in ("left", "right"))
    across, middle = right - left, (left + right) / 2
    length = np.linalg.norm(across, axis=-1, keepdims=True)
    origin = np.concatenate([middle, np.zeros_like(length)], -1)
    return origin, np.where(length > 1e-3, across / np.maximum(length, 1e-3), [1.0, 0.0])


def codes(objects: Sequence[SceneObject], origin: np.ndarray, across: np.ndarray, frame: int = -1) -> np.ndarray:
    """What each person sees of each object.

    Args:
        objects: The objects of a scene.
        origin: Where each person stands, ``(people, 3)``, on the floor.
        across: The direction of each person's own x axis, a horizontal unit vector ``(people, 2)``.
        frame: The frame in which objects that move are looked at.

    Returns:
        ``(people, objects, 2061)`` float32.

    Example:
        >>> chair = SceneObject("chair", "sittable", "box", (0.5, 0.5, 0.5), (1, 0, 0.25))
        >>> seen = codes([chair], np.zeros((1, 3)), np.array([[1.0, 0.0]]))
        >>> seen.shape, int(seen[0, 0, 2048:].argmax()) == CATEGORIES.index("sittable")
        ((1, 1, 2061), True)
    """
    points = basis_points()
    cosine, sine = across[:, None, 0], across[:, None, 1]
    x, y, z = points.T
    world = np.stack([cosine * x - sine * y, sine * x + cosine * y, np.broadcast_to(z, (len(across), POINTS))], -1)
    world = (world + origin[:, None]).astype(np.float32)
    seen = np.zeros((len(origin), len(objects), WIDTH), np.float32)
    for column, thing in enumerate(objects):
        seen[:, column, :POINTS] = surface_distance(thing.at(frame), world)
        seen[:, column, POINTS + CATEGORIES.index(thing.category)] = 1
    return seen
