from __future__ import annotations

import numpy as np
import pytest

from motioncast.core.scene import Scene
from motioncast.inference.baselines import RULES
from motioncast.inference.registry import load


@pytest.mark.parametrize("name", RULES)
def test_a_guess_follows_a_tracker_with_the_numbers_of_the_batch_call(name: str, walkers: Scene) -> None:
    live = load(name).stream(walkers.fps, walkers.skeleton, horizon_s=1.0)
    for pose in walkers.positions:
        forecast = live.push(dict(zip(walkers.people, pose, strict=True)))
    assert forecast is not None
    whole = load(name).forecast(walkers, horizon_s=1.0)
    np.testing.assert_allclose(forecast.samples, whole.samples, atol=1e-5)
