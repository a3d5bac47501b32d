"""A cook's motion: from a pose of rest into the pose that is characteristic of each step, and back.

Every step is one motion: hands leave the rest, are at their places at the characteristic moment, somewhere between 30
and 80 % of the step, and come back. While they work they swing about the place, by a movement of the action's own.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from motioncast.datasets.kitchen.dishes import LABELS, PLACES, Step
from motioncast.datasets.kitchen.figure import Figure, Posture, between, draw_figure, joints

TARGETS = np.array([
    [0.40, -0.75, 1.00], [0.40, 0.70, 1.45], [0.45, 0.70, 0.85], [0.50, 0.20, 0.75], [0.50, 0.30, 1.60],
    [0.50, -0.35, 1.55], [0.48, 0.05, 0.98], [0.52, -0.22, 1.02], [0.50, -0.50, 1.05], [0.50, 0.45, 0.95],
    [0.42, 0.28, 1.00], [0.10, 0.55, 1.15],
])  # fmt: skip
"""Where the places of ``PLACES`` are, metres from the cook."""

RIGHT_HAND = {
    "take": (0, 0, 0), "put": (-0.02, -0.04, 0.06), "wash": (0, -0.05, 0), "peel": (-0.03, -0.08, 0.10),
    "cut": (0, -0.06, 0.05), "pour": (0, -0.03, 0.20), "stir": (0, 0, 0.10), "season": (0.02, 0, 0.26),
    "open": (-0.04, -0.07, 0.12), "taste": (-0.25, 0.15, 0.45), "wipe": (0.06, -0.12, -0.02),
    "serve": (0.04, -0.10, 0.04), "hand over": (0.05, 0, 0), "receive": (0, 0, 0),
}  # fmt: skip
LEFT_HAND = {
    "wash": (0, 0.05, 0), "peel": (-0.05, 0.07, 0.09), "cut": (0, 0.10, 0.03), "open": (-0.06, 0.06, 0.08),
    "serve": (0.04, 0.10, 0.04), "put": (-0.04, 0.14, 0.02),
}  # fmt: skip
"""Where hands are from the place, in the direction that the trunk faces; a left hand that is not named rests."""

SWING = {
    "wash": (0, 0.05, 0), "peel": (0.08, 0, 0), "cut": (0, 0, 0.05), "stir": (0.06, 0.06, 0), "season": (0, 0.04, 0),
    "wipe": (0.05, 0.18, 0), "pour": (0, 0, 0.05),
}  # fmt: skip
"""How far the right hand swings while it works."""

SWING_HZ = 1.0
REST = np.array([[0.26, -0.17, 1.02], [0.26, 0.17, 1.02]])
MEAN_S = 5.2
"""Mean length of a step, that of MPII Cooking II."""


@dataclass(frozen=True, slots=True)
class Style:
    """What stays with a cook: body, handedness, how the kitchen is laid out, how exactly hands come to places."""

    figure: Figure
    left_handed: bool
    places: np.ndarray
    turning: float
    spread_m: float


def draw_style(random: np.random.Generator, beside: int = 1) -> Style:
    """A cook in a kitchen; ``beside`` is +1 where a second cook stands to the left, -1 to the right."""
    places = TARGETS + random.normal(0, 0.05, TARGETS.shape)
    places[PLACES.index("side"), 1] *= beside
    return Style(
        draw_figure(random), bool(random.random() < 0.1), places, random.uniform(0.6, 0.9), random.uniform(0.02, 0.05)
    )


@dataclass(frozen=True, slots=True, eq=False)
class Motion:
    """What a cook does over time.

    Attributes:
        style: The cook.
        steps: The steps in words.
        ends_s: When each step ends; the first begins at 0.
        peak_s: When each pose is characteristic.
        keys: The characteristic posture of each step.
    """

    style: Style
    steps: tuple[Step, ...]
    ends_s: np.ndarray
    peak_s: np.ndarray
    keys: Posture

    @property
    def actions(self) -> np.ndarray:
        """The label of each step, ``(steps,)`` indices of ``LABELS``."""
        return np.array([LABELS.index(step.label) for step in self.steps])

    def at(self, times: np.ndarray) -> np.ndarray:
        """The pose ``(n, 9, 3)`` at moments ``(n,)`` in seconds; after the end the cook rests."""
        starts = np.concatenate([[0.0], self.ends_s[:-1]])
        step = np.clip(np.searchsorted(self.ends_s, times, "right"), 0, len(self.steps) - 1)
        start, end, peak = starts[step], self.ends_s[step], self.peak_s[step]
        rising = (times - start) / (peak - start)
        falling = (end - times) / (end - peak)
        near = np.clip(np.minimum(rising, falling), 0, 1)
        share = near**2 * (3 - 2 * near)
        keys = Posture(*(getattr(self.keys, name)[step] for name in ("turn", "bend", "nod", "hands")))
        posture = between(rest(len(step)), keys, share)
        swings = np.array([SWING.get(entry.label, (0, 0, 0)) for entry in self.steps])[step]
        wave = share * np.sin(2 * np.pi * SWING_HZ * (times - peak))
        posture.hands[:, int(self.style.left_handed)] += wave[:, None] * swings
        return joints(self.style.figure, posture)


def rest(count: int) -> Posture:
    """Upright, hands before the body."""
    still = np.zeros(count)
    return Posture(still, still + 0.08, still + 0.25, np.tile(REST, (count, 1, 1)))


def perform(
    steps: Sequence[Step], style: Style, random: np.random.Generator, ends_s: np.ndarray | None = None
) -> Motion:
    """A cook who does the steps.

    Args:
        steps: What to do.
        style: Who does it.
        random: Source of lengths and of how exactly hands come to their places.
        ends_s: When the steps end, where another cook sets the pace.
    """
    count = len(steps)
    if ends_s is None:
        ends_s = np.cumsum(np.clip(random.lognormal(np.log(MEAN_S) - 0.125, 0.5, count), 1.5, 15))
    lengths = np.diff(ends_s, prepend=0)
    peak = ends_s - lengths * (1 - random.uniform(0.3, 0.8, count))
    place = style.places[[PLACES.index(step.place) for step in steps]]
    place = place + random.normal(0, style.spread_m, place.shape)
    turn = style.turning * np.arctan2(place[:, 1], place[:, 0]) + random.normal(0, 0.06, count)
    low = np.clip(1.05 - place[:, 2], 0, 0.4)
    bend = 0.08 + 1.2 * low + random.normal(0, 0.04, count)
    nod = np.clip(1.35 - place[:, 2], -0.3, 0.5) + random.normal(0, 0.06, count)
    rests = REST[1] + random.normal(0, 0.03, (count, 3))
    tables = (RIGHT_HAND, LEFT_HAND)
    hands = np.stack([_hand(steps, table, place, turn, rests) for table in tables], 1)
    if style.left_handed:
        hands = hands[:, ::-1]
    return Motion(style, tuple(steps), ends_s, peak, Posture(turn, bend, nod, hands))


def _hand(steps: Sequence[Step], table: dict, place: np.ndarray, turn: np.ndarray, rests: np.ndarray) -> np.ndarray:
    """Where a hand is in each step, ``(steps, 3)``."""
    busy = np.array([step.label in table for step in steps])
    ahead, aside, up = np.array([table.get(step.label, (0, 0, 0)) for step in steps]).T
    cos, sin = np.cos(turn), np.sin(turn)
    offset = np.stack([cos * ahead - sin * aside, sin * ahead + cos * aside, up], -1)
    resting = np.stack([cos * rests[:, 0] - sin * rests[:, 1], sin * rests[:, 0] + cos * rests[:, 1], rests[:, 2]], -1)
    return np.where(busy[:, None], place + offset, resting)
