from __future__ import annotations

import numpy as np
import pytest

torch = pytest.importorskip("torch")

from motioncast.models.ltd import LTD, LTDConfig  # noqa: E402
from motioncast.nn.dct import dct_matrix  # noqa: E402

pytestmark = pytest.mark.torch

SMALL = {"history": 6, "horizon": 8, "coefficients": 14, "width": 16, "blocks": 2}
SEEN = torch.ones(2, 6, 3, 15, dtype=torch.bool)


@pytest.fixture
def history() -> torch.Tensor:
    return torch.randn(2, 6, 3, 15, 3, generator=torch.Generator().manual_seed(1))


@pytest.mark.parametrize(
    ("sizes", "count"),
    [({}, 2_238_694), ({"skeleton": "smpl22", "history": 10, "horizon": 10, "coefficients": 15}, 2_545_015)],
)
def test_it_has_its_number_of_parameters(sizes: dict, count: int) -> None:
    assert sum(parameter.numel() for parameter in LTD(LTDConfig(**sizes)).parameters()) == count


@pytest.mark.parametrize("coefficients", [14, 5])
def test_a_network_that_changes_nothing_gives_the_padded_trajectory(coefficients: int, history: torch.Tensor) -> None:
    model = LTD(LTDConfig(**{**SMALL, "coefficients": coefficients})).eval()
    for parameter in model.network.fall.parameters():
        torch.nn.init.zeros_(parameter)
    joint = history[0, :, 1, 4].numpy()
    dct = dct_matrix(14).numpy()[:coefficients]
    kept = dct.T @ dct @ np.concatenate([joint, np.repeat(joint[-1:], 8, 0)])
    torch.testing.assert_close(model(history, SEEN)[0, :, 1, 4], torch.from_numpy(kept[6:]), atol=1e-5, rtol=0)


def test_loss_counts_history_and_future() -> None:
    missed, future = torch.zeros(1, 6, 1, 15, 3), torch.zeros(1, 8, 1, 15, 3)
    missed[..., 0], future[..., 1] = 0.7, 1.4
    truth, seen = torch.zeros_like(future), torch.ones(1, 8, 1, 15, dtype=torch.bool)
    loss = LTD(LTDConfig(**SMALL)).loss([missed, future], truth, seen)
    assert loss.item() == pytest.approx((6 * 0.7 + 8 * 1.4) / 14, rel=1e-5)


def test_in_training_the_history_is_answered_too(history: torch.Tensor) -> None:
    model = LTD(LTDConfig(**SMALL))
    for parameter in model.network.fall.parameters():
        torch.nn.init.zeros_(parameter)
    missed, future = model(history, SEEN)
    assert (missed.shape, future.shape) == ((2, 6, 3, 15, 3), (2, 8, 3, 15, 3))
    assert missed.abs().max() < 1e-5  # nothing was changed, and all coefficients were kept
