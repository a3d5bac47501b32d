"""Goals on the command line, by a model whose graph is a toy."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from motioncast.core.card import ModelCard
from motioncast.core.goal_poses import GoalPoses
from motioncast.core.scene import Scene
from motioncast.formats.load import load_goals
from motioncast.inference.goals import GoalForecaster

CARD = ModelCard("toy-goals", "Characteristic 3D Poses", "goals", "h36m17", 10, 1, 30.0, stochastic=True)


@pytest.fixture
def toy(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The path of a model that answers with the last pose, again and again."""

    def forecast(self, scene: Scene, *, samples: int = 10, seed: int = 0, progress=None) -> GoalPoses:
        people, joints = len(scene.people), len(scene.skeleton)
        heat = np.full((people, 16, 16, 16), 1 / 16**3)
        return GoalPoses(
            np.repeat(scene.positions[-1:], samples, 0), scene, scene.people, self.card,
            np.full((samples, people), 1 / samples), {"right_wrist": heat, "left_wrist": heat},
            scene.positions[-1, :, 0], np.tile([1.0, 0.0], (people, 1)), np.zeros(joints, bool),
            np.zeros(people, bool), seed=seed, warnings=("made up",),
        )  # fmt: skip

    monkeypatch.setattr(GoalForecaster, "forecast", forecast)
    path = tmp_path / "toy-goals.onnx"
    path.write_bytes(b"no graph")
    path.with_suffix(".json").write_text(replace(CARD).to_json(), encoding="utf-8")
    return path


def test_ten_goals_are_written_and_told(walk: Path, toy: Path, command) -> None:
    done = command("forecast", walk, "--model", toy)
    assert (done.status, done.err) == (0, "note: made up\n")
    assert "10 goals of 2 people" in done.out
    assert "written: walk.goals.npz" in done.out
    assert len(load_goals("walk.goals.npz").poses) == 10


def test_json_has_the_shape_of_its_schema_and_writes_nothing(walk: Path, toy: Path, command) -> None:
    answer = command("forecast", walk, "--model", toy, "--samples", "3", "--at", "1.5", "--json").answer("goals")
    assert len(answer["goals"]) == 3
    assert answer["people"] == ["ada", "bea"]
    assert answer["files"] == []
    assert not Path("walk.at1.5.goals.npz").exists()


def test_a_file_may_be_named_but_not_one_that_was_given(walk: Path, toy: Path, command) -> None:
    assert command("forecast", walk, "--model", toy, "--out", "next.npz").status == 0
    assert load_goals("next.npz").people == ("ada", "bea")
    done = command("forecast", walk, "--model", toy, "--out", walk)
    assert done.status == 2
    assert "is the file you gave" in done.err


@pytest.mark.parametrize("option", [("--seconds", "2"), ("--view",), ("--sampler", "ddim"), ("--steps", "3")])
def test_goals_have_no_time(walk: Path, toy: Path, command, option: tuple[str, ...]) -> None:
    done = command("forecast", walk, "--model", toy, *option)
    assert done.status == 2
    assert "goals have no time" in done.err


@pytest.mark.parametrize("use", ["evaluate", "time", "demo"])
def test_where_futures_are_wanted_goals_are_refused(toy: Path, command, use: str) -> None:
    asked = {"evaluate": (toy, "cmu-duet", "--data", "."), "time": (toy,), "demo": ("--model", toy)}[use]
    done = command(use, *asked)
    assert done.status == 2
    assert "answers with goals, not with futures" in done.err
