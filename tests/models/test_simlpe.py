from __future__ import annotations

import numpy as np
import pytest

torch = pytest.importorskip("torch")

from motioncast.models.simlpe import SiMLPe, SiMLPeConfig, TimeMixing  # noqa: E402
from motioncast.nn.dct import dct_matrix  # noqa: E402
from motioncast.nn.folding import fold, unfold  # noqa: E402
from motioncast.nn.frames import stand, to_own, to_world  # noqa: E402

pytestmark = pytest.mark.torch

SMALL = {"history": 6, "horizon": 8, "blocks": 2, "step": 3}
SEEN = torch.ones(2, 6, 3, 15, dtype=torch.bool)


@pytest.fixture
def history() -> torch.Tensor:
    return torch.randn(2, 6, 3, 15, 3, generator=torch.Generator().manual_seed(1))


def test_it_has_its_number_of_parameters() -> None:
    model = SiMLPe(SiMLPeConfig(skeleton="smpl22", history=50, horizon=25, fps=25.0, step=10))
    assert sum(parameter.numel() for parameter in model.parameters()) == 137_580


def test_untrained_it_repeats_the_last_pose(history: torch.Tensor) -> None:
    answer = SiMLPe(SiMLPeConfig(**SMALL)).eval()(history, SEEN)
    torch.testing.assert_close(answer, history[:, -1:].expand_as(answer), atol=1e-4, rtol=0)


def test_a_block_mixes_time_and_normalises_over_coordinates() -> None:
    torch.manual_seed(0)
    block = TimeMixing(6, 45)
    for parameter in block.parameters():
        torch.nn.init.normal_(parameter)
    features = torch.randn(2, 6, 45)
    weight, bias, scale, shift = (value.detach().numpy() for value in block.parameters())
    mixed = np.einsum("st,ntc->nsc", weight, features.numpy()) + bias[:, None]
    normal = (mixed - mixed.mean(2, keepdims=True)) / np.sqrt(mixed.var(2, keepdims=True) + 1e-5)
    expected = features.numpy() + normal * scale + shift
    np.testing.assert_allclose(block(features).detach().numpy(), expected, atol=1e-4)


def test_steps_follow_one_another_in_the_frame_of_each(history: torch.Tensor) -> None:
    torch.manual_seed(0)
    model = SiMLPe(SiMLPeConfig(**SMALL)).eval()
    for parameter in model.parameters():
        torch.nn.init.normal_(parameter, std=0.1)
    answer, frames, dct = model(history, SEEN), history, dct_matrix(6)
    for _ in range(3):
        origin, heading = stand(frames[:, -1], model.skeleton)
        own = to_own(frames[:, -6:], origin, heading)
        change = dct.T @ model.leave(model.blocks(model.enter(dct @ fold(own).transpose(1, 2))))
        moved = own[:, -1:] + unfold(change.transpose(1, 2), 3)[:, :3]
        frames = torch.cat([frames, to_world(moved, origin, heading)], 1)
    torch.testing.assert_close(answer, frames[:, 6:14])


def test_loss_adds_the_error_of_the_steps() -> None:
    truth = torch.zeros(1, 4, 1, 15, 3)
    answer, seen = truth.clone(), torch.ones(1, 4, 1, 15, dtype=torch.bool)
    answer[:, 2:, ..., 0] = 1.0  # two of four frames are 1 m off; one of three steps is
    loss = SiMLPe(SiMLPeConfig(**SMALL)).loss
    assert loss(answer, truth, seen).item() == pytest.approx(2 / 4 + 1 / 3, abs=1e-3)
    seen[:, 2] = False  # neither the frame nor the steps from and to it count
    assert loss(answer, truth, seen).item() == pytest.approx(1 / 3 + 0, abs=1e-3)


def test_training_answers_as_many_steps_as_it_is_told(history: torch.Tensor) -> None:
    for trained, frames in ((1, 3), (2, 6), (9, 8)):
        model = SiMLPe(SiMLPeConfig(**SMALL, trained_steps=trained))
        assert model(history, SEEN).shape[1] == frames
