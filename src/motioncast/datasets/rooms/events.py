"""What people do in a room, and the rules by which it is seen in a real take.

- **sit**: the pelvis hardly moves (below 0.15 m/s) for half a second, and either it is 0.30 to 0.65 m above the floor
  with the thighs within 35 degrees of level, or it is lower than when standing, the thighs are within 50 degrees of
  level and the feet are so far before it that only a seat can carry it (a high stool).
- **step**: a foot stands for a third of a second more than 12 cm above the floor.
- **write**: for two seconds a wrist works higher than 1.1 m, before the body and within 6 cm of a vertical
  plane, over more than 60 by 30 cm (washing windows counts).
- **hold**: a wrist rests for 0.4 s at 0.7 to 1.1 m with the arm stretched. Nothing is inferred from that: arms stretch
  out for many reasons.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from motioncast.core.skeletons import CMU31
from motioncast.datasets.rooms.bodies import PELVIS, facing, turned
from motioncast.datasets.rooms.contacts import FEET, FPS, lasting, runs, smoothed, speed

PELVIS_ABOVE_SEAT_M = 0.09
"""Height of the pelvis over what it sits on."""

LEFT = tuple(CMU31.index(name) for name in ("lhipjoint", "lfemur", "ltibia", "lclavicle", "lwrist"))
RIGHT = tuple(CMU31.index(name) for name in ("rhipjoint", "rfemur", "rtibia", "rclavicle", "rwrist"))


@dataclass(frozen=True, slots=True)
class Event:
    """One thing that one person does.

    Attributes:
        kind: ``sit``, ``reach``, ``fetch`` (from one reach to the next), ``write``, ``stand``, ``play`` (a real stretch
            on the spot), ``step`` or ``hold``.
        person: Index of the person.
        start: First frame.
        end: End, exclusive.
        thing: Name of the object that it needs, or empty.
        point: Where the contact is, metres: on the seat, under the foot, at the wrist.
        outward: Horizontal angle of the direction from the thing to the person, radians.
        synthetic: Whether inverse kinematics made it, as against a real take.
    """

    kind: str
    person: int
    start: int
    end: int
    thing: str = ""
    point: tuple[float, float, float] = (0.0, 0.0, 0.0)
    outward: float = 0.0
    synthetic: bool = False


def events_of(positions: np.ndarray, person: int = 0) -> list[Event]:
    """The events of one real person ``(time, 31, 3)`` on a floor at z = 0."""
    found = [*_sits(positions, person), *_steps(positions, person)]
    for wrist in (LEFT[-1], RIGHT[-1]):
        found += _writes(positions, person, wrist)
    found += _holds(positions, person)
    return sorted(found, key=lambda event: event.start)


def _sits(positions: np.ndarray, person: int) -> Iterator[Event]:
    pelvis = positions[:, PELVIS]
    still = speed(positions[:, [PELVIS]])[:, 0] < 0.15
    slopes = [_slope(positions[:, side[1]] - positions[:, side[0]]) for side in (LEFT, RIGHT)]
    steepest = np.abs(slopes).max(0)
    chair = (pelvis[:, 2] > 0.3) & (pelvis[:, 2] < 0.65) & (steepest < np.radians(35))
    look = facing(positions)
    feet = positions[:, [LEFT[2], RIGHT[2]], :2].mean(1) - pelvis[:, :2]
    before = turned(feet, -look)[:, 0]
    lower = pelvis[:, 2] < np.median(pelvis[:, 2]) - 0.06
    stool = lower & (before > 0.22) & (steepest < np.radians(50))
    for first, end in runs(lasting(still & (chair | stool), round(0.5 * FPS))):
        x, y, z = np.median(pelvis[first:end], 0)
        out = float(np.angle(np.exp(1j * look[first:end]).mean()))
        yield Event("sit", person, first, end, point=(float(x), float(y), float(z) - PELVIS_ABOVE_SEAT_M), outward=out)


def _slope(bones: np.ndarray) -> np.ndarray:
    return np.arctan2(bones[:, 2], np.linalg.norm(bones[:, :2], axis=-1))


def _steps(positions: np.ndarray, person: int) -> Iterator[Event]:
    feet = positions[:, FEET].reshape(len(positions), 2, 2, 3)
    still = speed(positions[:, FEET]).reshape(-1, 2, 2).max(-1) < 0.2
    look = facing(positions)
    for side in range(2):
        height = feet[:, side, :, 2].min(-1)
        for first, end in runs(lasting(still[:, side] & (height > 0.12), round(FPS / 3))):
            x, y = np.median(feet[first:end, side, :, :2].mean(1), 0)
            point = (float(x), float(y), float(np.median(height[first:end])))
            yield Event("step", person, first, end, point=point, outward=float(look[first] + np.pi))


def _writes(positions: np.ndarray, person: int, wrist: int) -> Iterator[Event]:
    length = round(2 * FPS)
    if len(positions) < length:
        return
    path = positions[:, wrist].astype(np.float64)
    pace = smoothed(speed(positions[:, [wrist]])[:, 0], 6)
    look = facing(positions)
    before = turned(path[:, :2] - positions[:, PELVIS, :2], -look)[:, 0]
    fits = (path[:, 2] > 1.1) & (before > 0.3) & (pace > 0.15)
    works = np.zeros(len(path), bool)
    for first in range(0, len(path) - length + 1, 5):
        piece = slice(first, first + length)
        if fits[piece].all() and _plane(path[piece, :2])[1] < 0.06:
            works[piece] = True
    for first, end in runs(works):
        wide = np.ptp(path[first:end], axis=0)
        if wide[2] < 0.3 or wide[:2].max() < 0.6 or np.ptp(positions[first:end, PELVIS, :2], axis=0).max() > 0.4:
            continue
        normal, _ = _plane(path[first:end, :2])
        body = positions[first:end, PELVIS, :2].mean(0) - path[first:end, :2].mean(0)
        normal = normal if normal @ body > 0 else -normal
        x, y, z = path[first:end].mean(0)
        out = float(np.arctan2(normal[1], normal[0]))
        yield Event("write", person, first, end, point=(float(x), float(y), float(z)), outward=out)


def _plane(points: np.ndarray) -> tuple[np.ndarray, float]:
    """The horizontal normal of the vertical plane nearest to points ``(n, 2)``, and their distance from it."""
    values, vectors = np.linalg.eigh(np.cov(points.T))
    return vectors[:, 0], float(np.sqrt(max(values[0], 0)))


def _holds(positions: np.ndarray, person: int) -> Iterator[Event]:
    look = facing(positions)
    for side in (LEFT, RIGHT):
        shoulder, wrist = positions[:, side[3]], positions[:, side[4]]
        arm = np.linalg.norm(wrist - shoulder, axis=-1)
        stretched = arm > 0.85 * np.percentile(arm, 99)
        still = speed(positions[:, [side[4]]])[:, 0] < 0.1
        away = np.linalg.norm(wrist[:, :2] - positions[:, PELVIS, :2], axis=-1) > 0.35
        mask = stretched & still & away & (wrist[:, 2] > 0.7) & (wrist[:, 2] < 1.1)
        for first, end in runs(lasting(mask, round(0.4 * FPS))):
            x, y, z = np.median(wrist[first:end], 0)
            point = (float(x), float(y), float(z))
            yield Event("hold", person, first, end, point=point, outward=float(look[first] + np.pi))
