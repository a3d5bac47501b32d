"""The windows of the rooms benchmark: what a model is handed, and what happened then."""

from __future__ import annotations

import csv
import hashlib
import io
import json
from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace

import numpy as np

from motioncast.benchmarks.protocol import Protocol, tenths_mm
from motioncast.core.scene import Scene
from motioncast.core.scene_object import SceneObject
from motioncast.core.skeletons import SKELETONS
from motioncast.datasets.rooms import Room

_MOMENTS = (25, 50, 100, 150, 200, 250)

PER_ROOM = 3
"""Windows of a room at most."""

PROTOCOL = Protocol(
    "rooms", "mrt15", 25.0, 25, 250, _MOMENTS, _MOMENTS, "mpjpe",
    f"at most {PER_ROOM} windows of each furnished test room, every 6 s", stride=150, samples=4,
)  # fmt: skip

USES = ("sit", "reach", "write")
"""Events that are goals: who begins one has come to a thing."""

COLUMNS = ("window", "room", "first_frame", "last_frame", "fps", "people", "objects", "goals", "sha256")


@dataclass(frozen=True, slots=True)
class Goal:
    """What a person will truly go to.

    Attributes:
        person: Number of the person.
        thing: Number of the object.
        frame: Forecast frame, from 1, in which the person is at it.
        kind: What it is used for, such as ``sit``.
    """

    person: int
    thing: int
    frame: int
    kind: str


@dataclass(frozen=True, slots=True, eq=False)
class RoomWindow:
    """One second of a room, and the ten that followed.

    Attributes:
        scene: All that a model may see: the history of those who are there at its end, and objects as at its end,
            without a hint which of them will be used.
        future: What they did then, ``(time, people, joints, 3)`` metres.
        seen: Whether they were still (or again) there, ``(time, people)``.
        synthetic: Who is moved by inverse kinematics anywhere in the window, ``(people,)``.
        room: Name of the room: rooms are independent of one another, windows of a room are not.
        start: First frame of the history in the room.
        goals: What they went to.
        pairs: Numbers of people who were recorded together.
        takes: The takes that they are made of.
    """

    scene: Scene
    future: np.ndarray
    seen: np.ndarray
    synthetic: np.ndarray
    room: str
    start: int
    goals: tuple[Goal, ...] = ()
    pairs: frozenset[frozenset[int]] = frozenset()
    takes: frozenset[str] = frozenset()

    def recorded(self) -> RoomWindow:
        """The same window; only who was recorded throughout counts."""
        kept = {person for person, made in enumerate(self.synthetic.tolist()) if not made}
        goals = tuple(goal for goal in self.goals if goal.person in kept)
        return replace(self, seen=self.seen & ~self.synthetic, goals=goals)


def windows_of_room(room: Room) -> list[RoomWindow]:
    """The first windows of a room: every 6 s, where somebody is there at now."""
    scene = room.scene.on(SKELETONS[PROTOCOL.skeleton])
    length, found = PROTOCOL.history + PROTOCOL.horizon, []
    for start in range(0, scene.frames - length + 1, PROTOCOL.stride):
        if room.here[start + PROTOCOL.history - 1].any():
            found.append(window_at(room, scene, start))
    return found[:PER_ROOM]


def window_at(room: Room, scene: Scene, start: int) -> RoomWindow:
    """The window whose history starts at a frame, with those who are there at its end.

    Args:
        room: The room.
        scene: Its scene on the joints of the protocol.
        start: First frame.
    """
    now, end = start + PROTOCOL.history - 1, start + PROTOCOL.history + PROTOCOL.horizon
    rows = np.flatnonzero(room.here[now]).tolist()
    known = scene.select([scene.people[row] for row in rows])
    names, things = as_found(scene.objects, now)
    goals = [
        Goal(rows.index(event.person), names.index(event.thing), event.start - now, event.kind)
        for event in room.events
        if event.kind in USES and event.thing and event.person in rows and now < event.start < end
    ]
    pairs = [
        (rows.index(one), rows.index(other))
        for (one, other), how in room.pairs.items()
        if how == "recorded" and one in rows and other in rows
    ]
    return RoomWindow(
        replace(known[start : now + 1], objects=things),
        known.positions[now + 1 : end],
        np.all(known.observed[now + 1 : end], -1),
        np.any(room.synthetic[start:end, rows], 0),
        scene.source,
        start,
        tuple(goals),
        frozenset(map(frozenset, pairs)),
        frozenset(take for row in rows for take in room.takes[row]),
    )


def as_found(objects: Sequence[SceneObject], now: int) -> tuple[list[str], tuple[SceneObject, ...]]:
    """Objects as they stand at now, told apart by kind and place only: the order of a room's list, the names and the
    roles come from how it was composed and may tell what will be used.

    Returns:
        Their names in the room, and they themselves.
    """
    still = sorted((thing.at(now) for thing in objects), key=lambda thing: tuple(thing.position.tolist()))
    nameless = (replace(thing, name=f"{thing.category} {rank}", role="") for rank, thing in enumerate(still, 1))
    return [thing.name for thing in still], tuple(nameless)


def digest(window: RoomWindow) -> str:
    """SHA-256 of a window: positions and objects at 0.1 mm, and who was there."""
    found = hashlib.sha256(tenths_mm(window.scene.positions) + tenths_mm(window.future))
    found.update(window.seen.tobytes() + window.synthetic.tobytes())
    for thing in window.scene.objects:
        found.update(thing.category.encode() + thing.shape.encode())
        found.update(tenths_mm(np.concatenate([thing.size, thing.position, thing.rotation])))
    return found.hexdigest()


def checksum(windows: Sequence[RoomWindow]) -> str:
    """SHA-256 of all windows."""
    return hashlib.sha256("".join(map(digest, windows)).encode()).hexdigest()


def protocol_hash(windows: Sequence[RoomWindow]) -> str:
    """A short hash of the protocol and of its windows."""
    told = json.dumps(asdict(PROTOCOL), sort_keys=True) + checksum(windows)
    return hashlib.sha256(told.encode()).hexdigest()[:16]


def manifest(windows: Sequence[RoomWindow]) -> str:
    """The manifest of windows as CSV."""
    out = io.StringIO()
    table = csv.writer(out, lineterminator="\n")
    table.writerow(COLUMNS)
    length = PROTOCOL.history + PROTOCOL.horizon
    for number, window in enumerate(windows):
        table.writerow([
            number, window.room, window.start, window.start + length - 1, f"{PROTOCOL.fps:g}",
            len(window.scene.people), len(window.scene.objects), len(window.goals), digest(window)[:16],
        ])  # fmt: skip
    return out.getvalue()
