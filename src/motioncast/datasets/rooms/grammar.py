"""The grammar of synthetic acts: stop, turn, stand, sit, reach and write, start; built on a real walk.

A walk is cut where a foot has just landed. From there keys lead through the act and back into a landed foot of the
same person's walk: a sentence is ``stop turn? (stand | back sit | reach | write) turn? start``. Every parameter is drawn
from a stated range:

- turn: steps of at most 75 degrees, 0.36 s a footfall,
- sit: 0.18 to 0.25 m back, down in 1.2 to 1.6 s with the trunk bent 30 to 40 degrees, 4 to 18 s on the seat with
  another posture every 2 to 6 s, up again in 1.1 to 1.5 s,
- reach: 0.7 to 1.0 s there, 0.6 to 3 s with the wrist at the target, one to three targets, 0.7 s back,
- write: 4 to 12 s along a line on a vertical plane, strokes of 2 to 4 cm, 1 to 1.6 a second,
- stand: 2 to 11 s, with a turn between or without.
"""

from __future__ import annotations

import numpy as np

from motioncast.datasets.rooms.bodies import PELVIS, turned
from motioncast.datasets.rooms.contacts import FPS, speed
from motioncast.datasets.rooms.gait import Gait
from motioncast.datasets.rooms.puppet import (
    ANKLES,
    BALLS,
    KNEES,
    Figure,
    Puppet,
    arm_length,
    arm_towards,
    bent,
    shoulder_of,
)
from motioncast.datasets.rooms.stitch import placed

FOOTFALL_S = 0.36
LARGEST_TURN = np.radians(75)
AHEAD_M = 0.03
"""The pelvis of somebody who stands is this far before the ankles."""

ABOVE_SEAT_M = 0.09
"""Height of the pelvis over what it sits on."""


def forwards(look: float) -> np.ndarray:
    """The horizontal direction ``(2,)`` of an angle."""
    return np.array([np.cos(look), np.sin(look)])


def landed(positions: np.ndarray, looks: np.ndarray) -> np.ndarray:
    """In which frames of a walk a foot has just landed ahead, ``(time,)``: 0 left, 1 right, -1 neither."""
    ankles = positions[:, ANKLES, :2] - positions[:, PELVIS, None, :2]
    ahead = turned(ankles, -looks[:, None])[..., 0]
    balls = positions[:, BALLS]
    down = (balls[..., 2] < 0.07) & (speed(balls) < 0.5)
    side = (ahead[:, 1] > ahead[:, 0]).astype(int)
    front, rear = (np.take_along_axis(ahead, row[:, None], 1)[:, 0] for row in (side, 1 - side))
    stands = np.take_along_axis(down, side[:, None], 1)[:, 0]
    return np.where(stands & (front > 0.08) & (front - rear > 0.25), side, -1)


def stance(figure: Figure, centre: np.ndarray, look: float, side: int) -> tuple[np.ndarray, float]:
    """Where a foot of somebody who stands at ``centre`` goes, and where it points."""
    sign = 1 - 2 * side
    across = sign * figure.width / 2 * np.array([-np.sin(look), np.cos(look)])
    return centre + across, look + sign * 0.12


def stop(puppet: Puppet) -> None:
    """From a landed foot to standing beside it."""
    figure, look = puppet.figure, float(puppet.look.last)
    ahead = [float((ankle.last - puppet.pelvis.last)[:2] @ forwards(look)) for ankle in puppet.ankles]
    front = int(ahead[1] > ahead[0])
    sign = 1 - 2 * front
    across = np.array([-np.sin(look), np.cos(look)])
    centre = puppet.ankles[front].last[:2] - sign * figure.width / 2 * across
    goal = centre + AHEAD_M * forwards(look)
    pace = max(float(np.linalg.norm(puppet.pelvis.slopes[-1][:2])), 0.4)
    end = float(np.clip(2 * np.linalg.norm(goal - puppet.pelvis.last[:2]) / pace, 0.55, 1.0))
    puppet.settle(front, 0.2)
    puppet.step(1 - front, *stance(figure, centre, look, 1 - front), 0.04, 0.85 * end)
    _stand(puppet, goal, look, end)


