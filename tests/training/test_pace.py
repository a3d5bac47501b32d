"""The learning rate over a training."""

from __future__ import annotations

import pytest

pytest.importorskip("torch")

from motioncast.training.loop import pace
from motioncast.training.recipe import Recipe, read_recipe

pytestmark = pytest.mark.torch


def test_the_papers_linear_schedule_is_a_warm_up_that_was_counted_in_epochs() -> None:
    """Steps 2e-7 to 5e-5 are printed; the code rises to 1e-4 over 500 units, and takes an epoch for a unit."""
    published = Recipe("", "sast", steps=100_000, learning_rate=1e-4, warmup=500)
    rates = [published.learning_rate * pace(epoch, published) for epoch in (0, 1, 250)]
    assert rates == pytest.approx([0, 2e-7, 5e-5])


def test_ours_rises_over_steps_and_falls_to_a_hundredth() -> None:
    recipe = read_recipe("sast")
    assert recipe.warmup < recipe.steps / 10
    paces = [pace(step, recipe) for step in range(1, recipe.steps + 1)]
    assert paces[0] == pytest.approx(1 / recipe.warmup)
    assert paces[recipe.warmup - 1] == max(paces) == pytest.approx(1)
    assert paces[recipe.warmup :] == sorted(paces[recipe.warmup :], reverse=True)
    assert paces[-1] == pytest.approx(0.01)
