"""Futures kept out of things and of strangers: who would be inside is carried aside, pose and all.

A denoiser that has seen a few hours of rooms walks into a table now and then. Its word on poses is kept; bodies are
moved over the ground, along one direction for each stay in a thing or in another's place, so smoothly that the pace
and the seam with the past hardly change, and never far.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from motioncast.core.scene_object import SceneObject
from motioncast.core.skeleton import Skeleton
from motioncast.core.solids import Solids
from motioncast.metrics.furniture import Legs, sits

CLEAR_M = 0.01
"""What is left between a joint and a thing."""

APART_M = 0.7
"""Distance that people keep between their pelvises, unless they were nearer in the past: then that."""

EASE_S = 1.0
"""A body begins to be moved so long before it has to be, and is back so long after."""

FARTHEST_M = 1.0
"""Nobody is moved farther: what lies deeper stays."""

ROUNDS = 6
"""So many stays of a person in things are mended."""

REACH_M = 1.3
"""No joint is farther from the pelvis, over the ground."""

EVERY, INSIDE = 5, 20.0
"""To choose a way, every fifth frame is looked at, and to be a centimetre inside things counts as 20 cm of way."""


def kept_clear(
    history: np.ndarray,
    future: np.ndarray,
    objects: Sequence[SceneObject],
    skeleton: Skeleton,
    fps: float,
    floor_m: float = 0.0,
) -> np.ndarray:
    """A future in which nobody is where something or a stranger is, as far as a smooth way aside goes.

    Seats do not move who sits for a second or more, and clouds and meshes nobody: they have no inside.

    Args:
        history: ``(time, people, joints, 3)`` metres.
        future: What follows, in the same world.
        objects: What stands there.
        skeleton: The joints.
        fps: Frames a second.
        floor_m: Height of the floor.

    Returns:
        Shaped as ``future``; heights and poses are as they were.
    """
    legs, ease = Legs.of(skeleton), round(EASE_S * fps)
    sitters = sits(future.swapaxes(0, 1), legs, fps, floor_m).sum(-1) > ease
    clear = apart(history, future.astype(np.float64), sitters, legs, ease)
    everything = Solids.of(objects)
    no_seats = Solids.of([thing for thing in objects if thing.category != "sittable"])
    for person, sitter in enumerate(sitters):
        clear[:, person] = out_of_things(clear[:, person], no_seats if sitter else everything, legs, ease)
    return clear.astype(future.dtype)


def apart(history: np.ndarray, future: np.ndarray, sitters: np.ndarray, legs: Legs, ease: int) -> np.ndarray:
    """A future ``(time, people, joints, 3)`` in which people give way to one another, and all to who sits."""
    past, future = pelvis(history, legs), future.copy()
    for one in range(future.shape[1]):
        for other in range(one):
            free = ~sitters[[one, other]]
            if not free.any():
                continue
            distance = min(APART_M, float(np.linalg.norm(past[:, one] - past[:, other], axis=-1).min()))
            between = pelvis(future[:, one], legs) - pelvis(future[:, other], legs)
            for frames in stays(np.linalg.norm(between, axis=-1) < distance, ease):
                along, need = min(ways_apart(between, frames, distance), key=lambda way: float(way[1].max()))
                way = gradual(need, frames, ease)[:, None, None] * np.append(along, 0) / free.sum()
                future[:, one] += free[0] * way
                future[:, other] -= free[1] * way
    return future


def ways_apart(between: np.ndarray, frames: slice, distance: float) -> list[tuple[np.ndarray, np.ndarray]]:
    """Three ways to keep two people apart: a direction ``(2,)``, and how far in each frame ``(time,)``.

    To either side of the way that they go by one another, and away from one another where they are nearest.

    Args:
        between: From one to the other over the ground, ``(time, 2)``.
        frames: When they are too near.
        distance: That is to be kept.

    Example:
        >>> along, need = ways_apart(np.array([[0.3, 0.4], [3.0, 4.0]]), slice(0, 1), distance=0.7)[-1]
        >>> along.tolist(), need.round(2).tolist()
        ([0.6, 0.8], [0.2, 0.0])
    """
    near = between[frames]
    nearest, passed = near[np.linalg.norm(near, axis=-1).argmin()], near[-1] - near[0]
    found = []
    for along in (passed[::-1] * [1, -1], passed[::-1] * [-1, 1], nearest):
        along = along / max(float(np.linalg.norm(along)), 1e-6)
        beside = between @ along
        missing = distance**2 - np.square(between).sum(-1)
        found.append((along, np.where(missing > 0, np.sqrt(np.maximum(missing + beside**2, 0)) - beside, 0)))
    return found


def out_of_things(body: np.ndarray, things: Solids, legs: Legs, ease: int) -> np.ndarray:
    """One person's future ``(time, joints, 3)``, moved out of each thing on the side where least is in the way."""
    near = things.near(pelvis(body, legs), REACH_M)
    for _ in range(ROUNDS):
        depth = near.depth(body)
        if not depth.any():
            break
        deepest = int(depth.sum(1).argmax())
        frames = max(stays(depth[deepest] > 0, ease), key=lambda stay: float(depth[deepest, stay].sum()))
        found = [
            gradual(need, frames, ease)[:, None] * along for along, need in ways_out(near[deepest : deepest + 1], body)
        ]
        ways = np.array([way for way in found if np.abs(way).max() <= FARTHEST_M])
        if not len(ways):
            break
        moved = body + ways[:, :, None]
        inside = near.depth(moved[:, ::EVERY]).max(0).mean(-1)
        body = moved[(np.abs(ways).max((1, 2)) + INSIDE * inside).argmin()]
    return body