def gather(puppet: Puppet) -> None:
    """From any standing pose to the neutral one, a step of each foot."""
    look, centre, begin = float(puppet.look.last), centre_of(puppet), puppet.time
    for side in range(2):
        if side == 1:
            puppet.settle(1, begin + 0.2)
        time = begin + side * FOOTFALL_S
        puppet.step(side, *stance(puppet.figure, centre, look, side), time, time + FOOTFALL_S)
    _stand(puppet, centre + AHEAD_M * forwards(look), look, begin + 2 * FOOTFALL_S)


def _stand(puppet: Puppet, goal: np.ndarray, look: float, end: float) -> None:
    puppet.pelvis.key(end, np.array([*goal, puppet.figure.height]))
    puppet.look.key(end, look)
    puppet.bones.key(end, puppet.figure.neutral)
    puppet.poles.key(end, np.array([[1.0, 0.1, 0.0], [1.0, -0.1, 0.0]]))
    puppet.hold(end)


def centre_of(puppet: Puppet) -> np.ndarray:
    """Where somebody stands, ``(2,)``: between the ankles."""
    return (puppet.ankles[0].last[:2] + puppet.ankles[1].last[:2]) / 2


def turn(puppet: Puppet, angle: float) -> None:
    """Turn on the spot by small steps, positive to the left."""
    centre, look, begin = centre_of(puppet), float(puppet.look.last), puppet.time
    parts = int(np.ceil(abs(angle) / LARGEST_TURN))
    first = 0 if angle > 0 else 1
    for part in range(parts):
        there = look + angle * (part + 1) / parts
        for side in (first, 1 - first):
            time = puppet.time
            puppet.step(side, *stance(puppet.figure, centre, there, side), time, time + FOOTFALL_S)
            puppet.time = time + FOOTFALL_S
    end = puppet.time
    for channel in (puppet.pelvis, puppet.look, puppet.bones, puppet.poles):
        channel.hold(begin)
    _stand(puppet, centre + AHEAD_M * forwards(look + angle), look + angle, end)


def step_back(puppet: Puppet, way_m: float) -> None:
    """One foot after the other goes back, so that toes clear a seat while one turns before it."""
    look, begin = float(puppet.look.last), puppet.time
    centre = centre_of(puppet) - way_m * forwards(look)
    for side in range(2):
        time = puppet.time
        puppet.step(side, *stance(puppet.figure, centre, look, side), time, time + FOOTFALL_S)
        puppet.time = time + FOOTFALL_S
    end = puppet.time
    for channel in (puppet.pelvis, puppet.look, puppet.bones, puppet.poles):
        channel.hold(begin)
    _stand(puppet, centre + AHEAD_M * forwards(look), look, end)


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
    low = np.array([*seat_place(puppet), seat_m + ABOVE_SEAT_M])
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


def reach(
    puppet: Puppet, targets: np.ndarray, side: int, random: np.random.Generator
) -> list[tuple[float, float]]:
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


def start(puppet: Puppet, gait: Gait, index: int, front: int) -> tuple[float, np.ndarray]:
    """From standing into a walk, and how the walk is laid: turn (radians) and shift ``(2,)``.

    Args:
        puppet: Somebody who stands.
        gait: Their walk.
        index: A frame of it in which a foot has landed; it becomes the last of the puppet's motion.
        front: Which foot: 0 left, 1 right.
    """
    frames = gait.positions[index : index + 2].astype(np.float64)
    angle = float(puppet.look.last) - float(gait.looks[index])
    rear = ANKLES[1 - front]
    shift = puppet.ankles[1 - front].last[:2] - turned(frames[0, rear, :2], angle)
    there = placed(frames, angle, shift)
    way = float(np.linalg.norm(there[0, PELVIS, :2] - puppet.pelvis.last[:2]))
    pace = max(float(np.linalg.norm(frames[1, PELVIS] - frames[0, PELVIS])) * FPS, 0.4)
    begin = puppet.time
    # the last key lies on a frame
    end = np.ceil((begin + np.clip(2 * way / pace, 0.55, 1.0)) * FPS) / FPS
    puppet.lifts.append((front, begin + 0.05, float(end)))
    puppet.key_pose(float(end), there, 0)
    return angle, shift
