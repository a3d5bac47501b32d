from __future__ import annotations

import numpy as np
import pytest

from motioncast.metrics.position import mpjpe_at, mpjpe_until, vim_at


@pytest.fixture
def pair() -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    random = np.random.default_rng(3)
    shape = (5, 7, 3, 4)
    return random.normal(size=(*shape, 3)), random.normal(size=(*shape, 3)), random.random(shape) < 0.8


def test_naive_twin_of_mpjpe(pair: tuple[np.ndarray, np.ndarray, np.ndarray]) -> None:
    forecast, truth, observed = pair
    for frame in range(7):
        errors = [
            np.sqrt(((forecast[w, frame, p, j] - truth[w, frame, p, j]) ** 2).sum())
            for w in range(5) for p in range(3) for j in range(4) if observed[w, frame, p, j]
        ]  # fmt: skip
        assert mpjpe_at(forecast, truth, observed)[frame] == pytest.approx(np.mean(errors))


def test_naive_twin_of_vim(pair: tuple[np.ndarray, np.ndarray, np.ndarray]) -> None:
    forecast, truth, _ = pair
    flat = [np.linalg.norm((forecast[w, 2, p] - truth[w, 2, p]).reshape(-1)) for w in range(5) for p in range(3)]
    assert vim_at(forecast, truth)[2] == pytest.approx(np.mean(flat))


def test_vim_of_equal_errors_is_the_root_of_the_number_of_joints() -> None:
    truth = np.zeros((1, 1, 2, 13, 3))
    assert vim_at(truth + np.array([0.1, 0, 0]), truth)[0] == pytest.approx(0.1 * np.sqrt(13))


def test_people_may_come_in_any_order(pair: tuple[np.ndarray, np.ndarray, np.ndarray]) -> None:
    forecast, truth, observed = pair
    order = [2, 0, 1]
    np.testing.assert_allclose(
        mpjpe_at(forecast, truth, observed), mpjpe_at(forecast[:, :, order], truth[:, :, order], observed[:, :, order])
    )
    np.testing.assert_allclose(vim_at(forecast, truth), vim_at(forecast[:, :, order], truth[:, :, order]))


def test_a_perfect_forecast_scores_zero(pair: tuple[np.ndarray, np.ndarray, np.ndarray]) -> None:
    _, truth, observed = pair
    assert mpjpe_until(truth, truth, observed).max() == 0
    assert vim_at(truth, truth).max() == 0
