"""From made-up moments to a graph of goals, through both phases of learning."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

torch = pytest.importorskip("torch")
onnxruntime = pytest.importorskip("onnxruntime")

from motioncast.core.skeletons import H36M17  # noqa: E402
from motioncast.datasets.cmu_goals import GoalSample  # noqa: E402
from motioncast.errors import InputError  # noqa: E402
from motioncast.inference.registry import load  # noqa: E402
from motioncast.models import build  # noqa: E402
from motioncast.models.characteristic_poses import PRESETS, CharacteristicPoses  # noqa: E402
from motioncast.testing import walkers  # noqa: E402
from motioncast.training import goals_task  # noqa: E402
from motioncast.training.export_goals import GoalGraph, export_goals  # noqa: E402
from motioncast.training.goals_task import GoalsTask  # noqa: E402
from motioncast.training.loop import train  # noqa: E402
from motioncast.training.recipe import Recipe  # noqa: E402
from motioncast.training.ship import ship  # noqa: E402

pytestmark = pytest.mark.torch

SIZES = {"cells": 8, "coarse": 8, "fine": 8, "last": 8, "bumps": 3}
RECIPE = Recipe(
    "toy-goals", "characteristic_poses", SIZES, task="goals", steps=2, batch=4, warmup=1, validate_every=2, mirror=0.0,
    scale=(1.0, 1.0), noise_m=0.0,
)  # fmt: skip


def made_up(data: Path, split: str):
    """Walkers, each on the way to the last pose; the second one with a partner."""
    motion = walkers(people=2, frames=40, fps=30, seed=len(split)).on(H36M17).positions
    for person in range(2):
        partner = motion[:-1, 0] if person else None
        yield GoalSample("01_01", f"{person}", 1.3, motion[:-1, person], motion[-1, person], partner)


@pytest.fixture(autouse=True)
def samples(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(goals_task, "goal_samples", made_up)


def task(**changes) -> GoalsTask:
    recipe = replace(RECIPE, **changes)
    return GoalsTask(recipe, build(recipe.model, recipe.sizes), Path())


def test_a_batch_is_hip_centred_and_asks_for_one_stage() -> None:
    learning, stages = task(), set()
    batches = learning.batches(np.random.default_rng(0))
    for _ in range(12):
        batch = next(batches)
        assert batch.history.shape == (4, 10, 17, 3)
        assert not batch.history[:, -1, 0].any()
        assert not batch.target[:, 0].any()
        assert set(batch.asked) <= set(learning.stages[batch.stage])
        assert len(batch.asked) == (1, 1, goals_task.REST_JOINTS)[batch.stage]
        stages.add(batch.stage)
    assert stages == {0, 1, 2}


def test_targets_are_turned_with_the_last_pose_of_the_history() -> None:
    learning = task()
    history, target, partner = learning.seen(learning.train[1], 1.0)
    bones = (
        np.linalg.norm(target[1] - target[0]),
        np.linalg.norm(learning.train[1].target[1:2] - learning.train[1].target[0]),
    )
    assert bones[0] == pytest.approx(bones[1], abs=1e-5)
    assert np.linalg.norm(history[-1] - target, axis=-1).max() < 0.2  # the next frame of a walk
    apart = np.linalg.norm(learning.train[1].partner[-1] - learning.train[1].history[-1, 0], axis=-1)
    np.testing.assert_allclose(np.linalg.norm(partner, axis=-1), apart, atol=1e-5)
    assert np.isnan(learning.seen(learning.train[0], 0.0)[2]).all()


def test_a_mirrored_history_swaps_the_sides() -> None:
    plain, mirrored = task(), task(mirror=1.0)
    for seed in range(4):
        one, other = (learning.window(np.random.default_rng(seed)) for learning in (plain, mirrored))
        swapped = list(H36M17.mirror())
        np.testing.assert_allclose(other[1][swapped] * [-1, 1, 1], one[1], atol=1e-6)


def test_two_phases_train_and_what_ships_answers(tmp_path: Path) -> None:
    train(RECIPE, Path(), tmp_path / "heat", lambda line: None)
    offsets = replace(RECIPE, task="goal-offsets", start=str(tmp_path / "heat" / "best.pt"))
    train(offsets, Path(), tmp_path / "run", lambda line: None)
    first, second = (torch.load(tmp_path / run / "best.pt", weights_only=True) for run in ("heat", "run"))
    moved = {name for name in first if not torch.equal(first[name], second[name])}
    assert moved
    assert all("offset" in name for name in moved)
    card = ship(tmp_path / "run")
    assert (card.task, card.skeleton, card.history, card.fps) == ("goals", "h36m17", 10, 30.0)
    assert set(card.figures["validation_loss"]) == set(goals_task.STAGES)
    answer = load(tmp_path / "run" / "toy-goals.onnx").forecast(walkers(people=2), samples=4)
    assert answer.poses.shape == (4, 2, 15, 3)
    assert answer.heat["right_wrist"].shape == (2, 8, 8, 8)


@pytest.mark.parametrize(("people", "hypotheses", "stage"), [(1, 1, 0), (2, 3, 1), (1, 4, 2)])
def test_the_graph_and_torch_agree(tmp_path: Path, people: int, hypotheses: int, stage: int) -> None:
    from motioncast.core.card import ModelCard

    torch.manual_seed(0)
    model = CharacteristicPoses(PRESETS["tiny"]).eval().half().float()  # what ships is rounded
    card = export_goals(model, ModelCard("toy", "CP", "goals", "h36m17", 10, 1, 30.0), tmp_path)
    assert card.parameters == sum(parameter.numel() for parameter in model.parameters())
    given = (
        torch.randn(people, 10, 17, 3) * 0.3, torch.randn(people, hypotheses, 2, 3) * 0.3, torch.tensor(stage),
        torch.tensor(model.stages[stage]),
    )  # fmt: skip
    with torch.no_grad():
        expected = GoalGraph(model)(*given)
    session = onnxruntime.InferenceSession(tmp_path / "toy.onnx")
    names = [entry.name for entry in session.get_inputs()]
    answer = session.run(None, {name: part.numpy() for name, part in zip(names, given, strict=True)})
    np.testing.assert_allclose(answer[0], expected[0], atol=1e-5)
    assert (answer[1] == expected[1].numpy()).mean() > 0.999
    np.testing.assert_allclose(answer[2], expected[2], atol=1e-5)


def test_published_networks_have_no_graph(tmp_path: Path) -> None:
    from motioncast.core.card import ModelCard

    card = ModelCard("toy", "CP", "goals", "h36m17", 10, 1, 25.0)
    with pytest.raises(InputError, match='the preset "paper"'):
        export_goals(CharacteristicPoses(PRESETS["paper-h36m"]), card, tmp_path)
