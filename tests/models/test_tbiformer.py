from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

torch = pytest.importorskip("torch")

from motioncast.core.skeletons import SKELETONS  # noqa: E402
from motioncast.models.tbiformer import TBIFormer, TBIFormerConfig, part_means, warping_distance  # noqa: E402

pytestmark = pytest.mark.torch

H, F = 8, 5
SMALL = {
    "history": H, "horizon": F, "window": 4, "width": 16, "layers": 1, "heads": 2, "head_width": 8, "feed_forward": 32
}  # fmt: skip


def scene(people: int = 3, batch: int = 2) -> tuple[torch.Tensor, torch.Tensor]:
    generator = torch.Generator().manual_seed(people)
    steps = torch.randn(batch, H, people, 15, 3, generator=generator)
    return steps.cumsum(1) * 0.1, torch.ones(batch, H, people, 15, dtype=torch.bool)


@pytest.fixture(params=["paper", "release"])
def model(request: pytest.FixtureRequest) -> TBIFormer:
    torch.manual_seed(0)
    return TBIFormer(TBIFormerConfig(preset=request.param, **SMALL)).eval()


def test_the_public_code_has_as_many_parameters(model: TBIFormer) -> None:
    model = TBIFormer(TBIFormerConfig(history=50, horizon=25, preset=model.config.preset))
    assert sum(parameter.numel() for parameter in model.parameters()) == 5_647_149


def test_moved_scenes_have_moved_answers(model: TBIFormer) -> None:
    history, observed = scene()
    answer, shift = model(history, observed), torch.tensor([12.0, -7.0, 1.0])
    assert answer.shape == (2, F, 3, 15, 3)
    torch.testing.assert_close(model(history + shift, observed), answer + shift, atol=1e-4, rtol=0)


def test_absent_people_change_nothing_wherever_they_stand(model: TBIFormer) -> None:
    history, observed = scene()
    answer = model(history, observed)
    someone, gone = torch.randn(2, H, 1, 15, 3), torch.zeros(2, H, 1, 15, dtype=torch.bool)
    gone[:, :-1] = True  # was there, and has left
    more = torch.cat([history[:, :, :1], someone, history[:, :, 1:], someone], 2)
    seen = torch.cat([observed[:, :, :1], gone, observed[:, :, 1:], gone & False], 2)
    torch.testing.assert_close(model(more, seen)[:, :, [0, 2, 3]], answer, atol=1e-5, rtol=0)


def test_people_are_seen_of_any_number(model: TBIFormer) -> None:
    history, observed = scene(7)
    answer, other = model(history, observed), history.clone()
    other[:, :-1, 6] *= 3
    assert answer.shape == (2, F, 7, 15, 3)
    assert (model(other, observed) - answer)[:, :, 0].abs().max() > 1e-5


def test_a_hidden_joint_is_not_read(model: TBIFormer) -> None:
    history, hidden = scene()
    hidden[:, 3:, 0, 14] = False
    other = history.clone()
    other[:, 3:, 0, 14] = 100.0
    torch.testing.assert_close(model(other, hidden), model(history, hidden))


def test_only_training_draws_identities(model: TBIFormer) -> None:
    present = torch.tensor([[True, False, True, True]])
    assert model.identities(present)[present].tolist() == [0, 1, 2]
    model.train()
    torch.manual_seed(0)
    drawn = torch.stack([model.identities(present)[present] for _ in range(100)])
    assert set(drawn.flatten().tolist()) == set(range(10))
    assert all(len(set(numbers)) == 3 for numbers in drawn.tolist())


def test_parts_are_arms_legs_and_the_rest() -> None:
    means = part_means(SKELETONS["mrt15"])
    members = [set(row.nonzero()[:, 0].tolist()) for row in means]
    assert members == [{9, 10, 11}, {12, 13, 14}, {1, 2, 3}, {4, 5, 6}, {0, 7, 8}]
    torch.testing.assert_close(means.sum(1), torch.ones(5))


