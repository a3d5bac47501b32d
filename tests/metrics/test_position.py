from __future__ import annotations

import numpy as np
import pytest

from motioncast.metrics.masks import seen_mean
from motioncast.metrics.moments import at_frames, frame_at, seconds_at
from motioncast.metrics.position import (
    mpjpe_at,
    mpjpe_until,
    pck_at,
    vim_at,
    vim_at_cm,
    vim_mean_of_frames,
    vim_mean_of_moments,
)

Pair = tuple[np.ndarray, np.ndarray, np.ndarray]


@pytest.fixture
def pair() -> Pair:
    random = np.random.default_rng(3)
    shape = (5, 7, 3, 4)
    return random.normal(size=(*shape, 3)), random.normal(size=(*shape, 3)), random.random(shape) < 0.8


def errors_of(pair: Pair, frames: range) -> list[float]:
    forecast, truth, observed = pair
    return [
        float(np.sqrt(((forecast[w, f, p, j] - truth[w, f, p, j]) ** 2).sum()))
        for w in range(5) for f in frames for p in range(3) for j in range(4) if observed[w, f, p, j]
    ]  # fmt: skip


def test_naive_twins_of_at_and_until(pair: Pair) -> None:
    for frame in range(7):
        assert mpjpe_at(*pair)[frame] == pytest.approx(np.mean(errors_of(pair, range(frame, frame + 1))))
        assert mpjpe_until(*pair)[frame] == pytest.approx(np.mean(errors_of(pair, range(frame + 1))))


def test_until_is_the_running_mean_of_at_where_all_is_seen(pair: Pair) -> None:
    forecast, truth, _ = pair
    running = np.cumsum(mpjpe_at(forecast, truth)) / np.arange(1, 8)
    np.testing.assert_allclose(mpjpe_until(forecast, truth), running)


def test_naive_twin_of_pck(pair: Pair) -> None:
    forecast, truth, observed = pair
    for frame in range(7):
        right = [error <= 2.0 for error in errors_of(pair, range(frame, frame + 1))]
        assert pck_at(forecast, truth, 2.0, observed)[frame] == pytest.approx(np.mean(right))


def test_naive_twin_of_vim(pair: Pair) -> None:
    forecast, truth, _ = pair
    flat = [np.linalg.norm((forecast[w, 2, p] - truth[w, 2, p]).reshape(-1)) for w in range(5) for p in range(3)]
    assert vim_at(forecast, truth)[2] == pytest.approx(np.mean(flat))
    assert vim_at_cm(forecast, truth)[2] == pytest.approx(100 * np.mean(flat))


def test_vim_counts_people_who_are_seen_whole(pair: Pair) -> None:
    forecast, truth, observed = pair
    flat = [
        np.linalg.norm((forecast[w, 2, p] - truth[w, 2, p]).reshape(-1))
        for w in range(5) for p in range(3) if observed[w, 2, p].all()
    ]  # fmt: skip
    assert vim_at(*pair)[2] == pytest.approx(np.mean(flat))


def test_vim_of_equal_errors_is_the_root_of_the_number_of_joints() -> None:
    truth = np.zeros((1, 1, 2, 13, 3))
    assert vim_at(truth + np.array([0.1, 0, 0]), truth)[0] == pytest.approx(0.1 * np.sqrt(13))


def test_the_means_of_fourteen_frames_and_of_five_moments_have_two_names() -> None:
    vim = np.arange(1.0, 15.0)
    assert vim_mean_of_frames(vim) == 7.5
    assert vim_mean_of_moments(vim, [2, 4, 8, 10, 14]) == pytest.approx(7.6)


def test_people_may_come_in_any_order(pair: Pair) -> None:
    forecast, truth, observed = pair
    order = [2, 0, 1]
    turned = forecast[:, :, order], truth[:, :, order], observed[:, :, order]
    for metric in (mpjpe_at, mpjpe_until, vim_at):
        np.testing.assert_allclose(metric(*pair), metric(*turned))
    np.testing.assert_allclose(pck_at(forecast, truth, 2, observed), pck_at(*turned[:2], 2, turned[2]))


def test_a_window_alone_and_sixty_four_of_it_score_the_same(pair: Pair) -> None:
    one = tuple(array[:1] for array in pair)
    many = tuple(np.repeat(array, 64, 0) for array in one)
    for metric in (mpjpe_at, mpjpe_until, vim_at):
        np.testing.assert_allclose(metric(*one), metric(*many))


def test_moving_the_world_changes_nothing(pair: Pair) -> None:
    forecast, truth, observed = pair
    away = np.array([3.0, -4.0, 5.0])
    for metric in (mpjpe_at, mpjpe_until, vim_at):
        np.testing.assert_allclose(metric(forecast + away, truth + away, observed), metric(*pair))


def test_a_perfect_forecast_scores_zero(pair: Pair) -> None:
    _, truth, observed = pair
    assert mpjpe_until(truth, truth, observed).max() == 0
    assert np.nanmax(vim_at(truth, truth, observed)) == 0
    assert pck_at(truth, truth, 0.0, observed).min() == 1


def test_a_frame_without_anybody_has_no_error_and_spoils_no_other(pair: Pair) -> None:
    forecast, truth, observed = pair
    observed[:, 0] = False
    truth[:, 0] = np.nan  # what stands where nothing was seen does not matter
    assert np.isnan(mpjpe_at(forecast, truth, observed)).tolist() == [True] + 6 * [False]
    assert np.isnan(mpjpe_until(forecast, truth, observed)).tolist() == [True] + 6 * [False]
    assert np.isnan(seen_mean(np.ones((2, 0)), None, 1)).all()


def test_frames_are_counted_from_one() -> None:
    assert frame_at(seconds_at(14, 15), 15) == 14
    assert at_frames(np.arange(5), [1, 5]).tolist() == [0, 4]
    with pytest.raises(IndexError, match="counted from 1"):
        at_frames(np.arange(5), [0])
    with pytest.raises(IndexError):
        at_frames(np.arange(5), [6])
