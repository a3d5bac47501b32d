"""The kitchen benchmark: rules and figures against naive twins."""

from __future__ import annotations

from collections import Counter

import numpy as np
import pytest

from motioncast.benchmarks.kitchen.guesses import Answer, average, markov, repeat_last, zero_velocity
from motioncast.benchmarks.kitchen.run import KitchenProtocol, forecast_steps, result_of, windows_of
from motioncast.benchmarks.kitchen.scoring import figures, rows
from motioncast.datasets import kitchen
from motioncast.datasets.action_windows import cut_steps
from motioncast.inference.registry import load

LABELS = len(kitchen.LABELS)
JUDGE = [(np.zeros((27, 1)), np.array([1.0]))]


@pytest.fixture(scope="module")
def windows():
    return cut_steps(kitchen.sequences("validation", 3), 10, 10, 4)


@pytest.fixture(scope="module")
def train():
    return cut_steps(kitchen.sequences("train", 6), 10, 10, 4)


def test_zero_velocity_and_the_average(windows, train):
    held = zero_velocity(windows, 10).pixels
    np.testing.assert_array_equal(held[:, 7], windows.pixels[:, 9])
    mean = average(windows, 10, train).pixels
    offsets = (mean - mean[..., 1:2, :]) * (windows.depth / windows.camera[:, :1])[:, None, :, None, None]
    np.testing.assert_allclose(offsets, np.broadcast_to(offsets[:1, :1], offsets.shape), atol=1e-3)


def test_repeat_last_names_the_latest_first(windows):
    scores = repeat_last(windows, 10, LABELS).scores[0, 4, 0]
    latest = list(dict.fromkeys(windows.actions[0, :10, 0][::-1].tolist()))
    assert np.argsort(-scores, kind="stable")[: len(latest)].tolist() == latest


@pytest.mark.parametrize("order", [0, 1, 2])
def test_a_chain_goes_on_with_what_followed_most_often(windows, train, order):
    followed = {size: {} for size in range(order + 1)}
    for actions in train.actions[:, :, 0].tolist():
        for size, table in followed.items():
            for step in range(size, len(actions)):
                table.setdefault(tuple(actions[step - size : step]), Counter())[actions[step]] += 1
    scores = markov(windows, 10, train, LABELS, order).scores
    for window in range(len(windows)):
        past = windows.actions[window, :10, 0].tolist()
        for step in range(10):
            size = order
            while tuple(past[len(past) - size :]) not in followed[size]:
                size -= 1
            counts = followed[size][tuple(past[len(past) - size :])]
            assert counts[int(scores[window, step, 0].argmax())] == max(counts.values())
            past.append(int(scores[window, step, 0].argmax()))


def test_the_truth_has_no_errors(windows):
    scores = np.eye(LABELS)[windows.actions[:, 10:]]
    found = figures(windows, 10, Answer(scores, windows.pixels[:, 10:], windows.truth[:, 10:]), JUDGE)
    assert found["top_1"].all()
    for metric in ("pixel_error", "pose_error", "scaled_pose_error", "asymmetry"):
        assert found[metric].max() < 1e-2
    listed = {(row.metric, row.horizon_s): row for row in rows(windows, found)}
    assert listed["top_1_until", 10].value == 1
    assert listed["quality_until", 10].value == 1
    assert listed["pose_error_at", 3].unit == "mm"


def test_rows_are_means_and_their_intervals_hold_them(windows):
    values = np.random.default_rng(0).random((len(windows), 10, 1))
    listed = {(row.metric, row.horizon_s): row for row in rows(windows, {"pixel_error": values})}
    row = listed["pixel_error_at", 4]
    assert row.value == pytest.approx(values[:, 3].mean())
    assert row.low <= row.value <= row.high
    assert listed["pixel_error_until", 10].value == pytest.approx(values.mean())


def test_the_shipped_model_is_better_than_guesses():
    protocol = KitchenProtocol(split="validation")
    windows = windows_of(protocol, 12)
    model = load("futurehuman3d")
    answer = forecast_steps(model, windows, 10)
    result = result_of("futurehuman3d", model.card, protocol, windows, answer, JUDGE)
    held = result_of("held", None, protocol, windows, zero_velocity(windows, 10), JUDGE)
    last = {row.metric: row.value for row in result.rows if row.horizon_s == 10}
    still = {row.metric: row.value for row in held.rows if row.horizon_s == 10}
    assert last["top_1_until"] > 0.4
    assert last["pixel_error_until"] < still["pixel_error_until"] - 5
    assert result.protocol == held.protocol
    assert KitchenProtocol(people=2).name != KitchenProtocol(moments="middle").name != protocol.name
