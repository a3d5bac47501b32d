from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

torch = pytest.importorskip("torch")

from motioncast.models.mrt import MRT, Attention, AttentionOfFew, MRTConfig, middle_of_people, nearness  # noqa: E402

pytestmark = pytest.mark.torch

SMALL = {"width": 16, "layers": 1, "heads": 2, "head_width": 8, "feed_forward": 32}


def scene(people: int = 3, batch: int = 2) -> tuple[torch.Tensor, torch.Tensor]:
    generator = torch.Generator().manual_seed(people)
    steps = torch.randn(batch, 15, people, 15, 3, generator=generator)
    return steps.cumsum(1) * 0.03, torch.ones(batch, 15, people, 15, dtype=torch.bool)


@pytest.fixture(scope="module", params=["paper", "release"])
def model(request: pytest.FixtureRequest) -> MRT:
    torch.manual_seed(0)
    return MRT(MRTConfig(preset=request.param, **SMALL)).eval()


def test_the_release_has_its_number_of_parameters() -> None:
    count, paper = (
        sum(parameter.numel() for parameter in MRT(MRTConfig(preset=preset)).parameters())
        for preset in ("release", "paper")
    )
    assert count == 6_615_725
    assert count - paper == 813_568  # never used


def test_three_chunks_each_begin_where_the_last_ended() -> None:
    torch.manual_seed(0)
    history, observed = scene()
    model = MRT(MRTConfig(**SMALL)).eval()
    one = MRT(MRTConfig(horizon=15, **SMALL)).eval()
    one.load_state_dict(model.state_dict())
    answer = model(history, observed)
    assert answer.shape == (2, 45, 3, 15, 3)
    torch.testing.assert_close(one(history, observed), answer[:, :15])
    longer = torch.cat([history, answer[:, :15]], 1) - middle_of_people(history[:, -1], observed[:, -1, :, 0])[:, None]
    steps = model.next_steps(longer.flatten(3), observed[:, -1].any(-1)).unflatten(-1, (15, 3))
    torch.testing.assert_close(answer[:, 15:30], answer[:, 14:15] + steps.cumsum(1), atol=1e-5, rtol=0)


def test_attention_of_few_is_attention() -> None:
    config = MRTConfig(**SMALL)
    one, other = Attention(config).eval(), AttentionOfFew(config).eval()
    other.load_state_dict(one.state_dict())
    queries, keys = torch.randn(3, 2, 16), torch.randn(3, 9, 16)
    bias = torch.where(torch.arange(9) < 7, 0.0, -1e9).expand(3, 1, 1, 9)
    torch.testing.assert_close(one(queries, keys, bias), other(queries, keys, bias), atol=1e-5, rtol=0)


def test_moved_scenes_have_moved_answers(model: MRT) -> None:
    history, observed = scene()
    shift = torch.tensor([12.0, -7.0, 1.0])
    torch.testing.assert_close(model(history + shift, observed), model(history, observed) + shift, atol=1e-4, rtol=0)


def test_order_and_absent_people_change_nothing(model: MRT) -> None:
    history, observed = scene()
    answer, order = model(history, observed), [2, 0, 1]
    torch.testing.assert_close(model(history[:, :, order], observed), answer[:, :, order], atol=1e-5, rtol=0)
    more = torch.cat([history, torch.randn(2, 15, 2, 15, 3)], 2)
    seen = torch.cat([observed, torch.zeros(2, 15, 2, 15, dtype=torch.bool)], 2)
    seen[:, :-1, 3] = True  # was there, and has left
    torch.testing.assert_close(model(more, seen)[:, :, :3], answer, atol=1e-5, rtol=0)


def test_people_are_seen(model: MRT) -> None:
    history, observed = scene()
    other = history.clone()
    other[:, :-1, 1] += 0.5
    assert (model(other, observed) - model(history, observed))[:, :, 0].abs().max() > 1e-5


def test_steps_go_in_and_come_out_in_their_unit() -> None:
    torch.manual_seed(0)
    metres, fine = MRT(MRTConfig(**SMALL)).eval(), MRT(MRTConfig(unit_m=0.1, **SMALL)).eval()
    fine.load_state_dict(metres.state_dict())
    with torch.no_grad():
        fine.embed_step.weight.mul_(0.1)
        fine.step.weight.mul_(10)
        fine.step.bias.mul_(10)
    torch.testing.assert_close(fine(*scene()), metres(*scene()), atol=1e-4, rtol=1e-4)


def test_nearness_is_one_at_the_asking_pose_and_falls() -> None:
    frames = torch.zeros(1, 2, 2, 45)
    frames[:, :, 1] = 1.0
    near = nearness(frames)
    assert near.shape == (1, 2, 2, 2)
    torch.testing.assert_close(near[0, 0], torch.tensor([[1.0, 1.0], [np.exp(-1), np.exp(-1)]]).float())


def test_frequencies_are_those_of_time_in_the_paper_and_of_coordinates_in_the_release() -> None:
    steps = torch.ones(1, 15, 45)
    paper, release = (MRT(MRTConfig(preset=preset, **SMALL)) for preset in ("paper", "release"))
    assert paper.to_frequencies(steps)[:, 1:].abs().max() < 1e-5
    assert release.to_frequencies(steps)[..., 1:].abs().max() < 1e-5
    for model in (paper, release):
        torch.testing.assert_close(model.from_frequencies(model.to_frequencies(steps)), steps, atol=1e-5, rtol=0)


def test_loss_is_that_of_the_steps(model: MRT) -> None:
    truth, observed = torch.zeros(1, 45, 1, 15, 3), torch.ones(1, 45, 1, 15, dtype=torch.bool)
    assert model.loss(truth + 1, truth, observed).item() == pytest.approx(1 / 45)  # one step of 45 is wrong
    observed[:, 0] = False
    assert model.loss(truth + 1, truth, observed).item() == 0


@pytest.mark.filterwarnings("ignore")
def test_the_exported_graph_answers_as_the_model_does(model: MRT, tmp_path: Path) -> None:
    onnxruntime, path = pytest.importorskip("onnxruntime"), tmp_path / "mrt.onnx"
    axes = {0: "batch", 2: "people"}
    names = {"history": axes, "observed": axes, "future": axes}
    torch.onnx.export(
        model, scene(2), path, input_names=["history", "observed"], output_names=["future"],
        dynamic_axes=names, opset_version=18, dynamo=False,
    )  # fmt: skip
    session = onnxruntime.InferenceSession(path)
    for people in (1, 3):
        history, observed = scene(people, batch=people)  # another batch too
        (answer,) = session.run(None, {"history": history.numpy(), "observed": observed.numpy()})
        np.testing.assert_allclose(answer, model(history, observed).detach().numpy(), atol=1e-4, rtol=1e-4)
