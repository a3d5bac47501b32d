"""A tracker's life: what happens to a history before a model sees it.

Only the history is worsened; the truth stays what it was.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from motioncast.datasets.mixer import entries
from motioncast.datasets.windows import Windows

NOISE_M = 0.02
DROPPED = 0.2
LATE = 0.5

Worsened = tuple[np.ndarray, np.ndarray]
"""Positions and mask of histories."""


def noisy(positions: np.ndarray, observed: np.ndarray, random: np.random.Generator) -> Worsened:
    """Every joint is off by 20 mm a coordinate (standard deviation), anew in each frame."""
    return positions + random.normal(0, NOISE_M, positions.shape).astype(np.float32), observed


def dropped(positions: np.ndarray, observed: np.ndarray, random: np.random.Generator) -> Worsened:
    """A fifth of the joints are not seen, in the last frame too; one joint of each person is always seen there."""
    seen = observed & (random.random(observed.shape) >= DROPPED)
    seen[:, -1, :, 0] = observed[:, -1, :, 0]
    return positions, seen


def late(positions: np.ndarray, observed: np.ndarray, random: np.random.Generator) -> Worsened:
    """Half of the people enter within the first half of the history."""
    scenes, history, people = observed.shape[:3]
    entry = entries((scenes, people), history, LATE, random)
    return positions, observed & (np.arange(history)[:, None, None] >= entry[:, None, :, None])


CONDITIONS: dict[str, Callable[[np.ndarray, np.ndarray, np.random.Generator], Worsened]] = {
    "noisy": noisy,
    "dropped": dropped,
    "late": late,
}
"""Conditions by name; without one a history is handed over as it was captured."""


def worsened(windows: Windows, condition: str, seed: int) -> Windows:
    """Windows whose histories a tracker has seen under a condition; the same for the same seed."""
    positions, observed = CONDITIONS[condition](*windows.past, np.random.default_rng(seed))
    return replace(windows, seen=(positions, observed))
