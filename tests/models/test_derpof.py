from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

torch = pytest.importorskip("torch")

from motioncast.models.derpof import Answer, DeRPoF, DeRPoFConfig  # noqa: E402

pytestmark = pytest.mark.torch

H, F = 6, 5
SMALL = {"history": H, "horizon": F, "embedding": 4, "hidden": 8, "latent": 4}


def scene(people: int = 3, batch: int = 2) -> tuple[torch.Tensor, torch.Tensor]:
    generator = torch.Generator().manual_seed(people)
    steps = torch.randn(batch, H, people, 15, 3, generator=generator)
    return steps.cumsum(1) * 0.3, torch.ones(batch, H, people, 15, dtype=torch.bool)


@pytest.fixture
def model() -> DeRPoF:
    """A small model whose weights are drawn, as if it were trained."""
    torch.manual_seed(0)
    model = DeRPoF(DeRPoFConfig(**SMALL)).eval()
    for parameter in model.parameters():
        torch.nn.init.normal_(parameter, std=0.3)
    return model


def test_the_public_code_has_as_many_parameters() -> None:
    model = DeRPoF(DeRPoFConfig(skeleton="somof13", history=16, horizon=14))
    assert sum(parameter.numel() for parameter in model.parameters()) == 133_962


def test_moved_scenes_have_moved_answers(model: DeRPoF) -> None:
    history, observed = scene()
    answer, shift = model(history, observed), torch.tensor([12.0, -7.0, 1.0])
    assert answer.shape == (2, F, 3, 15, 3)
    torch.testing.assert_close(model(history + shift, observed), answer + shift, atol=1e-4, rtol=0)


def test_every_person_is_forecast_alone(model: DeRPoF) -> None:
    history, observed = scene()
    answer, order = model(history, observed), [2, 0, 1]
    torch.testing.assert_close(model(history[:, :, order], observed), answer[:, :, order], atol=1e-5, rtol=0)
    absent, other = observed.clone(), history.clone()
    absent[:, :, 2], other[:, :, 2] = False, 50.0
    torch.testing.assert_close(model(other, absent)[:, :, :2], answer[:, :, :2], atol=1e-5, rtol=0)


def test_a_hidden_joint_is_not_read(model: DeRPoF) -> None:
    history, hidden = scene()
    hidden[:, 3:, 0, 14] = False
    other = history.clone()
    other[:, 3:, 0, 14] = 100.0
    torch.testing.assert_close(model(other, hidden), model(history, hidden))


def test_only_training_draws(model: DeRPoF) -> None:
    history, observed = scene()
    torch.testing.assert_close(model(history, observed), model(history, observed), atol=0, rtol=0)
    model.train()
    one, other = model(history, observed), model(history, observed)
    assert (one.pose - other.pose).abs().max() > 1e-4
    torch.testing.assert_close(one.path, other.path)


def test_a_walk_without_gestures_is_all_path(model: DeRPoF) -> None:
    """Joints that move as one have steps of the path alone, and the pose's network sees zeros."""
    history, observed = scene()
    rigid = history[:, :, :, :1] + history[:, :1] - history[:, :1, :, :1]
    model.train()
    torch.manual_seed(1)
    one = model(rigid, observed)
    torch.manual_seed(1)
    still = model(rigid[:, -1:].expand(-1, H, -1, -1, -1), observed)
    torch.testing.assert_close(one.pose, still.pose, atol=1e-5, rtol=0)
    assert (one.path - still.path).abs().max() > 1e-3


def test_loss_adds_path_pose_and_divergence(model: DeRPoF) -> None:
    last, truth = torch.zeros(1, 1, 1, 15, 3), torch.zeros(1, F, 1, 15, 3)
    seen = torch.ones(1, F, 1, 15, dtype=torch.bool)
    path, pose, none = torch.zeros(1, F, 1, 1, 3), torch.zeros(1, F, 1, 15, 3), torch.zeros(1, 1, 4)
    assert model.loss(Answer(last, path, pose, none, none), truth, seen).item() == pytest.approx(0, abs=2e-5)
    assert model.loss(Answer(last, path + 2, pose, none, none), truth, seen).item() == pytest.approx(4, abs=1e-4)
    off = model.loss(Answer(last, path, pose + 2, none, none), truth, seen).item()
    assert off == pytest.approx(0.1 * 2 * math.sqrt(45), rel=1e-4)
    wide = model.loss(Answer(last, path, pose, none + 1, none + 1), truth, seen).item()
    assert wide == pytest.approx(0.1 * 0.01 * 4 * (math.e - 1) / 2, abs=2e-5)
    seen[:, :, :, 14] = False
    pose[..., 14, :] = 9.0
    assert model.loss(Answer(last, path, pose, none, none), truth, seen).item() == pytest.approx(0, abs=2e-5)
    assert model.loss(Answer(last, path + 2, pose, none + 1, none), truth, seen & False).item() == 0


def test_every_weight_learns(model: DeRPoF) -> None:
    model.train()
    truth, seen = torch.randn(2, F, 3, 15, 3), torch.ones(2, F, 3, 15, dtype=torch.bool)
    model.loss(model(*scene()), truth, seen).backward()
    assert [name for name, value in model.named_parameters() if value.grad is None or not value.grad.any()] == []


@pytest.mark.filterwarnings("ignore")
def test_the_exported_graph_answers_as_the_model_does(model: DeRPoF, tmp_path: Path) -> None:
    onnxruntime, path = pytest.importorskip("onnxruntime"), tmp_path / "derpof.onnx"
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
