"""Every registered model holds the contract."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import pytest

from motioncast.core.card import ModelCard
from motioncast.core.forecast import Forecast
from motioncast.inference.baselines import SimpleGuess
from motioncast.inference.registry import list_models, load
from motioncast.testing import Check, checks

CHECKS = [check for card in list_models() for check in checks(load(card.name))]


@pytest.mark.parametrize("check", CHECKS, ids=str)
def test_contract(check: Check) -> None:
    check()


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
