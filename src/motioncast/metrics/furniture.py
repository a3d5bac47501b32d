"""Do people respect what stands around them? Joints in furniture, seats under who sits, floor under who stands, walls.

Only boxes and cylinders that stand still count: clouds and meshes have no inside and no top. Tops are those of upright
objects, which are turned about the vertical only. Compare each figure with its value for real motion: joints are
points within bodies, and the furniture of composed rooms is inferred, so that real people, too, touch it here and
there.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from motioncast.core.scene_object import SceneObject
from motioncast.core.shapes import signed_distance
from motioncast.core.skeleton import Skeleton
from motioncast.metrics.alignment import root_joints

SITTING_M = (0.30, 0.65)
"""Height of the pelvis above the floor on a chair."""

LEVEL_RAD, SLOPING_RAD = np.radians(35), np.radians(50)
"""Thighs are at most this far from level on a chair, and on a high stool."""

BEFORE_M = 0.22
"""On a high stool the feet are this far before the pelvis: without a seat the body would fall."""

STILL_M_S, STILL_S = 0.15, 0.5
"""Who sits keeps the pelvis slower than this for so long; a squat or a jump is no seat."""

SEAT_M = 0.20
"""A seat holds whose pelvis is at most this far above its top: 10 cm of flesh, and 10 cm of tolerance."""

ANKLE_M = 0.16
"""A foot stands on what is at most this far below its ankle: about 9 cm, and a raised heel."""

WALL_M = 1.0
"""What is lower is a step or a ledge, and can be crossed."""

SUNK_M = 0.03
"""Joints this far below a top still count as above it: cushions give way."""


def joint_depth(things: Sequence[SceneObject], motion: np.ndarray, sitting: np.ndarray | None = None) -> np.ndarray:
    """How deep each joint is inside the object in which it is deepest, ``(..., joints)`` metres; 0 outside of all.

    Args:
        things: The objects.
        motion: ``(..., joints, 3)`` metres, one body each.
        sitting: ``(...)``: who sits (:func:`sits`). Seats do not count for them: a body sinks into what it sits on.

    Example:
        >>> box = SceneObject("box 1", "table", "box", (2, 2, 1), (0, 0, 0.5))
        >>> joint_depth([box], np.array([[0.0, 0.0, 0.9], [0.0, 0.0, 1.2]])).round(3)
        array([0.1, 0. ])
    """
    motion = np.asarray(motion, np.float64)
    deepest = np.zeros(motion.shape[:-1])
    for thing in things:
        if thing.shape not in ("box", "cylinder"):
            continue
        near = _within(motion - thing.position, thing.size / 2)
        if sitting is not None and thing.category == "sittable":
            near &= ~sitting[..., None]
        if near.any():
            deepest[near] = np.maximum(deepest[near], -signed_distance(thing, motion[near]))
    return deepest


class Legs(NamedTuple):
    """Joints that tell who sits and who stands.

    Attributes:
        root: The pelvis, or both hips where there is none (:func:`motioncast.metrics.alignment.root_joints`).
        hips: Left and right hip.
        knees: Left and right knee.
        ankles: Left and right ankle.
    """

    root: tuple[int, ...]
    hips: tuple[int, int]
    knees: tuple[int, int]
    ankles: tuple[int, int]

    @classmethod
    def of(cls, skeleton: Skeleton) -> Legs:
        """Those of a skeleton."""
        pairs = ((skeleton.landmarks.index(f"left_{place}"), skeleton.landmarks.index(f"right_{place}"))
                 for place in ("hip", "knee", "ankle"))  # fmt: skip
        return cls(root_joints(skeleton), *pairs)


def sits(motion: np.ndarray, legs: Legs, fps: float, floor_m: float = 0.0) -> np.ndarray:
    """Who sits, ``(..., time)``.

    The pelvis hardly moves for half a second, and either it is 30 to 65 cm above the floor with both thighs within 35
    degrees of level, or it is higher, both thighs are within 50 degrees of level, and the feet are so far before it
    that only a seat can carry it.

    Args:
        motion: ``(..., time, joints, 3)`` metres, z up.
        legs: The joints.
        fps: Frames a second.
        floor_m: Height of the floor.
    """
    motion = np.asarray(motion, np.float64)
    root = motion[..., list(legs.root), :].mean(-2)
    thighs = motion[..., list(legs.knees), :] - motion[..., list(legs.hips), :]
    slope = np.arctan2(np.abs(thighs[..., 2]), np.linalg.norm(thighs[..., :2], axis=-1)).max(-1)
    ahead = thighs[..., :2].mean(-2)
    feet = motion[..., list(legs.ankles), :2].mean(-2) - root[..., :2]
    before = (feet * ahead).sum(-1) / np.maximum(np.linalg.norm(ahead, axis=-1), 1e-9)
    height = root[..., 2] - floor_m
    chair = (height <= SITTING_M[1]) & (slope <= LEVEL_RAD)
    stool = (height > SITTING_M[1]) & (slope <= SLOPING_RAD) & (before >= BEFORE_M)
    speed = np.linalg.norm(np.diff(root, axis=-2), axis=-1) * fps
    still = np.concatenate([speed[..., :1], speed], -1) < STILL_M_S
    return _lasting(still & (height >= SITTING_M[0]) & (chair | stool), round(STILL_S * fps))


def _lasting(mask: np.ndarray, frames: int) -> np.ndarray:
    """Where a mask ``(..., time)`` holds for so many frames in a row or more."""
    ends = [(0, 0)] * (mask.ndim - 1) + [(frames - 1, frames - 1)]
    whole = np.all(np.lib.stride_tricks.sliding_window_view(np.pad(mask, ends), frames, axis=-1), -1)
    return np.any(np.lib.stride_tricks.sliding_window_view(whole, frames, axis=-1), -1)


def stands(motion: np.ndarray, legs: Legs, floor_m: float = 0.0) -> np.ndarray:
    """Who is upright, ``(...)``: the pelvis is more than 65 cm above the floor. Who sits on a high stool is, too.

    Args:
        motion: ``(..., joints, 3)`` metres, z up.
        legs: The joints.
        floor_m: Height of the floor.
    """
    return motion[..., list(legs.root), 2].mean(-1) - floor_m > SITTING_M[1]


def above_top(things: Sequence[SceneObject], points: np.ndarray, floor_m: float = -np.inf) -> np.ndarray:
    """How high points are above the highest top below them, ``(...)`` metres.

    Args:
        things: The objects whose tops count.
        points: ``(..., 3)`` metres.
        floor_m: Height of the floor. Default: there is none.

    Returns:
        Infinite where nothing is below; negative where a point is up to 3 cm below the top, or below the floor.

    Example:
        >>> stool = SceneObject("stool 1", "sittable", "cylinder", (0.4, 0.4, 0.5), (0, 0, 0.25))
        >>> above_top([stool], np.array([[0.1, 0.0, 0.6], [0.5, 0.0, 0.6]]), floor_m=0.0).round(3)
        array([0.1, 0.6])
    """
    flat = np.asarray(points, np.float64).reshape(-1, 3)
    highest = np.full(len(flat), float(floor_m))
    for thing in things:
        if thing.shape not in ("box", "cylinder"):
            continue
        top, half = thing.position[2] + thing.size[2] / 2, thing.size[:2] / 2
        near = (flat[:, 2] >= top - SUNK_M) & _within(flat[:, :2] - thing.position[:2], half)
        if not near.any():
            continue
        aside = np.abs(thing.inward(flat[near])[:, :2])
        near[near] = (aside <= half).all(-1) if thing.shape == "box" else np.linalg.norm(aside, axis=-1) <= half[0]
        highest[near] = np.maximum(highest[near], top)
    return (flat[:, 2] - highest).reshape(np.shape(points)[:-1])


def _within(away: np.ndarray, half: np.ndarray) -> np.ndarray:
    """Whether points ``(..., 2)`` or ``(..., 3)`` from the middle of a thing are in the ball around it, however turned.

    Most are not: what is looked at closely is little.
    """
    return np.einsum("...i,...i", away, away) <= half @ half


def seated(things: Sequence[SceneObject], motion: np.ndarray, legs: Legs) -> np.ndarray:
    """Who has a seat under the pelvis, at most 20 cm below it, ``(...)``.

    Ask it of those who sit (:func:`sits`).

    Args:
        things: The objects; those of the category ``sittable`` are seats.
        motion: ``(..., joints, 3)`` metres, z up.
        legs: The joints.
    """
    seats = [thing for thing in things if thing.category == "sittable"]
    return above_top(seats, motion[..., list(legs.root), :].mean(-2)) <= SEAT_M


def grounded(things: Sequence[SceneObject], motion: np.ndarray, legs: Legs, floor_m: float = 0.0) -> np.ndarray:
    """Whose lower ankle is at most 16 cm above the floor or a top below it, and at most 3 cm under it, ``(...)``.

    Ask it of those who stand (:func:`stands`) and do not sit.

    Args:
        things: The objects: any may be a step.
        motion: ``(..., joints, 3)`` metres, z up.
        legs: The joints.
        floor_m: Height of the floor.
    """
    pair = motion[..., list(legs.ankles), :]
    lower = np.take_along_axis(pair, pair[..., 2].argmin(-1)[..., None, None], -2)[..., 0, :]
    height = above_top(things, lower, floor_m)
    return (height >= -SUNK_M) & (height <= ANKLE_M)


def crosses(things: Sequence[SceneObject], path: np.ndarray) -> np.ndarray:
    """In which steps a path over the ground goes through a wall, ``(..., time - 1)``.

    A step is the straight line between two frames, so that nobody slips through a thin wall between them.

    Args:
        things: The objects; boxes of the category ``occluder`` that are at least a metre high are walls.
        path: ``(..., time, 2)`` metres (:func:`motioncast.metrics.paths.root_path`).

    Example:
        >>> wall = SceneObject("wall 1", "occluder", "box", (0.1, 4, 2.5), (1, 0, 1.25))
        >>> crosses([wall], np.array([[0.0, 0.0], [0.5, 0.0], [1.5, 0.0], [1.5, 9.0]]))
        array([False,  True, False])
    """
    path = np.asarray(path, np.float64)
    hit = np.zeros((*path.shape[:-2], path.shape[-2] - 1), bool)
    for thing in things:
        if thing.category != "occluder" or thing.shape != "box" or thing.size[2] < WALL_M:
            continue
        level = np.concatenate([path, np.full((*path.shape[:-1], 1), thing.position[2])], -1)
        place, half = thing.inward(level)[..., :2], thing.size[:2] / 2
        start, step = place[..., :-1, :], np.diff(place, axis=-2)
        # the line is between both faces of a pair from one share of the step to another; a step along them always or
        # never
        step = np.where(np.abs(step) < 1e-12, 1e-12, step)
        faces = np.stack([(-half - start) / step, (half - start) / step])
        enters, leaves = faces.min(0).max(-1), faces.max(0).min(-1)
        hit |= (enters <= leaves) & (leaves >= 0) & (enters <= 1)
    return hit


def nearest_of_kind(things: Sequence[SceneObject], used: SceneObject, places: np.ndarray) -> np.ndarray:
    """Whether the used object is the nearest of its category to places, ``(...)``.

    The share of forecasts that end at the used object is the goal accuracy; one who guesses among k of a kind
    reaches 1 / k.

    Args:
        things: The objects, the used one among them.
        used: What the person truly went to.
        places: ``(..., 3)`` metres, such as where pelvises end.

    Example:
        >>> one, other = (SceneObject(f"sink {x}", "sink", "box", (1, 1, 1), (x, 0, 0.5)) for x in (0, 3))
        >>> nearest_of_kind([one, other], other, np.array([[1.0, 0.0, 0.9], [2.0, 0.0, 0.9]]))
        array([False,  True])
    """
    decoys = [thing for thing in things if thing.category == used.category and thing is not used]
    distances = [signed_distance(thing, places) for thing in (used, *decoys)]
    return np.min(distances, 0) == distances[0]
