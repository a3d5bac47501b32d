"""The grammar of synthetic acts: stop, turn, stand, sit, reach and write, start; built on a real walk.

A walk is cut where a foot has just landed. From there keys lead through the act and back into a landed foot of the
same person's walk: a sentence is ``stop turn? (stand | back sit | reach | write) turn? start``. Every parameter is
drawn from a stated range:

- turn: steps of at most 75 degrees, 0.36 s a footfall,
- sit: 0.18 to 0.25 m back, down in 1.2 to 1.6 s with the trunk bent 30 to 40 degrees, 4 to 18 s on the seat with
  another posture every 2 to 6 s, up again in 1.1 to 1.5 s,
- reach: 0.7 to 1.0 s there, 0.6 to 3 s with the wrist at the target, one to three targets, 0.7 s back,
- write: 4 to 12 s along a line on a vertical plane, strokes of 2 to 4 cm, 1 to 1.6 a second,
- stand: 2 to 11 s, with a turn between or without.
"""

from __future__ import annotations

import numpy as np

from motioncast.datasets.rooms.bodies import turned
from motioncast.datasets.rooms.events import PELVIS_ABOVE_SEAT_M
from motioncast.datasets.rooms.figure import KNEES, Figure, arm_length, arm_towards, bent, shoulder_of
from motioncast.datasets.rooms.puppet import Puppet
from motioncast.datasets.rooms.steps import centre_of, forwards


def stand(puppet: Puppet, seconds: float) -> None:
    """Stay."""
    puppet.hold(puppet.time + seconds)


def sit(puppet: Puppet, seat_m: float, seconds: float, random: np.random.Generator) -> tuple[float, float]:
    """Sit down on a seat behind, stay, and rise.

    Args:
        puppet: Somebody who stands with the back to the seat.
        seat_m: Height of the seat.
        seconds: On the seat.
        random: Source of times and angles.

    Returns:
        When the pelvis comes to rest on the seat, and when it leaves it, seconds.
    """
    figure, begin, standing = puppet.figure, puppet.time, puppet.pelvis.last
    down, up = random.uniform(1.2, 1.6), random.uniform(1.1, 1.5)
    low = np.array([*seat_place(puppet), seat_m + PELVIS_ABOVE_SEAT_M])
    half = 0.5 * (standing + low)
    seated = _seated(figure, random)
    leaning = bent(figure.neutral, np.radians(random.uniform(30, 40)))
    rest, leave = begin + down, begin + down + seconds
    for first, last, place, bones in (
        (begin, rest, low, seated),
        (leave, leave + up, standing, figure.neutral),
    ):
        puppet.hold(first)
        middle = (first + last) / 2
        puppet.pelvis.key(middle, half, 1.5 * (place - puppet.pelvis.last) / (last - first))
        puppet.bones.key(middle, leaning)
        puppet.pelvis.key(last, place)
        puppet.bones.key(last, bones)
        puppet.hold(last)
        if place is low:
            _shift_about(puppet, leave, random)
    return rest, leave


def _seated(figure: Figure, random: np.random.Generator) -> np.ndarray:
    """Directions of somebody who sits, upright or leaning a little, the hands on the thighs or before the body."""
    seated = bent(figure.neutral, np.radians(random.uniform(-10, 14)))
    for side in range(2):
        place = np.array([random.uniform(0.2, 0.32), (1 - 2 * side) * random.uniform(0.06, 0.17), 0.1])
        if random.random() < 0.25:
            place += [0.05, 0, random.uniform(0.1, 0.3)]
        seated = arm_towards(figure, seated, side, place)
    return seated


def _shift_about(puppet: Puppet, leave: float, random: np.random.Generator) -> None:
    """Change the posture every few seconds until it is time to rise."""
    while True:
        begin = puppet.time + random.uniform(0.8, 4)
        end = begin + random.uniform(0.8, 1.6)
        if end > leave:
            return
        puppet.bones.hold(begin)
        puppet.bones.key(end, _seated(puppet.figure, random))
        puppet.time = end


def seat_place(puppet: Puppet) -> np.ndarray:
    """Where the pelvis of somebody who stands would sit, ``(2,)``."""
    thigh = float(puppet.figure.lengths[KNEES[0]])
    return centre_of(puppet) - 0.95 * thigh * forwards(float(puppet.look.last))


def reach(puppet: Puppet, targets: np.ndarray, side: int, random: np.random.Generator) -> list[tuple[float, float]]:
    """Bring a wrist to targets one after another and let it rest there.

    Args:
        puppet: Somebody who stands before them.
        targets: World positions ``(targets, 3)``.
        side: Which arm: 0 left, 1 right.
        random: Source of times.

    Returns:
        When the wrist comes to rest at each target, and when it leaves it, seconds.
    """
    held = []
    for target in targets:
        there = puppet.time + random.uniform(0.7, 1.0)
        away = there + random.uniform(0.6, 3.0)
        puppet.bones.key(there, _reaching(puppet, target, side))
        puppet.hold(there)
        puppet.hold(away)
        held.append((there, away))
    puppet.bones.key(puppet.time + 0.7, puppet.figure.neutral)
    puppet.hold(puppet.time + 0.7)
    return held


def _reaching(puppet: Puppet, target: np.ndarray, side: int) -> np.ndarray:
    """Bones of somebody who stands and reaches a target, bent forwards as little as it takes."""
    figure = puppet.figure
    there = target - puppet.pelvis.last
    there = turned(there, -float(puppet.look.last))
    bones = figure.neutral
    for angle in np.radians(np.arange(2, 75, 4)):
        bones = bent(figure.neutral, float(angle))
        if np.linalg.norm(there - shoulder_of(figure, bones, side)) < 0.96 * arm_length(figure, side):
            break
    return arm_towards(figure, bones, side, there)


def write(
    puppet: Puppet, middle: np.ndarray, side: int, seconds: float, random: np.random.Generator
) -> tuple[float, float]:
    """Write on a vertical plane that the person faces, around a point on it; when it starts and ends."""
    look = float(puppet.look.last)
    across = np.array([np.sin(look), -np.cos(look)])  # from left to right
    begin = puppet.time + 0.9
    rate, size = random.uniform(1.0, 1.6), random.uniform(0.02, 0.04)
    times = np.arange(0, seconds, 0.12)
    along = -0.2 + 0.4 * times / seconds + size * np.sin(2 * np.pi * rate * times)
    up = 1.2 * size * np.cos(2 * np.pi * 1.7 * rate * times)
    points = middle + np.column_stack([along[:, None] * across, up])
    bones = np.stack([_reaching(puppet, point, side) for point in points])
    slopes = np.gradient(bones, times, axis=0)
    slopes[[0, -1]] = 0
    for time, pose, slope in zip(times, bones, slopes, strict=True):
        puppet.bones.key(begin + time, pose, slope)
    end = begin + float(times[-1])
    puppet.hold(end)
    puppet.bones.key(end + 0.8, puppet.figure.neutral)
    puppet.hold(end + 0.8)
    return begin, end
