"""Every registered model holds the contract."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import pytest

from motioncast.core.card import ModelCard
from motioncast.core.forecast import Forecast
from motioncast.inference.baselines import SimpleGuess
from motioncast.inference.registry import list_models, load
from motioncast.inference.session import GraphForecaster
from motioncast.inference.shipped import ShippedForecaster
from motioncast.testing import Check, checks, walkers

CHECKS = [check for card in list_models() for check in checks(load(card.name))]


@pytest.mark.parametrize("check", CHECKS, ids=str)
def test_contract(check: Check) -> None:
    check()


GRAPHS = [model for card in list_models() if isinstance(model := load(card.name), GraphForecaster)]


@pytest.mark.parametrize("model", GRAPHS, ids=lambda model: model.card.name)
def test_scenes_of_a_batch_do_not_mix(model: GraphForecaster) -> None:
    card = model.card
    scenes = [walkers(frames=card.history, fps=card.fps, seed=seed).on(card.joints) for seed in range(3)]
    history, observed = np.stack([scene.positions for scene in scenes]), np.stack([scene.observed for scene in scenes])
    observed[1, :, 2] = False
    whole = model.run(history, observed)
    for index in range(3):
        alone = model.run(history[[index]], observed[[index]])[0]
        seen = observed[index, -1].any(-1)
        np.testing.assert_allclose(alone[:, seen], whole[index][:, seen], atol=card.tolerance_m)


TRAINED = [model for card in list_models() if isinstance(model := load(card.name), ShippedForecaster)]


@pytest.mark.parametrize("model", TRAINED, ids=lambda model: model.card.name)
def test_one_thread_and_two_give_the_same_future(model: ShippedForecaster) -> None:
    one, two = (model.with_threads(threads).forecast(walkers(frames=60, fps=30), horizon_s=1.0) for threads in (1, 2))
    np.testing.assert_allclose(one.samples, two.samples, rtol=0, atol=1e-5)


CARD = replace(SimpleGuess("zero-velocity").card, name="drifting")


@dataclass(frozen=True)
class Drifting:
    """A model with a fault: it leans towards +x wherever people face."""

    card: ModelCard = CARD

    def forecast(self, scene, **asked) -> Forecast:
        answer = SimpleGuess("zero-velocity").forecast(scene, **asked)
        return replace(answer, samples=answer.samples + np.array([0.01, 0.0, 0.0]))


def test_a_faulty_model_is_caught() -> None:
    broken = []
    for check in checks(Drifting()):
        try:
            check()
        except AssertionError:
            broken.append(check.name)
    assert broken == ["turning"]


def test_a_declared_exception_must_show() -> None:
    excused = Drifting(replace(CARD, exceptions={"turning": "it leans", "moving": "stale"}))
    results = {check.name: check for check in checks(excused)}
    results["turning"]()
    with pytest.raises(AssertionError, match="holds after all"):
        results["moving"]()


def test_an_unknown_exception_is_refused() -> None:
    with pytest.raises(AssertionError, match="no clauses"):
        checks(Drifting(replace(CARD, exceptions={"flying": "no"})))