def ways_out(thing: Solids, body: np.ndarray) -> list[tuple[np.ndarray, np.ndarray]]:
    """The four ways out of one thing: a horizontal direction ``(3,)``, and how far in each frame ``(time,)``.

    Example:
        >>> table = Solids.of([SceneObject("table", "table", "box", (2, 1, 1), (0, 0, 0.5))])
        >>> ways = ways_out(table, np.array([[[0.9, 0, 0.5]]]))
        >>> [(along[:2].round(2).tolist(), need.round(2).tolist()) for along, need in ways]
        [([1.0, 0.0], [0.11]), ([-1.0, -0.0], [1.91]), ([0.0, 1.0], [0.51]), ([-0.0, -1.0], [0.51])]
    """
    own, half = thing.inward(body)[0], thing.halves[0] + CLEAR_M
    found = []
    for axis, across in ((0, 1), (1, 0)):
        aside = np.abs(own[..., across])
        level = (aside < half[across]) & (np.abs(own[..., 2]) < half[2])
        deep = np.sqrt(np.maximum(half[0] ** 2 - aside**2, 0)) if thing.round[0] else half[axis]
        for sign in (1.0, -1.0):
            place, need = sign * own[..., axis], np.zeros(len(body))
            for _ in range(3):  # who is moved out may bring another joint in
                touches = level & (np.abs(place + need[:, None]) < deep)
                need = np.where(touches, deep - place, need[:, None]).max(-1)
            found.append((sign * thing.axes[0, :, axis] * [1, 1, 0], need))
    return found


def stays(inside: np.ndarray, ease: int) -> list[slice]:
    """Where a mask ``(time,)`` holds, in runs; gaps of less than an easing are no way back.

    Example:
        >>> stays(np.array([0, 1, 1, 0, 1, 0, 0, 0, 1], bool), 3)
        [slice(1, 5, None), slice(8, 9, None)]
    """
    frames = np.flatnonzero(inside)
    runs = np.split(frames, np.flatnonzero(np.diff(frames) > ease) + 1)
    return [slice(int(run[0]), int(run[-1]) + 1) for run in runs if len(run)]


def gradual(need: np.ndarray, frames: slice, ease: int) -> np.ndarray:
    """At least the need ``(time,)`` of some frames, and none of others, smoothly; 0 at now, and at rest there.

    The greatest need within an easing, and its mean, weighted by a bell, within as much.

    Example:
        >>> gradual(np.array([0, 0, 0, 0, 1, 0, 0, 0, 2.0]), slice(4, 5), 2).round(2).tolist()
        [0.0, 0.17, 0.67, 0.92, 1.0, 0.92, 0.67, 0.33, 0.08]
    """
    window = np.lib.stride_tricks.sliding_window_view
    counted = np.zeros(len(need))
    counted[frames] = need[frames]
    most = window(np.pad(counted, 2 * ease, mode="edge"), 2 * ease + 1).max(-1)
    bell = np.hanning(2 * ease + 3)[1:-1]
    begin = np.minimum(np.arange(len(need)) / ease, 1)
    return (window(most, 2 * ease + 1) @ bell) / bell.sum() * begin**2 * (3 - 2 * begin)


def pelvis(motion: np.ndarray, legs: Legs) -> np.ndarray:
    """Where people are over the ground, ``(..., 2)``."""
    return motion[..., list(legs.root), :2].mean(-2)
