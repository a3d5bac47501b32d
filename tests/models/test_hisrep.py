from __future__ import annotations

import numpy as np
import pytest

torch = pytest.importorskip("torch")

from motioncast.models.hisrep import HisRep, HisRepConfig  # noqa: E402
from motioncast.nn.folding import fold  # noqa: E402
from motioncast.nn.frames import stand, to_own, turn  # noqa: E402

pytestmark = pytest.mark.torch

PAPER = {"skeleton": "smpl22", "history": 50, "horizon": 25, "fps": 25.0, "kernel": 10, "step": 10, "coefficients": 20}
SMALL = {"history": 9, "horizon": 6, "kernel": 3, "step": 2, "coefficients": 5, "width": 8, "blocks": 1}


@pytest.fixture(scope="module")
def model() -> HisRep:
    torch.manual_seed(0)
    return HisRep(HisRepConfig(**SMALL)).eval()


@pytest.fixture
def history() -> torch.Tensor:
    return torch.randn(2, 9, 3, 15, 3, generator=torch.Generator().manual_seed(1))


@pytest.mark.parametrize(("skeleton", "count"), [("smpl22", 3_415_952), ("mrt15", 3_022_034)])
def test_it_has_its_number_of_parameters(skeleton: str, count: int) -> None:
    model = HisRep(HisRepConfig(**{**PAPER, "skeleton": skeleton}))
    assert sum(parameter.numel() for parameter in model.parameters()) == count
    assert [model.key[0].kernel_size, model.key[2].kernel_size] == [(6,), (5,)]


def test_attention_is_that_of_the_equations(model: HisRep, history: torch.Tensor) -> None:
    """One sub-sequence after the other, one person after the other."""
    answer = model.attend(history, 9).view(2, 3, 45, 5)
    for scene, person in np.ndindex(2, 3):
        track = history[scene : scene + 1, :, person : person + 1]

        def own(frames: torch.Tensor) -> torch.Tensor:
            return fold(to_own(frames, *stand(frames[:, 2], model.skeleton)))

        query = model.query(own(track[:, 6:]))[0, :, 0]
        weights, sums = torch.zeros(()), torch.zeros(45, 5)
        for start in range(9 - 5 + 1):
            piece = own(track[:, start : start + 5])
            weight = query @ model.key(piece[..., :3])[0, :, 0]
            weights, sums = weights + weight, sums + weight * piece[0] @ model.dct.T
        torch.testing.assert_close(answer[scene, person], sums / weights, atol=1e-5, rtol=1e-4)


def test_answers_become_history(model: HisRep, history: torch.Tensor) -> None:
    whole = model(history, torch.ones(history.shape[:-1], dtype=torch.bool))
    longer = torch.cat([history, whole[:, :2]], 1)
    _, second = model.next_frames(longer[:, -3:], model.attend(longer, 11))
    torch.testing.assert_close(whole[:, 2:4], second)


def test_what_is_repeated_elsewhere_is_repeated(model: HisRep) -> None:
    """A motion done twice, the second time elsewhere and in another direction, finds itself."""
    motion = torch.randn(1, 5, 1, 15, 3)
    heading = torch.tensor([0.6, 0.8])
    twice = torch.cat([motion, turn(motion, heading) + torch.tensor([3.0, -2.0, 0.0])], 1)
    first, _, _ = model.own(twice[:, :5])
    second, _, _ = model.own(twice[:, 5:])
    torch.testing.assert_close(first, second, atol=1e-5, rtol=0)


def test_training_answers_as_many_steps_as_it_is_told(history: torch.Tensor) -> None:
    seen = torch.ones(history.shape[:-1], dtype=torch.bool)
    truth, future = torch.zeros(2, 6, 3, 15, 3), torch.ones(2, 6, 3, 15, dtype=torch.bool)
    for trained, frames in ((1, 2), (2, 4), (9, 6)):
        model = HisRep(HisRepConfig(**SMALL, trained_steps=trained))
        missed, answer = model(history, seen)
        assert (missed.shape[1], answer.shape[1]) == (min(trained, 3) * 3, frames)
        assert model.loss([missed, answer], truth, future).isfinite()


def test_a_history_without_sub_sequences_is_refused() -> None:
    with pytest.raises(ValueError, match="no sub-sequence"):
        HisRep(HisRepConfig(history=15, kernel=10, step=10))
