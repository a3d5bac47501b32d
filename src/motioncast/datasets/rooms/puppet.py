"""A person posed by keys: pelvis, directions of bones and feet are interpolated, legs follow by inverse kinematics.

Bones keep their lengths and a standing foot its place; all that moves does so on smooth curves. What a puppet does is
synthetic and is marked so.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from motioncast.core.limbs import REACH, middle_joint
from motioncast.core.skeletons import CMU31
from motioncast.datasets.rooms.bodies import PELVIS, facing, turned
from motioncast.datasets.rooms.contacts import FPS, smoothed
from motioncast.datasets.rooms.figure import (
    ANKLES,
    BALLS,
    HIPS,
    KNEES,
    LEGS,
    PARENTS,
    TIPS,
    UPPER,
    Figure,
    directions,
    pitched,
    toe_out,
)
from motioncast.datasets.rooms.keys import hermite

SOLE_M = 0.005
"""No joint of a foot comes lower."""

LIFT_M = 0.07
"""How high a foot is lifted in a step."""


@dataclass(slots=True, eq=False)
class Channel:
    """Keys of one quantity."""

    times: list[float] = field(default_factory=list)
    values: list[np.ndarray] = field(default_factory=list)
    slopes: list[np.ndarray] = field(default_factory=list)

    def key(self, time: float, value: np.ndarray | float, slope: np.ndarray | float = 0.0) -> None:
        """Add a key; slopes per second."""
        value = np.asarray(value, np.float64)
        self.times.append(time)
        self.values.append(value)
        self.slopes.append(np.broadcast_to(np.asarray(slope, np.float64), value.shape))

    def hold(self, time: float) -> None:
        """Stay at the last value until a time."""
        if time > self.times[-1] + 1e-6:
            self.key(time, self.values[-1])

    @property
    def last(self) -> np.ndarray:
        """The last value."""
        return self.values[-1]

    def at(self, moments: np.ndarray) -> np.ndarray:
        """Values at moments in seconds."""
        if len(self.times) == 1:
            return np.broadcast_to(self.values[0], (len(moments), *self.values[0].shape))
        return hermite(np.array(self.times), np.stack(self.values), np.stack(self.slopes), moments)


class Puppet:
    """Keys of one person from one real frame on; ``motion`` gives the frames that follow.

    Args:
        figure: The person's build.
        before: Two frames that were last, ``(2, 31, 3)``; motion goes on from the second with its speed.
    """

    def __init__(self, figure: Figure, before: np.ndarray) -> None:
        self.figure = figure
        self.time = 0.0
        self.pelvis, self.look, self.bones, self.poles = Channel(), Channel(), Channel(), Channel()
        self.ankles, self.toes, self.feet = ([Channel(), Channel()] for _ in range(3))
        self.lifts: list[tuple[int, float, float]] = []
        self.key_pose(0.0, before, 1)

    def key_pose(self, time: float, frames: np.ndarray, index: int) -> None:
        """A key of a whole real pose and its speed: frame ``index`` of two frames ``(2, 31, 3)``."""
        frames = frames.astype(np.float64)
        looks = np.unwrap(facing(frames))
        if self.look.times:  # the short way round
            looks += 2 * np.pi * np.round((self.look.last - looks[0]) / (2 * np.pi))
        pose, rate = frames[index], (frames[1] - frames[0]) * FPS
        seen = directions(frames, looks)
        self.pelvis.key(time, pose[PELVIS], rate[PELVIS])
        self.look.key(time, looks[index], (looks[1] - looks[0]) * FPS)
        self.bones.key(time, seen[index], (seen[1] - seen[0]) * FPS)
        self.poles.key(time, np.stack([self._pole(pose, side, looks[index]) for side in range(2)]))
        for side in range(2):
            points = frames[:, [ANKLES[side], BALLS[side], TIPS[side]]]
            out = toe_out(points[:, 0], points[:, 2])
            previous = self.toes[side].last if self.toes[side].times else looks[index]
            out = previous + (out - previous + np.pi) % (2 * np.pi) - np.pi
            bones = turned(np.diff(points, axis=1), -out[:, None])
            self.ankles[side].key(time, points[index, 0], (points[1, 0] - points[0, 0]) * FPS)
            self.toes[side].key(time, out[index])
            self.feet[side].key(time, bones[index], (bones[1] - bones[0]) * FPS)
        self.time = time

    @staticmethod
    def _pole(pose: np.ndarray, side: int, look: float) -> np.ndarray:
        """Where a knee of a real pose bends to, seen from the body."""
        hip, knee, ankle = pose[HIPS[side]], pose[KNEES[side]], pose[ANKLES[side]]
        along = (ankle - hip) / np.linalg.norm(ankle - hip)
        aside = knee - hip - ((knee - hip) @ along) * along
        return turned(aside / max(float(np.linalg.norm(aside)), 1e-6), -look)

    def step(self, side: int, place: np.ndarray, out: float, start: float, end: float) -> None:
        """Lift a foot and set it down flat elsewhere.

        Args:
            side: 0 left, 1 right.
            place: Of the ankle, ``(2,)``.
            out: Where the foot points, radians.
            start: When it leaves the floor.
            end: When it is down.
        """
        for channel in (self.ankles[side], self.toes[side], self.feet[side]):
            channel.hold(start)
        self._flat(side, place, out, end)
        self.lifts.append((side, start, end))

    def settle(self, side: int, end: float) -> None:
        """Let a standing foot come down flat where it is."""
        self._flat(side, self.ankles[side].last[:2], float(self.toes[side].last), end)

    def _flat(self, side: int, place: np.ndarray, out: float, end: float) -> None:
        figure = self.figure
        lengths = figure.lengths[[BALLS[side], TIPS[side]], None]
        before = float(self.toes[side].last)
        self.ankles[side].key(end, np.array([*place, figure.ankles[side]]))
        self.toes[side].key(end, before + (out - before + np.pi) % (2 * np.pi) - np.pi)
        self.feet[side].key(end, figure.feet[side] * lengths)

    def hold(self, time: float) -> None:
        """Stay as one is until a time."""
        for channel in (self.pelvis, self.look, self.bones, self.poles, *self.ankles, *self.toes, *self.feet):
            channel.hold(time)
        self.time = time

    def motion(self, random: np.random.Generator, sway: float = 1.0) -> np.ndarray:
        """The frames after the first key up to the last, ``(time, 31, 3)``.

        Args:
            random: Source of the little movements of somebody who stands or sits.
            sway: How large these are.
        """
        frames = round(self.time * FPS)
        moments = (np.arange(frames) + 1) / FPS
        bones, lengths = self.bones.at(moments), self.figure.lengths
        bones = bones / np.maximum(np.linalg.norm(bones, axis=-1, keepdims=True), 1e-9)
        bones = _swayed(bones, frames, random, sway)
        look, pelvis = self.look.at(moments), self.pelvis.at(moments).copy()
        bones = turned(bones, look[:, None])
        ankles = np.stack([self.ankles[side].at(moments) for side in range(2)], 1)
        for side, start, end in self.lifts:
            u = np.clip((moments - start) / (end - start), 0, 1)
            ankles[:, side, 2] += LIFT_M * 16 * (u * (1 - u)) ** 2
        feet = self._feet(moments)
        lowest = np.minimum(feet[:, :, 0, 2], feet[:, :, :, 2].sum(2)) + ankles[..., 2]
        ankles[..., 2] += np.maximum(SOLE_M - lowest, 0)
        positions = np.zeros((frames, len(CMU31), 3))
        hips = np.stack([bones[:, hip] * lengths[hip] for hip in HIPS], 1)
        # nobody's legs are longer than they are: the pelvis comes down where a foot is far
        far = np.linalg.norm((ankles - hips)[..., :2] - pelvis[:, None, :2], axis=-1)
        room = np.sqrt(np.maximum((REACH * self.figure.leg) ** 2 - far**2, 0.01))
        pelvis[:, 2] = np.minimum(pelvis[:, 2], (ankles[..., 2] + room - hips[..., 2]).min(1))
        positions[:, PELVIS] = pelvis
        poles = turned(self.poles.at(moments), look[:, None])
        for joint in range(1, len(CMU31)):
            if joint not in LEGS:
                positions[:, joint] = positions[:, PARENTS[joint]] + bones[:, joint] * lengths[joint]
        for side in range(2):
            knee, ankle = KNEES[side], ANKLES[side]
            positions[:, knee], positions[:, ankle] = middle_joint(
                positions[:, HIPS[side]], ankles[:, side], lengths[knee], lengths[ankle], poles[:, side]
            )
            positions[:, BALLS[side]] = positions[:, ankle] + feet[:, side, 0]
            positions[:, TIPS[side]] = positions[:, BALLS[side]] + feet[:, side, 1]
        return positions

    def _feet(self, moments: np.ndarray) -> np.ndarray:
        """Bones of both feet in the world, ``(time, 2 sides, 2, 3)``."""
        feet = np.stack(
            [turned(self.feet[side].at(moments), self.toes[side].at(moments)[:, None]) for side in range(2)], 1
        )
        lengths = self.figure.lengths[[BALLS, TIPS]].T[..., None]
        return feet * lengths / np.maximum(np.linalg.norm(feet, axis=-1, keepdims=True), 1e-9)


def _swayed(bones: np.ndarray, frames: int, random: np.random.Generator, size: float) -> np.ndarray:
    """Directions ``(time, 31, 3)`` of the upper body, turned a little to and fro, and the head further."""
    if frames < 2:
        return bones
    ends = np.minimum(np.minimum(np.arange(frames) + 1, np.arange(frames)[::-1] + 1) / (0.8 * FPS), 1)
    noise = smoothed(random.normal(0, 1, (frames, 3)), 14)
    noise *= size * np.radians([2.0, 3.0, 14.0]) * 7 * ends[:, None] ** 2  # smoothing leaves a seventh
    swayed = bones.copy()
    body, head = list(UPPER), [CMU31.index("upperneck"), CMU31.index("head")]
    swayed[:, body] = pitched(bones[:, body], noise[:, 0, None])
    swayed[:, body] = turned(swayed[:, body], noise[:, 1, None])
    swayed[:, head] = turned(swayed[:, head], noise[:, 2, None])
    return swayed
