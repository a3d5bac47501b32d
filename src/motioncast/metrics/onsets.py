"""Who sets out when: how long until a neighbour does, too?

Two people who go somewhere together set out together. As with synchrony, only the comparison with people who never met
means anything: in a hall where everybody walks off now and then somebody always does so soon after somebody else.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

STANDING_M_S, WALKING_M_S = 0.15, 0.4
"""Who was slower than the first and comes to be faster than the second has set out."""


def onsets(speeds: np.ndarray) -> np.ndarray:
    """The frames in which a person sets out, ``(n,)``: faster than 0.4 m/s, for the first time since slower than 0.15.

    Args:
        speeds: ``(time,)`` m/s over the ground, smoothed (:func:`motioncast.metrics.synchrony.smoothed`): a sway is no
            start.

    Example:
        >>> onsets(np.array([0.0, 0.3, 0.5, 0.3, 0.5, 0.1, 0.9])).tolist()
        [2, 6]
    """
    found, stood = [], False
    for frame, speed in enumerate(speeds.tolist()):
        stood = stood or speed < STANDING_M_S
        if stood and speed > WALKING_M_S:
            found.append(frame)
            stood = False
    return np.array(found, int)


def onset_lag(one: np.ndarray, other: np.ndarray, fps: float) -> float:
    """Seconds from when one of two people sets out to when the other does, before or after, mean over all onsets.

    NaN where one of them never does.

    Args:
        one: Frames of its onsets, ``(n,)``.
        other: Likewise.
        fps: Frames a second.

    Example:
        >>> onset_lag(np.array([10, 60]), np.array([15]), fps=10)  # 0.5 and 4.5 s, and back 0.5 s
        1.8333333333333333
    """
    if not len(one) or not len(other):
        return float("nan")
    apart = np.abs(one[:, None] - other)
    return float(np.concatenate([apart.min(1), apart.min(0)]).mean() / fps)


def onset_lags(
    one: Sequence[np.ndarray], other: Sequence[np.ndarray], groups: Sequence, fps: float
) -> tuple[np.ndarray, np.ndarray]:
    """The lag of neighbours, and of the same people with strangers, ``(pairs,)`` seconds each.

    Args:
        one: Onsets of a person of each pair of neighbours.
        other: Those of the neighbour.
        groups: What each pair belongs to, such as a room: the others of other pairs of a group are no strangers.
        fps: Frames a second.

    Returns:
        For each pair the lag, and its mean with the others of all other groups; NaN where somebody never sets out.

    Example:
        >>> early, late = np.array([5]), np.array([25])
        >>> [lags.tolist() for lags in onset_lags([early, late], [early, late], ["kitchen", "hall"], fps=10)]
        [[0.0, 0.0], [2.0, 2.0]]
    """
    table = np.array([[onset_lag(mine, theirs, fps) for theirs in other] for mine in one])
    names = np.asarray(groups)
    known = (names[:, None] != names) & ~np.isnan(table)
    counts = known.sum(1)
    sums = np.where(known, table, 0).sum(1)
    return np.diagonal(table).copy(), np.divide(sums, counts, out=np.full(len(table), np.nan), where=counts > 0)
