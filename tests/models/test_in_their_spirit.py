"""The models that follow a published one as far as it is known."""

from __future__ import annotations

import warnings
from pathlib import Path

import numpy as np
import pytest

torch = pytest.importorskip("torch")

from motioncast.models import build  # noqa: E402
from motioncast.nn.frames import turn  # noqa: E402
from motioncast.nn.social import PeopleAttention, whereabouts  # noqa: E402

pytestmark = pytest.mark.torch

H, F = 6, 8
SIZES = {
    "futuremotion_like": {"coefficients": 14, "width": 8, "blocks": 1},
    "tripod_like": {"joint_width": 8, "width": 16},
    "iaformer_like": {"coefficients": 14, "width": 8, "priors": 12},
    "stmoe_like": {"width": 8},
}
SEEN = torch.ones(2, H, 3, 15, dtype=torch.bool)


@pytest.fixture(params=SIZES)
def model(request: pytest.FixtureRequest) -> torch.nn.Module:
    """A small model whose weights are drawn, as if it were trained."""
    torch.manual_seed(0)
    model = build(request.param, {"history": H, "horizon": F, **SIZES[request.param]}).eval()
    for parameter in model.parameters():
        torch.nn.init.normal_(parameter, std=0.3)
    return model


@pytest.fixture
def history() -> torch.Tensor:
    return torch.randn(2, H, 3, 15, 3, generator=torch.Generator().manual_seed(1))


def test_the_answer_moves_and_turns_with_the_scene(model: torch.nn.Module, history: torch.Tensor) -> None:
    angle = torch.tensor(2.3)
    heading, shift = torch.stack([angle.cos(), angle.sin()]), torch.tensor([4.0, -7.0, 0.3])
    answer = model(history, SEEN)
    assert answer.shape == (2, F, 3, 15, 3)
    moved = model(turn(history, heading) + shift, SEEN)
    torch.testing.assert_close(moved, turn(answer, heading) + shift, atol=2e-4, rtol=1e-4)


def test_order_and_absent_people_change_nothing(model: torch.nn.Module, history: torch.Tensor) -> None:
    answer, order = model(history, SEEN), [2, 0, 1]
    torch.testing.assert_close(model(history[:, :, order], SEEN), answer[:, :, order], atol=1e-4, rtol=1e-4)
    absent, other = SEEN.clone(), history.clone()
    absent[:, :, 2], other[:, :, 2] = False, 50.0
    alone = model(history[:, :, :2], SEEN[:, :, :2])
    torch.testing.assert_close(model(other, absent)[:, :, :2], alone, atol=1e-4, rtol=1e-4)


def test_other_people_are_seen_where_the_original_sees_them(model: torch.nn.Module, history: torch.Tensor) -> None:
    other = history.clone()
    other[:, :, 1] += 0.5
    change = (model(other, SEEN) - model(history, SEEN))[:, :, 0].abs().max()
    assert (change > 1e-5) == (type(model).__name__ != "FutureMotionLike")


def test_every_weight_learns(model: torch.nn.Module, history: torch.Tensor) -> None:
    model.train()
    answer = model(history, SEEN)
    model.loss(answer, torch.randn_like(answer), torch.ones(2, F, 3, 15, dtype=torch.bool)).backward()
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
            np.testing.assert_allclose(answer, model(positions, observed).numpy(), atol=1e-4, rtol=1e-4)


def test_nobody_has_nothing_to_say() -> None:
    torch.manual_seed(0)
    attention, origin, heading = PeopleAttention(4), torch.randn(1, 2, 3), torch.tensor([[[1.0, 0], [0, 1]]])
    message = attention(torch.randn(1, 2, 4), origin, heading, torch.tensor([[True, False]]))
    assert message[0, 0].abs().max() == 0
    assert message[0, 1].abs().max() > 0  # who is absent may still hear


def test_whereabouts_are_those_of_the_one_who_looks() -> None:
    origin, heading = torch.tensor([[[1.0, 1, 0], [1, 4, 0]]]), torch.tensor([[[0.0, 1], [-1, 0]]])
    seen = whereabouts(origin, heading)[0, 0, 1]  # 3 m straight ahead, and looks to the left
    torch.testing.assert_close(seen, torch.tensor([np.tanh(1), 0, 0, 0, 1], dtype=torch.float32))
