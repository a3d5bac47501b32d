"""The way of one person through a room: in by a door, from place to place, out again."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from motioncast.core.scene_object import SceneObject
from motioncast.datasets.rooms.bodies import PELVIS, turned
from motioncast.datasets.rooms.contacts import FPS
from motioncast.datasets.rooms.events import Event
from motioncast.datasets.rooms.gait import LEAST, Gait
from motioncast.datasets.rooms.ground import Ground
from motioncast.datasets.rooms.steer import bends, rates
from motioncast.datasets.rooms.stitch import BLEND, MIDDLE, blended, placed

TURNS = np.radians([-75, -45, -20, 0, 20, 45, 75])
"""Rates of turning that a walker chooses from, radians a second."""

FIRST, SECOND = (way.ravel() for way in np.meshgrid(TURNS, TURNS))

SHORTEST = round(11 * FPS)
"""Frames of the shortest track: a window of eleven seconds."""

MOST = round(2.4 * FPS)
"""Frames of the longest piece of a walk."""

STEPS = 16
"""Pieces that are tried on the way to a goal."""


@dataclass(frozen=True, slots=True, eq=False)
class Track:
    """Motion of one person in the world of a room, so far.

    Attributes:
        start: Its first frame in the room.
        tail: ``(BLEND, 31, 3)`` frames that follow the parts, to be blended with what comes next.
        source: Frame of the gait at the middle of the tail.
        look: Where the person faces there, radians.
        stand: Where the person stands there, ``(2,)``.
        rate: Rate of turning at the end, radians a second.
        parts: Positions one after another, each ``(time, 31, 3)``.
        takes: What it was made of.
        made: First frames and ends of what inverse kinematics made, on the clock of the track.
        events: What the person does, on the clock of the track.
        things: What it takes to do that.
    """

    start: int
    tail: np.ndarray
    source: int
    look: float
    stand: np.ndarray
    rate: float = 0.0
    parts: tuple[np.ndarray, ...] = ()
    takes: tuple[str, ...] = ()
    made: tuple[tuple[int, int], ...] = ()
    events: tuple[Event, ...] = ()
    things: tuple[SceneObject, ...] = ()

    @property
    def frames(self) -> int:
        """Frames so far, without the tail."""
        return sum(map(len, self.parts))

    @property
    def now(self) -> int:
        """The frame of the room in which the tail starts."""
        return self.start + self.frames

    @property
    def place(self) -> np.ndarray:
        """Where the person is when the tail ends, ``(2,)``."""
        return self.tail[-1, PELVIS, :2]

    @property
    def positions(self) -> np.ndarray:
        """All frames so far, ``(time, 31, 3)``."""
        return np.concatenate(self.parts)


def whole_take(positions: np.ndarray, start: int, name: str) -> Track:
    """A track that is one stretch of one take, ``(time, 31, 3)``, as it was recorded."""
    last = positions[-1:]
    return Track(start, last, -1, 0.0, last[0, PELVIS, :2], parts=(positions,), takes=(name,))


def enter(gait: Gait, door: np.ndarray, start: int, random: np.random.Generator) -> Track:
    """A track whose first frames come in by a door."""
    index = np.arange(len(gait) - BLEND)
    fits = (
        (gait.ends[index] - index >= BLEND)
        & (index - gait.firsts[index] >= BLEND)
        & (gait.onward[index + MIDDLE, 0] >= 0)
    )
    first = int(random.choice(index[fits]))
    tail = gait.positions[first : first + BLEND].astype(np.float64)
    way = tail[-1, PELVIS, :2] - gait.positions[first - BLEND, PELVIS, :2]
    x, y, angle = door
    turn = angle - np.arctan2(way[1], way[0])
    inwards = np.array([np.cos(angle), np.sin(angle)])
    shift = np.array([x, y]) - 0.9 * inwards - turned(tail[0, PELVIS, :2], turn)
    middle = first + MIDDLE
    look, stand = float(gait.looks[middle] + turn), placed(gait.pivots[middle], turn, shift)
    return Track(start, placed(tail, turn, shift), middle, look, stand)


def walk_to(
    track: Track, gait: Gait, goal: np.ndarray, ground: Ground, random: np.random.Generator, within_m: float = 0.9
) -> Track | None:
    """The track with walking up to a goal, or None where no way was found.

    At a dead end the last pieces are taken back and others are tried.
    """
    ways = [track]
    for _ in range(STEPS):
        if np.linalg.norm(ways[-1].place - goal) < within_m:
            return ways[-1]
        onward = walk_on(ways[-1], gait, goal, ground, random)
        if onward is not None:
            ways.append(onward)
        else:
            del ways[max(1, len(ways) - int(random.integers(1, 4))) :]
        if ways[-1].now > ground.frames:
            return ways[-1]
    return None


def walk_on(track: Track, gait: Gait, goal: np.ndarray, ground: Ground, random: np.random.Generator) -> Track | None:
    """The track with one more piece of walking towards a goal, or None where there is no free way.

    The best of several ways to bend the piece is taken: free of walls, things and people, and nearest to the goal.
    """
    known = gait.onward[track.source]
    for middle in random.permutation(known[known >= 0]):
        first = int(middle) - MIDDLE
        end = _end(gait, first, random)
        angle = float(track.look - gait.looks[middle])
        shift = track.stand - turned(gait.pivots[middle], angle)
        piece = placed(gait.positions[first:end].astype(np.float64), angle, shift)
        stands = placed(gait.pivots[first:end], angle, shift)
        turn, moved = bends(stands, rates(track.rate, FIRST, SECOND, len(piece)), MIDDLE)
        paths = turned(piece[None, :, PELVIS, :2], turn) + moved
        cost = np.where(ground.free(paths, track.now), _effort(paths, goal, ground), np.inf)
        best = int(cost.argmin())
        if not np.isfinite(cost[best]):
            continue
        bent = placed(piece, turn[best, :, None], moved[best, :, None])
        last = len(piece) - BLEND + MIDDLE
        return replace(
            track,
            tail=bent[-BLEND:],
            source=first + last,
            look=float(gait.looks[first + last] + angle + turn[best, last]),
            stand=turned(stands[last], turn[best, last]) + moved[best, last],
            rate=float(SECOND[best]),
            parts=(*track.parts, np.concatenate([blended(track.tail, bent[:BLEND], gait.lengths), bent[BLEND:-BLEND]])),
            takes=(*track.takes, *dict.fromkeys(gait.takes[first:end].tolist())),
        )
    return None


def _end(gait: Gait, first: int, random: np.random.Generator) -> int:
    """Where a piece that starts at a frame ends, its tail included: at a frame from which others go on."""
    lengths = np.arange(LEAST, min(int(gait.ends[first]) - first - 2 * BLEND, MOST) + 1)
    ends = first + BLEND + lengths + BLEND
    going = gait.onward[ends - BLEND + MIDDLE, 1] >= 0
    return int(random.choice(ends[going] if going.any() else ends))


def _effort(paths: np.ndarray, goal: np.ndarray, ground: Ground) -> np.ndarray:
    """How far from the goal paths ``(ways, time, 2)`` end, also by their direction, and how near to a wall."""
    end = paths[:, -1]
    way, wanted = end - paths[:, -6], goal - end
    far = np.linalg.norm(wanted, axis=-1)
    aligned = (way * wanted).sum(-1) / (np.linalg.norm(way, axis=-1) * far + 1e-6)
    nearest = np.linalg.norm(paths - goal, axis=-1).min(-1)
    beyond = np.abs(end + way / (np.linalg.norm(way, axis=-1, keepdims=True) + 1e-6)) - (ground.half - 0.4)
    return nearest + 0.3 * far - 0.8 * aligned + 2.0 * np.maximum(beyond, 0).sum(-1)
