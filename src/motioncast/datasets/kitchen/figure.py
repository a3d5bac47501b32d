"""A cook's upper body: nine joints from where the trunk turns and where the hands are, by two-bone inverse kinematics.

A cook stands at the origin, faces +x, y to the left, z up, floor at 0.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from motioncast.core.limbs import middle_joint
from motioncast.core.rotation import from_euler, rotate

ELBOWS_LEAD = np.array([[-0.4, -0.6, -0.8], [-0.4, 0.6, -0.8]])
"""Where the right and the left elbow bend to: back, aside and down."""


@dataclass(frozen=True, slots=True)
class Figure:
    """Lengths of a cook's body, metres."""

    hip: float
    trunk: float
    shoulders: float
    neck: float
    upper_arm: float
    forearm: float


def draw_figure(random: np.random.Generator) -> Figure:
    """A body: one factor for all of it, one for each length."""
    whole = random.normal(1, 0.05)
    return Figure(*(whole * random.normal(1, 0.03, 6) * np.array([0.95, 0.52, 0.36, 0.20, 0.29, 0.26])))


@dataclass(frozen=True, slots=True, eq=False)
class Posture:
    """What decides a pose, for n poses.

    Attributes:
        turn: How far the trunk is turned to the left, ``(n,)`` radians.
        bend: How far it is bent forwards, ``(n,)``.
        nod: How far the head is bent beyond it, ``(n,)``.
        hands: Where the right and the left wrist are, ``(n, 2, 3)`` metres.
    """

    turn: np.ndarray
    bend: np.ndarray
    nod: np.ndarray
    hands: np.ndarray


def between(one: Posture, other: Posture, share: np.ndarray) -> Posture:
    """From one posture towards another, ``share (n,)`` of the way."""
    wide = share[:, None, None]
    return Posture(
        one.turn + share * (other.turn - one.turn),
        one.bend + share * (other.bend - one.bend),
        one.nod + share * (other.nod - one.nod),
        one.hands + wide * (other.hands - one.hands),
    )


def joints(figure: Figure, posture: Posture) -> np.ndarray:
    """Positions ``(n, 9, 3)`` in the order of ``core.skeletons.UPPER9``; a hand comes as near as it can."""
    trunk = from_euler(np.stack([posture.turn, posture.bend], -1), "zy")
    skull = from_euler(np.stack([posture.turn, posture.bend + posture.nod], -1), "zy")
    pelvis = np.broadcast_to([0.0, 0.0, figure.hip], (len(trunk), 3))
    neck = pelvis + rotate(trunk, np.array([0.0, 0.0, figure.trunk]))
    head = neck + rotate(skull, np.array([0.05, 0.0, figure.neck]))
    arms = []
    for hand, side in enumerate((-1, 1)):
        shoulder = neck + rotate(trunk, np.array([0.0, side * figure.shoulders / 2, -0.04]))
        lead = rotate(trunk, ELBOWS_LEAD[hand])
        elbow, wrist = middle_joint(shoulder, posture.hands[:, hand], figure.upper_arm, figure.forearm, lead)
        arms += [shoulder, elbow, wrist]
    return np.stack([head, neck, *arms, pelvis], 1)
