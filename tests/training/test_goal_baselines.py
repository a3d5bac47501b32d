from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

torch = pytest.importorskip("torch")

from motioncast.benchmarks.goals.questions import asked_of  # noqa: E402
from motioncast.core.skeletons import H36M17  # noqa: E402
from motioncast.datasets.cmu_goals import GoalSample  # noqa: E402
from motioncast.models import build  # noqa: E402
from motioncast.nn.pose_kinds import fit as fit_kinds  # noqa: E402
from motioncast.training import goal_baselines  # noqa: E402
from motioncast.training.goal_baselines import answer, baseline, best_error, draw, fit  # noqa: E402

pytestmark = pytest.mark.torch

SIZES = {
    "goal_head": {"width": 8},
    "goal_trajectory": {"width": 4, "blocks": 1},
    "dlow": {"width": 8, "code": 4},
}


def samples(count: int = 6) -> list[GoalSample]:
    """People who lift the right hand, each a little differently."""
    random = np.random.default_rng(0)
    pose = random.normal(0, 0.3, (17, 3))
    pose[[4, 11], 0], pose[[1, 14], 0] = -0.2, 0.2
    found = []
    for number in range(count):
        way = np.tile(pose, (40, 1, 1)) + random.normal(0, 0.01, (17, 3))
        way[:, 16, 2] += np.linspace(0, 0.5, 40)
        found.append(GoalSample(f"take {number}", "p", 1.0, way[:-1], way[-1]))
    return found


def test_windows_hold_the_pose_where_they_say() -> None:
    windows = draw(samples(), 8, np.random.default_rng(0))
    assert windows.history.shape == (8, 10, 17, 3)
    assert windows.future.shape == (8, 100, 17, 3)
    assert torch.equal(windows.seen.sum(1), windows.step + 1)
    for future, step in zip(windows.future, windows.step, strict=True):
        assert torch.equal(future[step], future[-1])
        assert not torch.equal(future[step], windows.history[0, -1])
    np.testing.assert_allclose(windows.history[:, -1, 0], 0, atol=1e-6)


def test_a_history_beyond_reach_is_not_drawn() -> None:
    (one,) = samples(1)
    long = GoalSample("t", "p", 9.0, np.tile(one.history, (10, 1, 1)), one.target)
    windows = draw([long], 20, np.random.default_rng(0))
    assert windows.step.max() <= 99


@pytest.mark.parametrize(
    ("file", "sizes", "goals"),
    [
        ("goal_head", {}, 1),
        ("goal_trajectory", {"system": "ltd"}, 1),
        ("goal_trajectory", {"system": "hisrep"}, 1),
        ("dlow", {}, 10),
    ],
)
def test_each_baseline_learns_and_answers_alike_twice(file: str, sizes: dict, goals: int) -> None:
    torch.manual_seed(0)
    model = build(file, SIZES[file] | sizes)
    loss = model.train().loss(*draw(samples(), 4, np.random.default_rng(0)).parts)
    loss.backward()
    moved = [name for name, parameter in model.named_parameters() if parameter.grad is not None]
    still = {name for name, _ in model.named_parameters()} - set(moved)
    assert all(name.startswith("maps") for name in still)
    asked = asked_of(samples(), {})
    poses = answer(model, asked)
    assert poses.shape == (6, 5, goals, 17, 3)
    np.testing.assert_array_equal(poses, answer(model, asked))
    assert np.all(poses[..., 0, :] == 0)


def test_the_maps_of_dlow_learn_alone_and_make_poses_differ() -> None:
    torch.manual_seed(0)
    model = build("dlow", SIZES["dlow"])
    model.learn_sampling()
    model.train().loss(*draw(samples(), 4, np.random.default_rng(0)).parts).backward()
    learnt = {name for name, parameter in model.named_parameters() if parameter.grad is not None}
    assert learnt == {name for name, _ in model.named_parameters() if name.startswith("maps")}


def test_the_true_frame_can_be_told() -> None:
    torch.manual_seed(0)
    asked = asked_of(samples(), {})
    for name in ("goal_trajectory", "dlow"):
        model = build(name, SIZES[name])
        assert not np.allclose(answer(model, asked, told=True), answer(model, asked))


def test_a_fitted_head_is_better_than_an_untrained_one_and_is_kept(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(goal_baselines, "BASELINES", {"deterministic head": ("goal_head", SIZES["goal_head"], 20)})
    asked, lines = asked_of(samples(), {}), []
    torch.manual_seed(0)
    before = best_error(build("goal_head", SIZES["goal_head"]), asked)
    model = baseline("deterministic head", samples(), asked, tmp_path, say=lines.append)
    assert best_error(model, asked) < before
    assert len(lines) == 1
    again = baseline("deterministic head", samples(), asked, tmp_path, say=lines.append)
    np.testing.assert_array_equal(answer(again, asked), answer(model, asked))
    assert len(lines) == 1


def test_fitting_keeps_the_best_weights(monkeypatch: pytest.MonkeyPatch) -> None:
    errors = iter([0.1, 0.3, 0.2])
    monkeypatch.setattr(goal_baselines, "best_error", lambda model, asked: next(errors))
    monkeypatch.setattr(goal_baselines, "CHECK_EVERY", 1)
    torch.manual_seed(0)
    model = build("goal_head", SIZES["goal_head"])
    kept = fit(model, samples(), asked_of(samples(), {}), 3, say=lambda line: None)
    assert kept is not model
    assert not torch.equal(kept.place, model.place)


def test_a_classifier_tells_raised_hands_from_lowered_ones_however_they_are_turned() -> None:
    random = np.random.default_rng(0)
    poses = np.tile(samples(1)[0].target, (40, 1, 1)) + random.normal(0, 0.02, (40, 17, 3))
    kinds = ["up", "down"] * 20
    poses[1::2, 16, 2] -= 1.0
    judge = fit_kinds(poses[:20], kinds[:20], poses[20:], kinds[20:], H36M17)
    assert judge.kinds == ("down", "up")
    assert judge.accuracy(poses[20:], kinds[20:]) == 1
    turned = poses[20:] * np.array([-1, -1, 1])
    np.testing.assert_allclose(judge.probabilities(turned), judge.probabilities(poses[20:]), atol=1e-5)
