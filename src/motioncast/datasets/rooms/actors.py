"""An actor: the walk of one subject, the build, and what the subject really did on the spot."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from motioncast.datasets.rooms.bodies import PELVIS
from motioncast.datasets.rooms.clips import Clip
from motioncast.datasets.rooms.contacts import FEET, FPS, foot_contact, smoothed, speed
from motioncast.datasets.rooms.figure import Figure, figure_of
from motioncast.datasets.rooms.gait import Gait, gait_of
from motioncast.datasets.rooms.steps import landed
from motioncast.datasets.rooms.stitch import BLEND, MIDDLE


@dataclass(frozen=True, slots=True, eq=False)
class Actor:
    """A person who can walk, stop, act and walk on.

    Attributes:
        gait: The walk.
        figure: The build.
        landings: For each frame of the gait which foot has just landed, 0 left, 1 right, -1 none.
        starts: Frames of the gait in which a walk can begin.
        scenes: Real stretches on the spot that begin and end standing, and their takes.
    """

    gait: Gait
    figure: Figure
    landings: np.ndarray
    starts: np.ndarray
    scenes: tuple[tuple[str, np.ndarray], ...]


def actor_of(clips: Sequence[Clip]) -> Actor | None:
    """The actor of one subject's clips, or None where there is no walk, or no frame in which it could begin."""
    gait = gait_of(clips)
    if gait is None:
        return None
    landings = landed(gait.positions, gait.looks)
    index = np.arange(len(gait))
    fits = (landings >= 0) & (index - gait.firsts >= 2) & (gait.ends - index > BLEND + 2)
    ahead = np.minimum(index + 1 + MIDDLE, len(gait) - 1)
    starts = np.flatnonzero(fits & (gait.onward[ahead, 0] >= 0))
    if not len(starts):
        return None
    figure = figure_of(gait)
    scenes = tuple((clip.name, scene) for clip in clips for scene in on_the_spot(clip.positions[:, 0], figure.height))
    return Actor(gait, figure, landings, starts, scenes)


def standing(positions: np.ndarray, height: float) -> np.ndarray:
    """In which frames somebody ``(time, 31, 3)`` stands upright on both feet, ``(time,)`` bool."""
    upright = np.abs(positions[:, PELVIS, 2] / height - 1) < 0.1
    return foot_contact(positions).all(-1) & upright & (speed(positions[:, [PELVIS]])[:, 0] < 0.3)


def on_the_spot(positions: np.ndarray, height: float) -> list[np.ndarray]:
    """Stretches of a take that begin and end standing and stay within a circle of 0.8 m on the floor."""
    found, first = [], 0
    stands = standing(positions, height)
    low = smoothed(positions[:, FEET, 2].min(-1), 4) < 0.1
    while first < len(positions) - 3 * FPS:
        if not stands[first]:
            first += 1
            continue
        away = np.linalg.norm(positions[first:, PELVIS, :2] - positions[first, PELVIS, :2], axis=-1)
        leaves = np.flatnonzero((away > 0.8) | ~low[first:])
        end = first + (int(leaves[0]) if len(leaves) else len(away))
        rests = np.flatnonzero(stands[first:end])
        last = first + int(rests[-1]) + 1
        if last - first >= 3 * FPS:
            found.append(positions[first:last])
        first = max(end, first + 1)
    return found
