"""Somebody who is there with a whole take: people who never walk far, and real sitting."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from motioncast.core.scene_object import SceneObject
from motioncast.datasets.rooms.bodies import PELVIS, turned
from motioncast.datasets.rooms.clips import Clip
from motioncast.datasets.rooms.contacts import FEET, FPS, smoothed
from motioncast.datasets.rooms.events import Event, events_of
from motioncast.datasets.rooms.fitting import TOUCHING, fits
from motioncast.datasets.rooms.ground import Ground
from motioncast.datasets.rooms.kinds import HUNG_M, KINDS, thing
from motioncast.datasets.rooms.stitch import placed
from motioncast.datasets.rooms.tracks import SHORTEST, Track, whole_take

LONGEST = round(60 * FPS)
TRIES = 20

SAME_PLANE_M = 0.25
"""Two stretches of writing this near to one board share it."""


def on_the_floor(clip: Clip) -> bool:
    """Whether somebody keeps to a flat floor and to a space that a room has, for long enough."""
    feet = smoothed(clip.positions[:, 0, FEET, 2].min(-1), 5)
    spread = np.ptp(clip.positions[:, 0, PELVIS, :2], axis=0).max()
    return len(clip.positions) >= SHORTEST and float(feet.max()) < 0.2 and float(spread) < 4.5


def solo(clip: Clip, start: int, ground: Ground, random: np.random.Generator) -> Track | None:
    """A take set down in the room with the things that it asks for, or None where it finds no place."""
    length = min(len(clip.positions), LONGEST)
    first = int(random.integers(len(clip.positions) - length + 1))
    positions = clip.positions[first : first + length, 0].astype(np.float64)
    events = [event for event in events_of(positions) if event.kind in ("sit", "write")]
    path = positions[:, PELVIS, :2]
    middle = (path.max(0) + path.min(0)) / 2
    for _ in range(TRIES):
        angle = random.uniform(0, 2 * np.pi)
        shift = random.uniform(-1, 1, 2) * np.maximum(ground.half - 1.0, 0) - turned(middle, angle)
        body = placed(positions, angle, shift)
        if not ground.free(body[None, :, PELVIS, :2], start)[0]:
            continue
        moved = [_moved(event, angle, shift) for event in events]
        named, things = _things(moved, ground, random)
        if all(fits(item, body, ground, TOUCHING[kind]) for kind, item in things):
            used = tuple(item for _, item in things)
            return replace(whole_take(body, start, clip.name), events=tuple(named), things=used)
    return None


def _moved(event: Event, angle: float, shift: np.ndarray) -> Event:
    x, y, z = placed(np.array(event.point), angle, shift).tolist()
    return replace(event, point=(x, y, z), outward=event.outward + angle)


def _things(
    events: list[Event], ground: Ground, random: np.random.Generator
) -> tuple[list[Event], list[tuple[str, SceneObject]]]:
    """A seat for each sitting and a board for each plane of writing, and the events with their names."""
    named: list[Event] = []
    things: list[tuple[str, SceneObject]] = []
    for event in events:
        near = next((item for kind, item in things if kind == event.kind and _serves(item, event)), None)
        if near is None:
            near = _thing(event, ground, random)
            things.append((event.kind, near))
        named.append(replace(event, thing=near.name))
    return named, things


def _thing(event: Event, ground: Ground, random: np.random.Generator) -> SceneObject:
    x, y, z = event.point
    out = np.array([np.cos(event.outward), np.sin(event.outward)])
    if event.kind == "sit":
        kind_name = "chair" if z < 0.6 else "bar stool"
        size = KINDS[kind_name].size(random)
        size[2], place, lower = z, np.array([x, y]), 0.0
    else:
        kind_name = "whiteboard"
        size = KINDS[kind_name].size(random)
        place, lower = np.array([x, y]) - (0.09 + size[0] / 2) * out, HUNG_M
    name = ground.name(kind_name)
    return thing(KINDS[kind_name], name, size, float(place[0]), float(place[1]), lower, event.outward + np.pi, "caused")


def _serves(item: SceneObject, event: Event) -> bool:
    """Whether a thing that is there already is where an event needs one."""
    aside = item.inward(np.array(event.point))
    return bool(abs(aside[0]) < SAME_PLANE_M and np.hypot(aside[0], aside[1]) < 1.2)
