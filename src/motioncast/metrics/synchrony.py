"""Do people who are near one another move together, more than people who never met?

The control is what makes the figure mean anything: two people who both happen to walk at first and stand later are
alike without knowing of one another.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

STILL_M_S = 1e-3
"""Who changes speed by less than this has no rhythm to share."""


def smoothed(speeds: np.ndarray, frames: int) -> np.ndarray:
    """Mean speed over so many frames, ``(..., time - frames + 1)``: who follows within that time still goes along.

    Args:
        speeds: ``(..., time)``.
        frames: Frames of a mean; those of a second forgive half a second of delay.

    Example:
        >>> smoothed(np.array([0.0, 2.0, 4.0]), 2)
        array([1., 3.])
    """
    return np.lib.stride_tricks.sliding_window_view(np.asarray(speeds, np.float64), frames, axis=-1).mean(-1)


def speed_correlation(one: np.ndarray, other: np.ndarray) -> np.ndarray:
    """Correlation over time of the speed of each person with each other one, ``(n, m)``; 0 for who never changes speed.

    Args:
        one: ``(n, time)`` m/s.
        other: ``(m, time)`` m/s.

    Example:
        >>> stop_and_go = np.array([[0.0, 1.0, 0.0, 1.0], [1.0, 0.0, 1.0, 0.0], [1.0, 1.0, 1.0, 1.0]])
        >>> speed_correlation(stop_and_go[:1], stop_and_go)
        array([[ 1., -1.,  0.]])
    """
    units = []
    for speeds in (one, other):
        beside = speeds - speeds.mean(-1, keepdims=True)
        length = np.linalg.norm(beside, axis=-1, keepdims=True)
        moving = length > STILL_M_S * np.sqrt(speeds.shape[-1])
        units.append(np.divide(beside, length, out=np.zeros_like(beside), where=moving))
    return units[0] @ units[1].T


def synchrony(one: np.ndarray, other: np.ndarray, groups: Sequence) -> tuple[np.ndarray, np.ndarray]:
    """Correlation of the speeds of neighbours, and of the same people with strangers, ``(pairs,)`` each.

    Args:
        one: ``(pairs, time)`` m/s: a person of each pair of neighbours.
        other: ``(pairs, time)``: the neighbour.
        groups: What each pair belongs to, such as a room: the others of other pairs of a group are no strangers.

    Returns:
        For each pair the correlation, and its mean with the others of all other groups; NaN where there is none.

    Example:
        >>> beats = np.array([[0.0, 1.0, 0.0, 1.0], [0.0, 0.0, 1.0, 1.0]])
        >>> [values.tolist() for values in synchrony(beats, beats, ["kitchen", "hall"])]
        [[1.0, 1.0], [0.0, 0.0]]
    """
    table = speed_correlation(one, other)
    names = np.asarray(groups)
    strangers = names[:, None] != names
    counts = strangers.sum(1)
    shuffled = np.where(strangers, table, 0).sum(1)
    return np.diagonal(table).copy(), np.divide(shuffled, counts, out=np.full(len(table), np.nan), where=counts > 0)
