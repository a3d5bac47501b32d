from __future__ import annotations

import math
from dataclasses import replace

import pytest

torch = pytest.importorskip("torch")

from motioncast.models.somoformer_fast import SoMoFormerFast, SoMoFormerFastConfig  # noqa: E402
from motioncast.nn.frames import TURNING_BACK, stand, turn  # noqa: E402
from motioncast.nn.losses import with_true_lengths  # noqa: E402

pytestmark = pytest.mark.torch

SMALL = {"width": 32, "layers": 2, "heads": 4, "feed_forward": 64}


@pytest.fixture(scope="module")
def model() -> SoMoFormerFast:
    torch.manual_seed(0)
    model = SoMoFormerFast(SoMoFormerFastConfig(**SMALL)).eval()
    torch.nn.init.normal_(model.head.weight, std=0.1)
    return model


@pytest.fixture
def history() -> torch.Tensor:
    return torch.randn(2, 15, 3, 15, 3, generator=torch.Generator().manual_seed(1))


SEEN = torch.ones(2, 15, 3, 15, dtype=torch.bool)


def test_untrained_it_repeats_the_last_pose(history: torch.Tensor) -> None:
    answer = SoMoFormerFast(SoMoFormerFastConfig(**SMALL))(history, SEEN)
    torch.testing.assert_close(answer, history[:, -1:].expand_as(answer), atol=1e-5, rtol=0)


def test_moved_and_turned_scenes_have_moved_and_turned_answers(model: SoMoFormerFast, history: torch.Tensor) -> None:
    angle = torch.tensor(2.3)
    heading, shift = torch.stack([angle.cos(), angle.sin()]), torch.tensor([4.0, -7.0, 0.3])
    moved = model(turn(history, heading) + shift, SEEN)
    torch.testing.assert_close(moved, turn(model(history, SEEN), heading) + shift, atol=1e-4, rtol=0)


def test_a_mirrored_scene_has_the_mirrored_answer(model: SoMoFormerFast, history: torch.Tensor) -> None:
    symmetric = SoMoFormerFast(replace(model.config, mirrored=True)).eval()
    symmetric.load_state_dict(model.state_dict())
    seen = SEEN.clone()
    seen[:, :4, 1, 3] = False

    def mirror(motion: torch.Tensor) -> torch.Tensor:
        return motion[..., model.order, :] * torch.tensor([-1.0, 1.0, 1.0])

    answer = symmetric(history, seen)
    image = symmetric(mirror(history), seen[..., model.order])
    torch.testing.assert_close(image, mirror(answer), atol=1e-5, rtol=0)
    expected = (model(history, seen) + mirror(model(mirror(history), seen[..., model.order]))) / 2
    torch.testing.assert_close(answer, expected, atol=1e-5, rtol=0)


def test_order_and_absent_people_change_nothing(model: SoMoFormerFast, history: torch.Tensor) -> None:
    answer, order = model(history, SEEN), [2, 0, 1]
    torch.testing.assert_close(model(history[:, :, order], SEEN), answer[:, :, order], atol=1e-5, rtol=0)
    more = torch.cat([history, torch.randn(2, 15, 1, 15, 3)], 2)
    seen = torch.cat([SEEN, torch.zeros(2, 15, 1, 15, dtype=torch.bool)], 2)
    torch.testing.assert_close(model(more, seen)[:, :, :3], answer, atol=1e-5, rtol=0)


def test_people_are_seen(model: SoMoFormerFast, history: torch.Tensor) -> None:
    other = history.clone()
    other[:, :, 1] += 0.5
    change = (model(other, SEEN) - model(history, SEEN))[:, :, 0].abs().max()
    assert change > 1e-4


def test_attention_can_be_asked_for(model: SoMoFormerFast, history: torch.Tensor) -> None:
    weights: list[torch.Tensor] = []
    asked = model(history, SEEN, weights)
    assert [tuple(layer.shape) for layer in weights] == [(6, 4, 18, 18), (6, 4, 15, 18)]
    person = torch.arange(3).repeat(2)
    itself = weights[0][torch.arange(6), :, :, 15 + person]
    assert itself.max() == 0  # nobody sees itself as another
    torch.testing.assert_close(asked, model(history, SEEN), atol=1e-5, rtol=0)


def test_tokens_of_others_are_those_of_the_motion_as_seen(model: SoMoFormerFast, history: torch.Tensor) -> None:
    origin, heading = stand(history[:, -1], model.skeleton)
    seen = turn(history[:, :, None] - origin[:, None, :, None, None], heading[:, None, :, None, None], back=True)
    steps = (seen[:, 1:] - seen[:, :-1]) * model.pace
    features = torch.cat([torch.tanh(seen / 3), steps, torch.tanh(seen[:, -1:])], 1)  # B, T, i, k, J, 3
    whole = model.see(features.permute(0, 2, 3, 1, 4, 5).flatten(3)) + model.other
    share = torch.cat([heading, torch.ones_like(heading[..., :1])], -1).flatten(0, 1)
    back = (share @ TURNING_BACK.flatten(1)).view(-1, 3, 3)
    split = model.others_as_seen(history.permute(0, 2, 4, 3, 1), origin.flatten(0, 1), share, back)
    torch.testing.assert_close(split, whole.flatten(0, 1), atol=1e-5, rtol=0)


def test_turn_is_a_rotation_about_the_vertical() -> None:
    quarter = torch.tensor([0.0, 1.0])
    torch.testing.assert_close(turn(torch.tensor([1.0, 0.0, 5.0]), quarter), torch.tensor([0.0, 1.0, 5.0]))
    torch.testing.assert_close(turn(turn(torch.eye(3), quarter), quarter, back=True), torch.eye(3))


def test_true_lengths() -> None:
    truth = torch.tensor([[0.0, 0, 0], [0, 0, 2.0]])
    answer = torch.tensor([[1.0, 0, 0], [2.0, 0, 0]])
    kept = with_true_lengths(answer, truth, [(1, 0)])
    torch.testing.assert_close(kept, torch.tensor([[1.0, 0, 0], [3.0, 0, 0]]), atol=1e-4, rtol=0)
    assert math.isclose((kept[1] - kept[0]).norm().item(), 2.0, rel_tol=1e-4)


def test_a_tempered_model_believes_less_of_its_path_and_keeps_its_step(history: torch.Tensor) -> None:
    torch.manual_seed(0)
    tempered = SoMoFormerFast(SoMoFormerFastConfig(path_share=0.5, seam_share=1.0, **SMALL)).eval()
    change, step = torch.randn(6, 3, 15, 45), torch.randn(6, 3, 15, 1)
    answer = tempered.tempered(change, step)
    torch.testing.assert_close(answer[..., :1], step)
    answer, change = answer[..., -1], change[..., -1]
    torch.testing.assert_close(answer[..., 0], 0.5 * change[..., 0], atol=1e-4, rtol=0)
    torch.testing.assert_close(  # the pose within the body is left alone
        answer - answer[..., :1], change - change[..., :1], atol=1e-4, rtol=0
    )
