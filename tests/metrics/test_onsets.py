from __future__ import annotations

import numpy as np
import pytest

from motioncast.metrics.onsets import onset_lag, onset_lags, onsets


def paces(count: int, seed: int = 0) -> np.ndarray:
    """Speeds of people who stand and walk by turns, ``(count, time 200)`` m/s."""
    random = np.random.default_rng(seed)
    phase, period = random.uniform(0, 200, (count, 1)), random.uniform(60, 120, (count, 1))
    return np.maximum(np.sin(2 * np.pi * (np.arange(200) + phase) / period), 0)


def test_naive_twin_of_onsets() -> None:
    speeds = np.random.default_rng(0).uniform(0, 0.6, 300)
    expected = []
    for frame in range(300):
        before = speeds[(expected[-1] + 1 if expected else 0) : frame]
        if speeds[frame] > 0.4 and (before < 0.15).any():
            expected.append(frame)
    assert onsets(speeds).tolist() == expected
    assert len(expected) > 20


def test_who_walks_on_or_stands_never_sets_out() -> None:
    assert len(onsets(np.full(50, 1.2))) == len(onsets(np.zeros(50))) == 0
    assert np.isnan(onset_lag(np.array([3]), np.zeros(0, int), fps=25))


def test_naive_twin_of_lags() -> None:
    starts = [onsets(pace) for pace in paces(8)]
    groups = ["a", "a", "b", "c"]
    real, shuffled = onset_lags(starts[:4], starts[4:], groups, fps=25)

    def lag(one: np.ndarray, other: np.ndarray) -> float:
        waits = [min(abs(a - b) for b in there) for here, there in ((one, other), (other, one)) for a in here]
        return float(np.mean(waits)) / 25

    for pair in range(4):
        assert real[pair] == pytest.approx(lag(starts[pair], starts[4 + pair]))
        strangers = [other for other in range(4) if groups[other] != groups[pair]]
        assert shuffled[pair] == pytest.approx(np.mean([lag(starts[pair], starts[4 + other]) for other in strangers]))


def test_who_follows_half_a_second_later_lags_half_a_second() -> None:
    pace = paces(1)[0]
    first, later = onsets(np.append(pace, np.zeros(13))), onsets(np.append(np.zeros(13), pace))
    assert len(first) == len(later) >= 2
    assert onset_lag(first, later, fps=26) == pytest.approx(0.5)
    assert onset_lag(first, later, fps=26) == onset_lag(later, first, fps=26)
