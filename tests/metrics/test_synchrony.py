from __future__ import annotations

import numpy as np
import pytest

from motioncast.metrics.synchrony import smoothed, speed_correlation, synchrony


@pytest.fixture
def speeds() -> np.ndarray:
    """Speeds of six people, ``(6, 40)``."""
    return np.abs(np.cumsum(np.random.default_rng(3).normal(size=(6, 40)), 1))


def test_naive_twin_of_the_correlation(speeds: np.ndarray) -> None:
    found = speed_correlation(speeds[:2], speeds[2:])
    for i, k in np.ndindex(2, 4):
        assert found[i, k] == pytest.approx(np.corrcoef(speeds[i], speeds[2 + k])[0, 1])


def test_naive_twin_of_shuffling(speeds: np.ndarray) -> None:
    groups = ["a", "a", "b"]
    real, shuffled = synchrony(speeds[:3], speeds[3:], groups)
    table = np.corrcoef(speeds)[:3, 3:]
    for pair in range(3):
        strangers = [table[pair, k] for k in range(3) if groups[k] != groups[pair]]
        assert real[pair] == pytest.approx(table[pair, pair])
        assert shuffled[pair] == pytest.approx(np.mean(strangers))


def test_scale_and_level_do_not_matter_and_neither_does_the_order(speeds: np.ndarray) -> None:
    one, other = speeds[:3], speeds[3:]
    wanted = synchrony(one, other, [0, 1, 2])
    for found in (synchrony(3 * one + 1, other, [0, 1, 2]), synchrony(other, one, [0, 1, 2])):
        np.testing.assert_allclose(found[0], wanted[0])
    turned = synchrony(one[::-1], other[::-1], [2, 1, 0])
    np.testing.assert_allclose(turned[1][::-1], wanted[1])


def test_couples_are_told_from_strangers_even_where_one_follows() -> None:
    random = np.random.default_rng(0)
    beat = smoothed(random.random((20, 300)) > 0.5, 40)
    one, late = beat[:, 10:], beat[:, :-10]  # the other follows by ten frames
    real, shuffled = synchrony(smoothed(one, 25), smoothed(late, 25), np.arange(20))
    assert real.mean() > 0.6
    assert abs(shuffled.mean()) < 0.15
    unrelated, _ = synchrony(one, np.roll(late, 1, 0), np.arange(20))
    assert abs(unrelated.mean()) < 0.3


def test_who_never_changes_speed_is_in_time_with_nobody() -> None:
    steady = np.full((2, 30), 1.2)
    real, shuffled = synchrony(steady, np.random.default_rng(0).random((2, 30)), [0, 1])
    assert real.tolist() == [0, 0]
    assert shuffled.tolist() == [0, 0]
    assert np.isnan(synchrony(steady, steady, ["one", "one"])[1]).all()
