"""The build of one person, and poses of it: bones as directions seen from the body, and where an arm reaches."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from motioncast.core.limbs import middle_joint
from motioncast.core.rotation import between, rotate
from motioncast.core.skeletons import CMU31
from motioncast.datasets.rooms.bodies import PELVIS, turned
from motioncast.datasets.rooms.contacts import speed
from motioncast.datasets.rooms.gait import Gait

HIPS, KNEES, ANKLES, BALLS, TIPS = (
    tuple(CMU31.index(side + name) for side in "lr") for name in ("hipjoint", "femur", "tibia", "foot", "toes")
)
SHOULDERS, ELBOWS, FOREARMS, WRISTS = (
    tuple(CMU31.index(side + name) for side in "lr") for name in ("clavicle", "humerus", "radius", "wrist")
)
HANDS = tuple(
    tuple(CMU31.index(side + name) for name in ("radius", "wrist", "hand", "fingers", "thumb")) for side in "lr"
)
LEGS = {*KNEES, *ANKLES, *BALLS, *TIPS}
UPPER = tuple(joint for joint in range(1, len(CMU31)) if joint not in {*LEGS, *HIPS})
TRUNK = tuple(joint for joint in UPPER if joint not in {*ELBOWS, *HANDS[0], *HANDS[1]})
PARENTS = np.array(CMU31.parents)

STRAIGHT = 0.985
"""Share of its length that the leg of somebody standing has."""


@dataclass(frozen=True, slots=True, eq=False)
class Figure:
    """The build of one person and how they stand.

    Attributes:
        lengths: Of bones, ``(31,)`` metres.
        neutral: Directions of bones of somebody who stands, seen from the body, ``(31, 3)``.
        feet: Directions of ankle to ball and ball to tip of a flat foot, seen along the foot, ``(2 sides, 2, 3)``.
        ankles: Height of the ankles of somebody who stands, ``(2,)``.
        height: Height of the pelvis of somebody who stands.
        width: From ankle to ankle.
    """

    lengths: np.ndarray
    neutral: np.ndarray
    feet: np.ndarray
    ankles: np.ndarray
    height: float
    width: float = 0.2

    @property
    def leg(self) -> float:
        """Length of the left leg."""
        return float(self.lengths[KNEES[0]] + self.lengths[ANKLES[0]])


def directions(positions: np.ndarray, look: np.ndarray | float) -> np.ndarray:
    """Unit directions of the bones of ``(..., 31, 3)`` seen from a body that faces ``look`` radians."""
    bones = positions - positions[..., PARENTS, :]
    bones[..., PELVIS, :] = [0, 0, 1]
    bones = bones / np.maximum(np.linalg.norm(bones, axis=-1, keepdims=True), 1e-9)
    return turned(bones, -np.asarray(look)[..., None])


def figure_of(gait: Gait) -> Figure:
    """How a person who is only known walking would stand: the mean of the walk, on flat feet."""
    positions = gait.positions.astype(np.float64)
    neutral = directions(positions, gait.looks).mean(0)
    neutral /= np.maximum(np.linalg.norm(neutral, axis=-1, keepdims=True), 1e-9)
    feet, ankles = np.zeros((2, 2, 3)), np.zeros(2)
    for side in range(2):
        points = positions[:, [ANKLES[side], BALLS[side], TIPS[side]]]
        rest = speed(points).max(-1)
        flat = points[rest <= np.percentile(rest, 10)]
        bones = turned(np.diff(flat, axis=1), -toe_out(flat[:, 0], flat[:, 2])[:, None])
        feet[side] = np.median(bones / np.linalg.norm(bones, axis=-1, keepdims=True), 0)
        ankles[side] = np.median(flat[:, 0, 2])
    leg = gait.lengths[KNEES[0]] + gait.lengths[ANKLES[0]]
    hip = neutral[HIPS[0], 2] * gait.lengths[HIPS[0]]
    return Figure(gait.lengths, neutral, feet, ankles, float(ankles.mean() + STRAIGHT * leg - hip))


def toe_out(ankle: np.ndarray, tip: np.ndarray) -> np.ndarray:
    """Where a foot points, ``(...)`` radians."""
    return np.arctan2(tip[..., 1] - ankle[..., 1], tip[..., 0] - ankle[..., 0])


def pitched(vectors: np.ndarray, angle: np.ndarray | float) -> np.ndarray:
    """Vectors ``(..., 3)`` seen from a body, bent forwards by angles ``(...)`` in radians."""
    cosine, sine = np.cos(angle), np.sin(angle)
    x, y, z = np.moveaxis(vectors, -1, 0)
    return np.stack([cosine * x + sine * z, y + 0 * sine, cosine * z - sine * x], -1)


def bent(bones: np.ndarray, angle: float) -> np.ndarray:
    """Directions ``(31, 3)`` with the trunk bent forwards by an angle in radians; arms and legs keep theirs."""
    leaning = bones.copy()
    leaning[list(TRUNK)] = pitched(bones[list(TRUNK)], angle)
    return leaning


def arm_towards(figure: Figure, bones: np.ndarray, side: int, target: np.ndarray) -> np.ndarray:
    """Directions ``(31, 3)`` with one arm that leads to a target, ``(3,)`` seen from the pelvis."""
    lengths, bones = figure.lengths, bones.copy()
    shoulder = shoulder_of(figure, bones, side)
    upper, lower = lengths[ELBOWS[side]], lengths[FOREARMS[side]] + lengths[WRISTS[side]]
    pole = np.array([-0.4, (1 - 2 * side) * 0.5, -0.8])
    elbow, wrist = middle_joint(shoulder, target, upper, lower, pole)
    before = bones[FOREARMS[side]].copy()
    bones[ELBOWS[side]] = (elbow - shoulder) / upper
    swing = between(before, (wrist - elbow) / lower)
    hand = list(HANDS[side])
    bones[hand] = rotate(swing, bones[hand])
    return bones


def shoulder_of(figure: Figure, bones: np.ndarray, side: int) -> np.ndarray:
    """Where a shoulder is, ``(3,)`` seen from the pelvis."""
    place, joint = np.zeros(3), SHOULDERS[side]
    while joint > 0:
        place = place + bones[joint] * figure.lengths[joint]
        joint = int(PARENTS[joint])
    return place


def arm_length(figure: Figure, side: int) -> float:
    """From shoulder to wrist, metres."""
    return float(figure.lengths[[ELBOWS[side], FOREARMS[side], WRISTS[side]]].sum())
