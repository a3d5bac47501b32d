"""Do people respect what stands around them? Joints in furniture, seats under who sits, floor under who stands, walls.

Only boxes and cylinders that stand still count: clouds and meshes have no inside and no top. Tops are those of upright
objects, which are turned about the vertical only. Compare each figure with its value for real motion: joints are
points within bodies, and the furniture of composed rooms is inferred, so that real people, too, touch it here and
there.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from motioncast.core.scene_object import SceneObject
from motioncast.core.shapes import signed_distance

SITTING_M = (0.30, 0.65)
"""Height of the middle of the hips above the floor while somebody sits; above it somebody stands."""

LEVEL_RAD = np.radians(35)
"""Thighs of who sits are at most this far from level."""

SEAT_M = 0.20
"""A seat holds whose hips are at most this far above its top: 10 cm within the flesh, and 10 cm of tolerance."""

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


def sits(motion: np.ndarray, hips: tuple[int, int], knees: tuple[int, int], floor_m: float = 0.0) -> np.ndarray:
    """Who sits, ``(...)``: hips 30 to 65 cm above the floor, and both thighs within 35 degrees of level.

    Args:
        motion: ``(..., joints, 3)`` metres, z up.
        hips: Left and right hip.
        knees: Left and right knee.
        floor_m: Height of the floor.

    Example:
        >>> hips, knees, feet = ([[-0.1, y, z], [0.1, y, z]] for y, z in ((0, 0.5), (0.4, 0.45), (0.4, 0.1)))
        >>> bool(sits(np.array(hips + knees), (0, 1), (2, 3))), bool(sits(np.array(hips + feet), (0, 1), (2, 3)))
        (True, False)
    """
    thighs = motion[..., list(knees), :] - motion[..., list(hips), :]
    level = np.arctan2(np.abs(thighs[..., 2]), np.linalg.norm(thighs[..., :2], axis=-1)) <= LEVEL_RAD
    height = _hip_height(motion, hips, floor_m)
    return (SITTING_M[0] <= height) & (height <= SITTING_M[1]) & level.all(-1)


def stands(motion: np.ndarray, hips: tuple[int, int], floor_m: float = 0.0) -> np.ndarray:
    """Who stands or walks, ``(...)``: the hips are more than 65 cm above the floor.

    Args:
        motion: ``(..., joints, 3)`` metres, z up.
        hips: Left and right hip.
        floor_m: Height of the floor.
    """
    return _hip_height(motion, hips, floor_m) > SITTING_M[1]


def _hip_height(motion: np.ndarray, hips: tuple[int, int], floor_m: float) -> np.ndarray:
    return motion[..., list(hips), 2].mean(-1) - floor_m


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


def seated(things: Sequence[SceneObject], motion: np.ndarray, hips: tuple[int, int]) -> np.ndarray:
    """Who has a seat under the middle of the hips, at most 20 cm below it, ``(...)``.

    Ask it of those who sit (:func:`sits`).

    Args:
        things: The objects; those of the category ``sittable`` are seats.
        motion: ``(..., joints, 3)`` metres, z up.
        hips: Left and right hip.
    """
    seats = [thing for thing in things if thing.category == "sittable"]
    return above_top(seats, motion[..., list(hips), :].mean(-2)) <= SEAT_M


def grounded(
    things: Sequence[SceneObject], motion: np.ndarray, ankles: tuple[int, int], floor_m: float = 0.0
) -> np.ndarray:
    """Whose lower ankle is at most 16 cm above the floor or a top below it, and at most 3 cm under it, ``(...)``.

    Ask it of those who stand (:func:`stands`).

    Args:
        things: The objects: any may be a step.
        motion: ``(..., joints, 3)`` metres, z up.
        ankles: Left and right ankle.
        floor_m: Height of the floor.
    """
    pair = motion[..., list(ankles), :]
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
