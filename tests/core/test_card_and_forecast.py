"""Cards come back from JSON; forecasts refuse what cannot be an answer and go on without a step."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest

from motioncast.core.card import ModelCard
from motioncast.core.forecast import Forecast
from motioncast.core.kinematics import fit_rotations
from motioncast.core.skeletons import MRT15
from motioncast.errors import InputError, SceneError
from motioncast.testing import walkers

CARD = ModelCard("steps", "A guess", "forecast", "mrt15", 15, 10, 15.0, figures={"mpjpe_mm": {"1.0": 42.0}})


def answer(**changes) -> Forecast:
    """Three samples for two walkers: they stand still, 0, 1 and 2 m to the side."""
    history = walkers(people=2, frames=20)
    shift = np.arange(3)[:, None, None, None, None] * np.array([1.0, 0, 0])
    samples = np.broadcast_to(history.positions[-1], (3, 10, 2, 15, 3)) + shift
    return Forecast(**{"samples": samples, "history": history, "people": history.people, "card": CARD, **changes})


def test_cards_come_back_from_json():
    assert ModelCard.from_json(CARD.to_json()) == CARD
    assert CARD.joints is MRT15


@pytest.mark.parametrize(
    ("text", "complaint"),
    [
        ("", "not JSON"),
        ("{", "not JSON"),
        ("[]", "unknown or missing"),
        ("3", "unknown or missing"),
        ("{}", "expected at least"),
        (json.dumps({**json.loads(CARD.to_json()), "speed": 3}), "speed"),
        (json.dumps({**json.loads(CARD.to_json()), "skeleton": "dog"}), '"dog"; known'),
        (
            json.dumps({**json.loads(CARD.to_json()), "horizon": "far"}),
            "\"horizon\" of the model card is 'far'; expected int",
        ),
        (json.dumps({**json.loads(CARD.to_json()), "fps": None}), "expected float or int"),
        (json.dumps({**json.loads(CARD.to_json()), "radius": 3}), '"radius".*expected dict'),
        (json.dumps({**json.loads(CARD.to_json()), "people": True}), '"people".*expected int'),
        ("[" * 100_000, "not JSON"),
        ("1" * 10_000, "not JSON"),
    ],
)
def test_texts_that_are_no_cards_are_refused(text, complaint):
    with pytest.raises(InputError, match=complaint):
        ModelCard.from_json(text)


def test_defaults_are_filled_in():
    forecast = answer()
    np.testing.assert_allclose(forecast.weights, 1 / 3)
    assert forecast.carried.tolist() == [False] * 15
    assert forecast.guessed.tolist() == [False] * 2
    assert forecast.samples.dtype == np.float32


def test_times_begin_one_frame_after_now():
    forecast = answer()
    np.testing.assert_allclose(forecast.times_s, np.arange(1, 11) / 15)
    assert forecast.horizon_s == pytest.approx(10 / 15)
    assert forecast.times_s[-1] == pytest.approx(forecast.horizon_s)
    assert (forecast.fps, forecast.skeleton) == (15.0, MRT15)


@pytest.mark.parametrize(
    "shape", [(10, 2, 15, 3), (3, 10, 1, 15, 3), (3, 10, 2, 13, 3), (3, 10, 2, 15, 2), (0, 10, 2, 15, 3)]
)
def test_samples_of_another_shape_are_refused(shape):
    with pytest.raises(SceneError, match=r"forecast has shape .*expected \(sample, time, 2 people, 15 joints, 3\)"):
        answer(samples=np.zeros(shape))


@pytest.mark.parametrize("value", [np.nan, np.inf])
def test_answers_that_are_not_finite_are_refused(value):
    samples = np.zeros((3, 10, 2, 15, 3))
    samples[2, 9, 1, 14, 2] = value
    with pytest.raises(SceneError, match='"steps" answered with numbers that are not finite'):
        answer(samples=samples)


@pytest.mark.parametrize(
    ("field", "value", "complaint"),
    [
        ("people", ("person 1", "eve"), 'is of "eve"; the history has person 1, person 2'),
        ("weights", np.ones(2), "weights"),
        ("carried", np.zeros(13, bool), "carried"),
        ("guessed", np.zeros(15, bool), "guessed"),
        ("radius_m", {"0.5": np.zeros((10, 15)), "0.9": np.zeros((15, 10))}, "radii"),
    ],
)
def test_what_belongs_to_another_forecast_is_refused(field, value, complaint):
    with pytest.raises(SceneError, match=complaint):
        answer(**{field: value})


def test_the_best_sample_is_the_most_probable_one():
    forecast = answer(weights=np.array([0.2, 0.7, 0.1]))
    np.testing.assert_array_equal(forecast.best, forecast.samples[1])
    np.testing.assert_array_equal(forecast.scene().positions, forecast.samples[1])
    np.testing.assert_array_equal(forecast.scene(2).positions, forecast.samples[2])
    assert forecast.scene().people == forecast.people


def test_the_continued_scene_is_history_and_forecast():
    forecast = answer()
    whole = forecast.continued(0)
    assert whole.frames == 30
    np.testing.assert_array_equal(whole.positions[:20], forecast.history.positions)
    np.testing.assert_array_equal(whole.positions[20:], forecast.samples[0])
    assert whole.rotations is None


def test_the_continued_scene_holds_those_who_are_forecast():
    history = walkers(people=3, frames=20)
    forecast = answer(history=history, people=("person 3", "person 1"))
    whole = forecast.continued()
    assert whole.people == ("person 3", "person 1")
    np.testing.assert_array_equal(whole.positions[:20], history.positions[:, [2, 0]])


def test_rotations_go_on_where_the_history_has_them():
    history = fit_rotations(walkers(people=1, frames=20))
    last = history.positions[-1]
    forecast = Forecast(np.broadcast_to(last, (1, 5, *last.shape)), history, history.people, CARD)
    whole = forecast.continued()
    assert whole.rotations is not None
    assert whole.offsets is not None
    assert whole.rotations.shape[0] == 25
    alike = np.abs((whole.rotations[19] * whole.rotations[20]).sum(-1))
    np.testing.assert_allclose(alike, 1, atol=2e-3)  # nobody jumps between history and forecast


def test_forecasts_cannot_be_changed():
    with pytest.raises(AttributeError):
        answer().seed = 3  # pyright: ignore[reportAttributeAccessIssue]
    assert replace(answer(), seed=3).seed == 3
