"""Steps of somebody who is posed by keys: from a walk to standing, on the spot, and into a walk again."""

from __future__ import annotations

import numpy as np

from motioncast.datasets.rooms.bodies import PELVIS, turned
from motioncast.datasets.rooms.contacts import FPS, speed
from motioncast.datasets.rooms.figure import ANKLES, BALLS, Figure
from motioncast.datasets.rooms.gait import Gait
from motioncast.datasets.rooms.puppet import Puppet
from motioncast.datasets.rooms.stitch import placed

FOOTFALL_S = 0.36
LARGEST_TURN = np.radians(75)
AHEAD_M = 0.03
"""The pelvis of somebody who stands is this far before the ankles."""


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
