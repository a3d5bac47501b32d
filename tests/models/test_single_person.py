"""What holds for every model that forecasts each person from its own history alone."""

from __future__ import annotations

import warnings
from pathlib import Path

import numpy as np
import pytest

torch = pytest.importorskip("torch")

from motioncast.models import build  # noqa: E402
from motioncast.nn.frames import turn  # noqa: E402

pytestmark = pytest.mark.torch

H, F = 6, 8
SIZES = {
    "ltd": {"coefficients": 14, "width": 8, "blocks": 1},
    "hisrep": {"kernel": 2, "step": 3, "coefficients": 5, "width": 8, "blocks": 1},
    "simlpe": {"blocks": 2, "step": 5},
    "ridge": {},
}
SEEN = torch.ones(2, H, 3, 15, dtype=torch.bool)


@pytest.fixture(params=SIZES)
def model(request: pytest.FixtureRequest) -> torch.nn.Module:
    """A small model whose weights are drawn, as if it were trained."""
    torch.manual_seed(0)
    model = build(request.param, {"history": H, "horizon": F, **SIZES[request.param]}).eval()
    for parameter in model.parameters():
        torch.nn.init.normal_(parameter, std=0.05)
    return model


@pytest.fixture
def history() -> torch.Tensor:
    return torch.randn(2, H, 3, 15, 3, generator=torch.Generator().manual_seed(1))


def test_the_answer_moves_and_turns_with_the_scene(model: torch.nn.Module, history: torch.Tensor) -> None:
    angle = torch.tensor(2.3)
    heading, shift = torch.stack([angle.cos(), angle.sin()]), torch.tensor([4.0, -7.0, 0.3])
    answer = model(history, SEEN)
    assert answer.shape == (2, F, 3, 15, 3)
    assert (answer - history[:, -1:]).abs().max() > 1e-3
    moved = model(turn(history, heading) + shift, SEEN)
    torch.testing.assert_close(moved, turn(answer, heading) + shift, atol=1e-4, rtol=0)


def test_every_person_is_forecast_alone(model: torch.nn.Module, history: torch.Tensor) -> None:
    answer, order = model(history, SEEN), [2, 0, 1]
    torch.testing.assert_close(model(history[:, :, order], SEEN), answer[:, :, order], atol=1e-5, rtol=0)
    torch.testing.assert_close(model(history[:, :, :1], SEEN[:, :, :1]), answer[:, :, :1], atol=1e-5, rtol=0)
    absent, other = SEEN.clone(), history.clone()
    absent[:, :, 2], other[:, :, 2] = False, 50.0
    torch.testing.assert_close(model(other, absent)[:, :, :2], answer[:, :, :2], atol=1e-5, rtol=0)


def test_a_hidden_joint_is_not_read(model: torch.nn.Module, history: torch.Tensor) -> None:
    hidden, other = SEEN.clone(), history.clone()
    hidden[:, 3:, 0, 14], other[:, 3:, 0, 14] = False, 100.0
    answer = model(other, hidden)
    torch.testing.assert_close(answer, model(history, hidden))
    torch.testing.assert_close(answer[:, :, 1:], model(history, SEEN)[:, :, 1:], atol=1e-5, rtol=0)


def test_every_weight_that_answers_learns(model: torch.nn.Module, history: torch.Tensor) -> None:
    model.train()
    truth, seen = torch.randn(2, F, 3, 15, 3), torch.ones(2, F, 3, 15, dtype=torch.bool)
    loss = model.loss(model(history, SEEN), truth, seen)
    loss.backward()
    assert loss.isfinite()
    still = [name for name, value in model.named_parameters() if value.grad is None or not value.grad.any()]
    assert still == []


def test_the_graph_answers_as_torch_does(model: torch.nn.Module, tmp_path: Path) -> None:
    pytest.importorskip("onnx")
    runtime = pytest.importorskip("onnxruntime")
    path, axes = tmp_path / "model.onnx", {0: "batch", 2: "people"}
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # the tracer remarks on every shape
        torch.onnx.export(
            model, (torch.randn(2, H, 3, 15, 3), SEEN), path, input_names=["history", "observed"],
            output_names=["future"], dynamic_axes={"history": axes, "observed": axes, "future": axes},
            opset_version=18, dynamo=False,
        )  # fmt: skip
    session = runtime.InferenceSession(path, providers=["CPUExecutionProvider"])
    for batch, people in ((1, 1), (3, 3)):
        positions, observed = torch.randn(batch, H, people, 15, 3), torch.rand(batch, H, people, 15) > 0.1
        (answer,) = session.run(None, {"history": positions.numpy(), "observed": observed.numpy()})
        with torch.no_grad():
            np.testing.assert_allclose(answer, model(positions, observed).numpy(), atol=1e-4)
