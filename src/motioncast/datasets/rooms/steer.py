"""Bending a walk: frame by frame the whole body is turned a little about the foot that stands.

The standing foot turns on its spot and does not slide, as it would if the path were bent about the pelvis (path
editing after Gleicher, "Motion path editing", I3D 2001).
"""

from __future__ import annotations

import numpy as np

from motioncast.datasets.rooms.bodies import turned
from motioncast.datasets.rooms.contacts import FPS

RAMP = 12
"""Frames over which a rate of turning is taken up."""


def rates(before: float, first: np.ndarray, second: np.ndarray, frames: int) -> np.ndarray:
    """Rates of turning ``(ways, frames)`` radians a second: from one to a first, and half way to a second."""
    time = np.arange(frames)
    rise, change = (_eased((time - start) / RAMP) for start in (0, frames // 2))
    return before + (first[:, None] - before) * rise + (second - first)[:, None] * change


def _eased(share: np.ndarray) -> np.ndarray:
    share = np.clip(share, 0, 1)
    return share**2 * (3 - 2 * share)


def bends(points: np.ndarray, rate: np.ndarray, fixed: int) -> tuple[np.ndarray, np.ndarray]:
    """How each frame is turned and shifted, for several ways to bend one walk.

    Args:
        points: The pivot of each frame, ``(time, 2)``.
        rate: ``(ways, time)`` radians a second.
        fixed: The frame that stays as it is.

    Returns:
        Angles ``(ways, time)`` about the origin and the shifts ``(ways, time, 2)`` that follow.

    Example:
        >>> angle, shift = bends(np.zeros((26, 2)), np.full((1, 26), 1.0), 0)
        >>> float(angle[0, -1].round(6)), bool(np.all(shift == 0))
        (1.0, True)
    """
    angle = np.cumsum(rate, 1) / FPS
    before = np.concatenate([np.zeros((len(rate), 1)), angle[:, :-1]], 1)
    shift = np.cumsum(turned(points[None], before) - turned(points[None], angle), 1)
    start = angle[:, fixed, None]
    return angle - start, turned(shift - shift[:, fixed, None], -start)
