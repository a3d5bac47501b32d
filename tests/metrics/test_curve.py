from __future__ import annotations

import numpy as np

from motioncast.core.forecast import Forecast
from motioncast.core.scene import Scene
from motioncast.inference.baselines import SimpleGuess
from motioncast.metrics.curve import error_at, error_curve


def off_by(walkers: Scene, metres: float, **others: object) -> Forecast:
    """A forecast that is wrong by a constant in every joint."""
    samples = walkers.positions[None, 30:] + np.array([metres, 0, 0], np.float32)
    return Forecast(samples, walkers[:30], walkers.people, SimpleGuess("zero-velocity").card, **others)  # pyright: ignore[reportArgumentType]


def test_a_constant_error(walkers: Scene) -> None:
    curve = error_curve(off_by(walkers, 0.25), walkers[30:])
    np.testing.assert_allclose(curve, np.full(30, 0.25), atol=1e-6)


def test_the_truth_may_be_shorter_and_know_more_people_in_another_order(walkers: Scene) -> None:
    truth = walkers[30:40].select(("bea", "ada"))
    np.testing.assert_allclose(error_curve(off_by(walkers, 0.1), truth), np.full(10, 0.1), atol=1e-6)


def test_joints_that_the_model_does_not_know_are_left_out(walkers: Scene) -> None:
    carried = np.zeros(15, bool)
    carried[3] = True
    forecast = off_by(walkers, 0.0, carried=carried)
    forecast.samples[:, :, :, 3] += 1
    np.testing.assert_allclose(error_curve(forecast, walkers[30:]), np.zeros(30), atol=1e-6)


def test_a_frame_in_which_nobody_was_seen_has_no_error(walkers: Scene) -> None:
    observed = walkers.observed.copy()
    observed[35] = False
    observed[36, 0] = False
    truth = Scene(walkers.positions, walkers.skeleton, 30, observed, walkers.people)[30:]
    curve = error_curve(off_by(walkers, 0.1), truth)
    assert np.isnan(curve[5])
    assert error_at(curve, 6 / 30, 30) is None
    np.testing.assert_allclose(np.delete(curve, 5), 0.1, atol=1e-6)
