"""Windows of rooms as a model is trained and judged on: one second of history, ten seconds of future."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from motioncast.core.scene_object import SceneObject
from motioncast.core.skeleton import Skeleton
from motioncast.core.skeletons import MRT15
from motioncast.datasets.rooms.compose import Room
from motioncast.datasets.rooms.events import Event

HISTORY, HORIZON = 25, 250

STANDING_M_S = 0.1
"""Somebody whose pelvis moves less than this on average stands still."""


@dataclass(frozen=True, slots=True, eq=False)
class Sample:
    """One window of one room.

    Attributes:
        positions: ``(275, people, joints, 3)`` float32; zero where somebody is away.
        present: Who is there when, ``(275, people)`` bool.
        primary: People who are there in the last frame of the history: those who are forecast.
        still: Of these, who stands still all the time (to be drawn less often), ``(primary,)`` bool.
        synthetic: Frames made by inverse kinematics, ``(275, people)`` bool.
        objects: The room's objects.
        events: What happens in the window, in frames of the window; it may start before or end after it.
        start: First frame of the window in its room.
    """

    positions: np.ndarray
    present: np.ndarray
    primary: tuple[int, ...]
    still: np.ndarray
    synthetic: np.ndarray
    objects: tuple[SceneObject, ...]
    events: tuple[Event, ...]
    start: int


def windows(
    room: Room, stride: int = 25, skeleton: Skeleton = MRT15, history: int = HISTORY, horizon: int = HORIZON
) -> Iterator[Sample]:
    """The windows of a room in which somebody is there in the last frame of the history.

    People who are away throughout a window are left out of it.

    Args:
        room: Any room.
        stride: Frames from window to window.
        skeleton: Joints that are handed out.
        history: Frames that a model sees.
        horizon: Frames that follow.
    """
    scene, length = room.scene.on(skeleton), history + horizon
    here = room.here
    for start in range(0, scene.frames - length + 1, stride):
        frames = slice(start, start + length)
        people = np.flatnonzero(here[frames].any(0))
        present = here[frames][:, people]
        primary = tuple(np.flatnonzero(present[history - 1]).tolist())
        if not primary:
            continue
        positions = scene.positions[frames][:, people]
        number = {person: row for row, person in enumerate(people.tolist())}
        events = tuple(
            replace(event, person=number[event.person], start=event.start - start, end=event.end - start)
            for event in room.events
            if event.start < start + length and event.end > start and event.person in number
        )
        still = _still(positions, present, skeleton.landmarks.index("pelvis"), scene.fps)[list(primary)]
        yield Sample(
            positions, present, primary, still, room.synthetic[frames][:, people], scene.objects, events, start
        )


def _still(positions: np.ndarray, present: np.ndarray, pelvis: int, fps: float) -> np.ndarray:
    both = present[1:] & present[:-1]
    speed = np.linalg.norm(np.diff(positions[:, :, pelvis, :2], axis=0), axis=-1) * fps
    return (speed * both).sum(0) < STANDING_M_S * np.maximum(both.sum(0), 1)
