from __future__ import annotations

import numpy as np
import pytest

from motioncast.metrics.paths import mean_speed_at, path_length_m, root_path, wasserstein_1


@pytest.fixture
def path() -> np.ndarray:
    """Paths ``(windows 3, 1 + time 10, people 2, 2)``."""
    return np.cumsum(np.random.default_rng(7).normal(size=(3, 11, 2, 2)) * 0.1, 1)


def test_a_straight_walk_of_ten_seconds_at_one_metre_a_second() -> None:
    motion = np.zeros((251, 3, 3)) + (np.arange(251) / 25)[:, None, None] * [0.6, 0.8, 0.0]
    walked = root_path(motion, root=[1, 2])
    assert path_length_m(walked) == pytest.approx(10.0)
    np.testing.assert_allclose(mean_speed_at(walked[None, :, None], fps=25), 1.0)


def test_naive_twins(path: np.ndarray) -> None:
    lengths = path_length_m(np.swapaxes(path, 1, 2))
    for w, p in np.ndindex(3, 2):
        steps = [np.hypot(*(path[w, t + 1, p] - path[w, t, p])) for t in range(10)]
        assert lengths[w, p] == pytest.approx(sum(steps))
    observed = np.random.default_rng(0).random((3, 11, 2)) < 0.8
    for t in range(10):
        speeds = [
            min(10.0, 15 * np.hypot(*(path[w, t + 1, p] - path[w, t, p])))
            for w in range(3) for p in range(2) if observed[w, t, p] and observed[w, t + 1, p]
        ]  # fmt: skip
        assert mean_speed_at(path, 15, observed)[t] == pytest.approx(np.mean(speeds))


def test_invariances(path: np.ndarray) -> None:
    speed = mean_speed_at(path, 15)
    turn = np.array([[0.6, 0.8], [-0.8, 0.6]])
    np.testing.assert_allclose(mean_speed_at(path @ turn + [7, -8], 15), speed)
    np.testing.assert_allclose(mean_speed_at(path[:, :, ::-1], 15), speed)
    np.testing.assert_allclose(mean_speed_at(np.repeat(path, 64, 0), 15), speed)
    assert path_length_m(np.ones((5, 4, 2))).max() == 0  # who stands goes nowhere


def test_a_jump_of_the_tracker_counts_as_the_fastest_run() -> None:
    path = np.zeros((1, 3, 1, 2))
    path[0, 1:] = 100
    assert mean_speed_at(path, 25).tolist() == [10.0, 0.0]


def test_wasserstein_of_a_shift_is_the_shift() -> None:
    lengths = np.random.default_rng(0).random(40)
    assert wasserstein_1(lengths, lengths) == 0
    for shift in (-0.7, 3.0):
        assert wasserstein_1(lengths, lengths + shift) == pytest.approx(abs(shift))
    assert wasserstein_1(np.repeat(lengths, 3), np.random.default_rng(1).permutation(lengths)) == pytest.approx(0)


def test_naive_twin_of_wasserstein() -> None:
    random = np.random.default_rng(2)
    one, other = random.normal(size=6), random.normal(size=4)
    # copies make the samples equally many; then the k-th smallest go together
    pairs = zip(sorted(np.repeat(one, 4)), sorted(np.repeat(other, 6)), strict=True)
    assert wasserstein_1(one, other) == pytest.approx(np.mean([abs(a - b) for a, b in pairs]))
    assert wasserstein_1(one, other) == pytest.approx(wasserstein_1(other, one))


def test_scipy_finds_the_same() -> None:
    stats = pytest.importorskip("scipy.stats")
    random = np.random.default_rng(3)
    for n, m in ((1, 1), (7, 30), (30, 7)):
        one, other = random.integers(0, 9, n) / 2, random.exponential(size=m)
        assert wasserstein_1(one, other) == pytest.approx(stats.wasserstein_distance(one, other))