def test_parts_pool_joints_in_the_paper_and_mixtures_in_the_release(model: TBIFormer) -> None:
    history, _ = scene()
    rows = []
    for joint in (10, 2):  # an elbow and a knee that move alone
        alone = history[:, :1].expand(-1, H, -1, -1, -1).clone()
        alone[..., joint, :] = history[..., joint, :]
        velocity = (alone[:, 1:] - alone[:, :-1]).flatten(3).transpose(1, 2) @ model.transform.T
        parts = model.pooling @ velocity.unflatten(-1, (-1, 3))
        rows.append((parts.abs().amax((0, 1, 2, 4)) > 1e-4).tolist())
    moving = [[True, False, False, False, False], [False, False, True, False, False]]
    assert rows == (moving if model.config.preset == "paper" else [[True] * 5] * 2)


def naive_warping(one: np.ndarray, other: np.ndarray) -> float:
    """The recursion as it is written, cell by cell."""
    table = np.full((len(one) + 1, len(other) + 1), math.inf)
    table[0, 0] = 0
    for i, a in enumerate(one, 1):
        for j, b in enumerate(other, 1):
            ways = table[i - 1, j], table[i, j - 1], table[i - 1, j - 1]
            table[i, j] = ((a - b) ** 2).sum() - 0.1 * math.log(sum(math.exp(-way / 0.1) for way in ways))
    return float(table[-1, -1])


@pytest.mark.parametrize("length", [1, 2, 6])
def test_warping_is_its_recursion(length: int) -> None:
    one, other = torch.randn(2, 2, 3, length, 3, generator=torch.Generator().manual_seed(length))
    distance = warping_distance(one, other)
    naive = [naive_warping(a, b) for a, b in zip(one.flatten(0, 1).numpy(), other.flatten(0, 1).numpy(), strict=True)]
    np.testing.assert_allclose(distance.flatten().numpy(), naive, atol=1e-4)


def test_a_token_knows_its_own_and_whose_path_is_like(model: TBIFormer) -> None:
    """Rows of tokens (person, part, window): own 0, another window the last, else by the paths of that window."""
    history, _ = scene(2, batch=1)
    history[:, :, 1] = history[:, :, 0] + torch.tensor([2.0, 0, 0])
    windows = H - 4
    rows = model.relative_positions(history).view(2, 5, windows, 2, 5, windows)
    assert not rows[0, :, :, 0].any()
    assert not rows[1, :, :, 1].any()
    across = rows[0, :, :, 1].permute(0, 2, 1, 3)  # part, part, window, window
    here, elsewhere = torch.eye(windows, dtype=torch.bool), ~torch.eye(windows, dtype=torch.bool)
    assert (across[:, :, elsewhere] == 9).all()
    assert (across[:, :, here] == across[0, 0, here]).all()
    assert 1 < across[0, 0, 0, 0] < 9


def test_loss_is_that_of_the_steps(model: TBIFormer) -> None:
    truth, observed = torch.zeros(1, F, 1, 15, 3), torch.ones(1, F, 1, 15, dtype=torch.bool)
    assert model.loss(truth + 1, truth, observed).item() == pytest.approx(1 / F)  # one step of five is wrong
    observed[:, 0] = False
    assert model.loss(truth + 1, truth, observed).item() == 0


def test_every_weight_learns(model: TBIFormer) -> None:
    model.train()
    truth, seen = torch.randn(2, F, 3, 15, 3), torch.ones(2, F, 3, 15, dtype=torch.bool)
    model.loss(model(*scene()), truth, seen).backward()
    assert [name for name, value in model.named_parameters() if value.grad is None or not value.grad.any()] == []


@pytest.mark.filterwarnings("ignore")
def test_the_exported_graph_answers_as_the_model_does(model: TBIFormer, tmp_path: Path) -> None:
    onnxruntime, path = pytest.importorskip("onnxruntime"), tmp_path / "tbiformer.onnx"
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
