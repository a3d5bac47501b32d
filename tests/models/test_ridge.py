from __future__ import annotations

import numpy as np
import pytest

torch = pytest.importorskip("torch")

from motioncast.models import ridge  # noqa: E402
from motioncast.models.ridge import Ridge, RidgeConfig  # noqa: E402

pytestmark = pytest.mark.torch


def windows(count: int) -> tuple[torch.Tensor, torch.Tensor]:
    """People who drift at constant velocities, with some noise."""
    generator = torch.Generator().manual_seed(0)
    start, speed = (torch.randn(count, 1, 1, 15, 3, generator=generator) for _ in range(2))
    motion = start + 0.1 * speed * torch.arange(7.0).view(1, 7, 1, 1, 1)
    motion = motion + 0.01 * torch.randn(motion.shape, generator=generator)
    return motion[:, :3], motion[:, 3:]


def seen(history: torch.Tensor) -> torch.Tensor:
    return torch.ones(history.shape[:-1], dtype=torch.bool)


def test_not_fitted_it_repeats_the_last_pose() -> None:
    history, future = windows(3)
    answer = Ridge(RidgeConfig(history=3, horizon=4))(history, seen(history))
    torch.testing.assert_close(answer, history[:, -1:].expand_as(future), atol=1e-5, rtol=0)


def test_weights_are_those_of_the_normal_equations(monkeypatch: pytest.MonkeyPatch) -> None:
    """Against least squares on rows that are extended by the penalty."""
    monkeypatch.setattr(ridge, "WINDOWS_AT_ONCE", 70)
    model = Ridge(RidgeConfig(history=3, horizon=4, penalty=0.01))
    history, future = windows(200)
    model.fit(history, future)
    given, change = (array.double().numpy() for array in model.pairs(history, future))
    centred, target = given - given.mean(0), change - change.mean(0)
    size = np.sqrt(0.01 * centred.var(0).mean() * len(given))
    rows = np.concatenate([centred, size * np.eye(centred.shape[1])])
    goal = np.concatenate([target, np.zeros((centred.shape[1], target.shape[1]))])
    weight = np.linalg.lstsq(rows, goal, rcond=None)[0]
    np.testing.assert_allclose(model.linear.weight.detach().numpy(), weight.T, atol=1e-5)
    np.testing.assert_allclose(model.linear.bias.detach().numpy(), change.mean(0) - given.mean(0) @ weight, atol=1e-5)


def test_fitted_it_goes_on() -> None:
    model = Ridge(RidgeConfig(history=3, horizon=4))
    model.fit(*windows(1000))
    history, future = windows(50)
    with torch.no_grad():
        error = (model(history, seen(history)) - future).norm(dim=-1).mean()
    still = (history[:, -1:] - future).norm(dim=-1).mean()
    assert error < 0.5 * still


def test_a_great_penalty_leaves_the_mean_change() -> None:
    model = Ridge(RidgeConfig(history=3, horizon=4, penalty=1e9))
    history, future = windows(60)
    model.fit(history, future)
    _, change = model.pairs(history, future)
    assert model.linear.weight.abs().max() < 1e-6
    torch.testing.assert_close(model.linear.bias.detach(), change.mean(0), atol=1e-4, rtol=0)
