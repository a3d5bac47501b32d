"""Composed scenes: takes of one person or of a couple, put into one world.

People who were recorded together stay together; everybody else is turned about the vertical and set down at
random. A place is drawn by the last frame of the history. Nobody walks through anybody else: a place at which two
strangers would come closer than arm's length at any time, later ones included, is drawn again. That selects scenes;
no position of a scene is computed from what comes later.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

PERSONAL_SPACE_M = 0.6
"""Strangers' pelvises never come closer than this."""

TRIES = 20


def turned(positions: np.ndarray, angle: float) -> np.ndarray:
    """Positions ``(..., 3)`` turned about the vertical axis by an angle in radians."""
    cosine, sine = np.cos(angle), np.sin(angle)
    matrix = np.array([[cosine, -sine, 0], [sine, cosine, 0], [0, 0, 1]], positions.dtype)
    return positions @ matrix.T


@dataclass(frozen=True, slots=True, eq=False)
class Arrangement:
    """Groups of people in one world.

    Attributes:
        positions: ``(time, all people, joints, 3)`` float32.
        places: For each group where its middle stands in the last frame of the history (m), and how far it was
            turned about the vertical (radians): ``(x, y, angle)``.
    """

    positions: np.ndarray
    places: tuple[tuple[float, float, float], ...]


def entries(shape: tuple[int, int], history: int, share: float, random: np.random.Generator) -> np.ndarray:
    """First frame in which each person is seen, ``(scenes, people)``: a share enters in the first half of the history.

    Example:
        >>> entries((1, 4), 15, 0.0, np.random.default_rng(0)).tolist()
        [[0, 0, 0, 0]]
    """
    return random.integers(1, history // 2 + 1, shape) * (random.random(shape) < share)


def arrange(
    groups: Sequence[np.ndarray], now: int, random: np.random.Generator, radius_m: float = 2.5, pelvis: int = 0
) -> Arrangement | None:
    """Groups of people set down in one world.

    The circle grows with the number of people beyond three.

    Args:
        groups: For each group ``(time, people, joints, 3)``.
        now: Last frame of the history; each group's middle in that frame is what is placed.
        random: Source of angles and places.
        radius_m: Groups stand within this distance of the origin at that moment.
        pelvis: Index of the joint that stands for a person.

    Returns:
        The arrangement, or None if none was found.

    Example:
        >>> one = np.zeros((20, 1, 15, 3), np.float32)
        >>> scene = arrange([one, one], 9, np.random.default_rng(0)).positions
        >>> scene.shape, bool(np.linalg.norm(scene[0, 0, 0] - scene[0, 1, 0]) >= PERSONAL_SPACE_M)
        ((20, 2, 15, 3), True)
    """
    # a crowd gets the room that it needs
    radius_m *= np.sqrt(max(1.0, sum(group.shape[1] for group in groups) / 3))
    placed: list[np.ndarray] = []
    places: list[tuple[float, float, float]] = []
    for group in groups:
        middle = group[now, :, pelvis].mean(0) * np.array([1, 1, 0], np.float32)
        for _ in range(TRIES):
            distance, bearing = radius_m * np.sqrt(random.uniform()), random.uniform(0, 2 * np.pi)
            place = distance * np.array([np.cos(bearing), np.sin(bearing), 0], np.float32)
            angle = random.uniform(0, 2 * np.pi)
            there = turned(group - middle, angle) + place.astype(np.float32)
            if _apart([*placed, there], pelvis):
                placed.append(there)
                places.append((float(place[0]), float(place[1]), angle))
                break
        else:
            return None
    return Arrangement(np.concatenate(placed, 1), tuple(places))


def _apart(groups: Sequence[np.ndarray], pelvis: int) -> bool:
    """Whether the people of the last group keep their personal space from all others all the time."""
    *others, group = groups
    for other in others:
        difference = group[:, :, None, pelvis, :2] - other[:, None, :, pelvis, :2]
        if (np.square(difference).sum(-1) < PERSONAL_SPACE_M**2).any():
            return False
    return True
