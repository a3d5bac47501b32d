from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

torch = pytest.importorskip("torch")

from motioncast.models.empmp import EMPMP, EMPMPConfig, distances_between, seating  # noqa: E402

pytestmark = pytest.mark.torch

SMALL = {"blocks": 4, "interval": 2}


def scene(people: int = 3, batch: int = 2) -> tuple[torch.Tensor, torch.Tensor]:
    generator = torch.Generator().manual_seed(people)
    steps = torch.randn(batch, 15, people, 15, 3, generator=generator)
    return steps.cumsum(1) * 0.03, torch.ones(batch, 15, people, 15, dtype=torch.bool)


@pytest.fixture(scope="module")
def model() -> EMPMP:
    torch.manual_seed(0)
    model = EMPMP(EMPMPConfig(**SMALL)).eval()
    for parameter in model.parameters():  # as published it begins with layers of zeros
        if parameter.dim() > 1:
            torch.nn.init.normal_(parameter, std=0.05)
    return model


@pytest.mark.parametrize(
    ("sizes", "count"),
    [
        ({}, 55_200),
        ({"horizon": 15}, 51_060),
        ({"skeleton": "somof13", "history": 16, "horizon": 14, "people": 2}, 41_772),
        ({"history": 30, "horizon": 30}, 166_020),
    ],
)
def test_it_has_the_papers_number_of_parameters(sizes: dict, count: int) -> None:
    assert sum(parameter.numel() for parameter in EMPMP(EMPMPConfig(**sizes)).parameters()) == count


def test_untrained_it_repeats_the_last_pose() -> None:
    history, observed = scene()
    answer = EMPMP(EMPMPConfig(**SMALL))(history, observed)
    torch.testing.assert_close(answer, history[:, -1:].expand_as(answer), atol=1e-5, rtol=0)


def test_moved_scenes_have_moved_answers(model: EMPMP) -> None:
    history, observed = scene()
    shift = torch.tensor([12.0, -7.0, 1.0])
    torch.testing.assert_close(model(history + shift, observed), model(history, observed) + shift, atol=1e-4, rtol=0)


def test_absent_people_take_no_place(model: EMPMP) -> None:
    history, observed = scene()
    answer = model(history, observed)
    more = torch.cat([history[:, :, :1], torch.randn(2, 15, 2, 15, 3), history[:, :, 1:]], 2)
    seen = torch.ones(2, 15, 5, 15, dtype=torch.bool)
    seen[:, :, 1] = False
    seen[:, -1, 2] = False  # was there, and has left
    torch.testing.assert_close(model(more, seen)[:, :, [0, 3, 4]], answer, atol=1e-5, rtol=0)


def test_more_people_than_places_are_answered_in_groups(model: EMPMP) -> None:
    history, observed = scene(5)
    history = history - history[:, -1:].mean((2, 3), keepdim=True)
    answer = model(history, observed)
    changed = history.clone()
    changed[:, :-1, 4] += 0.5
    change = (model(changed, observed) - answer).abs().amax((0, 1, 3, 4))
    assert change[:3].max() < 1e-5
    assert change[3:].min() > 1e-4


def test_people_are_seen_by_their_distance_too() -> None:
    path = torch.tensor([[0.0, 0, 0], [3.0, 4.0, 0]]).view(1, 2, 1, 3)
    torch.testing.assert_close(distances_between(path)[0, 0], torch.tensor([[0.0, 5.0], [5.0, 0.0]]), atol=1e-5, rtol=0)


def test_seats() -> None:
    present = torch.tensor([[True, False, True, True], [False, False, False, True]])
    seats = seating(present, 3)
    assert seats.shape == (2, 6, 4)
    assert seats[0].nonzero().tolist() == [[0, 0], [1, 2], [2, 3]]
    assert seats[1].nonzero().tolist() == [[0, 3]]


def test_loss_is_distance_and_distance_of_steps(model: EMPMP) -> None:
    truth, observed = torch.zeros(1, 3, 1, 15, 3), torch.ones(1, 3, 1, 15, dtype=torch.bool)
    answer = truth + torch.tensor([0.0, 1.0, 2.0]).view(1, 3, 1, 1, 1) * torch.tensor([1.0, 0.0, 0.0])
    assert model.loss(answer, truth, observed).item() == pytest.approx(1 + 1, abs=1e-3)


@pytest.mark.filterwarnings("ignore")
def test_the_exported_graph_answers_as_the_model_does(model: EMPMP, tmp_path: Path) -> None:
    onnxruntime, path = pytest.importorskip("onnxruntime"), tmp_path / "empmp.onnx"
    axes = {0: "batch", 2: "people"}
    names = {"history": axes, "observed": axes, "future": axes}
    torch.onnx.export(
        model, scene(2), path, input_names=["history", "observed"], output_names=["future"],
        dynamic_axes=names, opset_version=18, dynamo=False,
    )  # fmt: skip
    session = onnxruntime.InferenceSession(path)
    for people in (1, 3, 4):
        history, observed = scene(people, batch=people)  # another batch too
        observed[0, -1, people - 1] = people == 1
        (answer,) = session.run(None, {"history": history.numpy(), "observed": observed.numpy()})
        np.testing.assert_allclose(answer, model(history, observed).detach().numpy(), atol=1e-4, rtol=1e-4)
