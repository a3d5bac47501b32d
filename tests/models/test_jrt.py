from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

torch = pytest.importorskip("torch")

from motioncast.models.jrt import JRT, Answer, JRTConfig, nearness, steps_of  # noqa: E402

pytestmark = pytest.mark.torch

H, F = 6, 5
SMALL = {"history": H, "horizon": F, "width": 16, "layers": 2, "heads": 2}


def scene(people: int = 3, batch: int = 2) -> tuple[torch.Tensor, torch.Tensor]:
    generator = torch.Generator().manual_seed(people)
    steps = torch.randn(batch, H, people, 15, 3, generator=generator)
    return steps.cumsum(1) * 0.1, torch.ones(batch, H, people, 15, dtype=torch.bool)


@pytest.fixture
def model() -> JRT:
    torch.manual_seed(0)
    return JRT(JRTConfig(**SMALL)).eval()


def test_the_public_code_has_as_many_parameters_and_an_idle_norm() -> None:
    two, three = (
        sum(parameter.numel() for parameter in JRT(JRTConfig(**sizes)).parameters())
        for sizes in ({"skeleton": "somof13", "history": 16, "horizon": 14, "people": 2}, {})
    )
    assert two + 256 == 3_590_680
    assert three + 256 == 3_650_832


def test_moved_scenes_have_moved_answers(model: JRT) -> None:
    history, observed = scene()
    answer, shift = model(history, observed), torch.tensor([12.0, -7.0, 1.0])
    assert answer.shape == (2, F, 3, 15, 3)
    torch.testing.assert_close(model(history + shift, observed), answer + shift, atol=1e-4, rtol=0)


def test_people_are_told_apart_by_the_table_alone(model: JRT) -> None:
    history, observed = scene()
    order = [2, 0, 1]
    apart = model(history[:, :, order], observed) - model(history, observed)[:, :, order]
    assert apart.abs().max() > 1e-5
    torch.nn.init.zeros_(model.person)
    torch.testing.assert_close(
        model(history[:, :, order], observed), model(history, observed)[:, :, order], atol=1e-5, rtol=0
    )


def test_absent_people_change_nothing_wherever_they_stand(model: JRT) -> None:
    history, observed = scene()
    answer = model(history, observed)
    someone, gone = torch.randn(2, H, 1, 15, 3), torch.zeros(2, H, 1, 15, dtype=torch.bool)
    gone[:, :-1] = True  # was there, and has left
    more = torch.cat([history[:, :, :1], someone, history[:, :, 1:], someone], 2)
    seen = torch.cat([observed[:, :, :1], gone, observed[:, :, 1:], gone & False], 2)
    torch.testing.assert_close(model(more, seen)[:, :, [0, 2, 3]], answer, atol=1e-5, rtol=0)


def test_people_are_seen_and_more_than_the_table_has(model: JRT) -> None:
    history, observed = scene(5)
    answer, other = model(history, observed), history.clone()
    other[:, :-1, 4] += 0.5
    assert answer.shape == (2, F, 5, 15, 3)
    assert (model(other, observed) - answer)[:, :, 0].abs().max() > 1e-5


def test_a_hidden_joint_is_not_read(model: JRT) -> None:
    history, hidden = scene()
    hidden[:, 3:, 0, 14] = False
    other = history.clone()
    other[:, 3:, 0, 14] = 100.0
    torch.testing.assert_close(model(other, hidden), model(history, hidden))


def test_relations_hold_nearness_bones_and_persons(model: JRT) -> None:
    history, _ = scene(2, batch=1)
    relations = model.relations(history)
    assert relations.shape == (1, 30, 30, H + 2)
    hip, knee, other_knee, wrist = 1, 2, 15 + 2, 14  # of mrt15
    apart = (history[0, 3, 0, hip] - history[0, 3, 1, 2]).norm().item()
    assert relations[0, hip, other_knee, 3].item() == pytest.approx(math.exp(-apart), rel=1e-4)
    assert relations[0, hip, knee, H:].tolist() == relations[0, knee, knee, H:].tolist() == [1, 1]
    assert relations[0, hip, wrist, H:].tolist() == [0, 1]
    assert relations[0, hip, other_knee, H:].tolist() == [0, 0]


def test_loss_weighs_future_past_and_readings(model: JRT) -> None:
    history, observed = scene(1, batch=1)
    truth, seen = history[:, -1:] + torch.rand(1, F, 1, 15, 3), torch.ones(1, F, 1, 15, dtype=torch.bool)
    frames = torch.cat([history, truth], 1)
    steps, near = steps_of(frames), nearness(frames)
    right = [steps] * 3, [near] * 3
    assert model.loss(Answer(history, observed, *right), truth, seen).item() == pytest.approx(0, abs=3e-3)
    past, future = steps.clone(), steps.clone()
    past[:, :H, ..., 0] += 1
    future[:, H:, ..., 0] += 1
    for wrong, weight in (([past, steps, steps], 1), ([steps, steps, past], 2), ([steps, steps, future], 11)):
        loss = model.loss(Answer(history, observed, wrong, [near] * 3), truth, seen)
        assert loss.item() == pytest.approx(weight, abs=3e-3)
    late = near.clone()
    late[:, H:] += 1
    loss = model.loss(Answer(history, observed, [steps] * 3, [near, near, late]), truth, seen)
    assert loss.item() == pytest.approx(11, abs=3e-3)
    unseen = model.loss(Answer(history, observed, [future] * 3, [late] * 3), truth, seen & False)
    assert unseen.item() == pytest.approx(0, abs=3e-3)


def test_every_weight_learns(model: JRT) -> None:
    model.train()
    truth, seen = torch.randn(2, F, 3, 15, 3), torch.ones(2, F, 3, 15, dtype=torch.bool)
    model.loss(model(*scene()), truth, seen).backward()
    assert [name for name, value in model.named_parameters() if value.grad is None or not value.grad.any()] == []


@pytest.mark.filterwarnings("ignore")
def test_the_exported_graph_answers_as_the_model_does(model: JRT, tmp_path: Path) -> None:
    onnxruntime, path = pytest.importorskip("onnxruntime"), tmp_path / "jrt.onnx"
    axes = {0: "batch", 2: "people"}
    torch.onnx.export(
        model, scene(2), path, input_names=["history", "observed"], output_names=["future"],
        dynamic_axes={"history": axes, "observed": axes, "future": axes}, opset_version=18, dynamo=False,
    )  # fmt: skip
    session = onnxruntime.InferenceSession(path, providers=["CPUExecutionProvider"])
    for people in (1, 3):
        history, observed = scene(people, batch=people)
        (answer,) = session.run(None, {"history": history.numpy(), "observed": observed.numpy()})
        np.testing.assert_allclose(answer, model(history, observed).detach().numpy(), atol=1e-4)
