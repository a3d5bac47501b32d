"""Goals around a graph that is played by a few lines of arithmetic."""

from __future__ import annotations

import json
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np
import pytest
from jsonschema import Draft202012Validator

from motioncast.core.card import ModelCard
from motioncast.core.goal_poses import GoalPoses
from motioncast.core.scene import Scene
from motioncast.core.skeletons import H36M17
from motioncast.core.voxels import cell_of, corner_of, numbered
from motioncast.errors import FormatError, InputError, SceneError
from motioncast.formats.answers import goals_answer
from motioncast.formats.load import load_goals, load_scene, save_goals
from motioncast.inference.goals import GoalForecaster, blurred, drawn, grounded, plateau, softmax
from motioncast.inference.registry import list_models, load, load_forecaster
from motioncast.testing import Check, checks, walkers

CARD = ModelCard(
    "toy-goals", "Characteristic 3D Poses", "goals", "h36m17", history=10, horizon=1, fps=30.0, stochastic=True,
    parameters=1, tolerance_m=0.02,
)  # fmt: skip
RIGHT, LEFT = 16, 13
CORNERS = corner_of(numbered()).astype(np.float32)
MIDDLES = CORNERS + np.float32(0.0625)


@dataclass
class Graph:
    """Stands for the graph: the right hand is reached forward or up, the left follows, all else stays."""

    asked: list[dict[str, np.ndarray]] = field(default_factory=list)

    def run(self, outputs: None, inputs: dict[str, np.ndarray]) -> list[np.ndarray]:
        self.asked.append(inputs)
        history, known, stage = inputs["history"], inputs["known"], int(inputs["stage"])
        rows = known.reshape(-1, 2, 3)
        last = np.repeat(history[:, -1], known.shape[1], 0)
        asked = inputs["asked"]
        places = last[:, asked][:, :, None]  # rows, asked, modes, 3
        if stage == 0:
            places = places + np.array([[0, 0.15, 0.1], [0, 0.05, 0.2]], np.float32)
        if stage == 1:
            places = (rows[:, 0] * np.array([-1, 1, 1]))[:, None, None]
        away = np.square(MIDDLES - places[:, :, :, None]).sum(-1)  # rows, asked, modes, voxels
        mode = away.argmin(2)
        heat = np.exp(-away.min(2) / 0.05).astype(np.float32)
        near = np.take_along_axis(places, mode[..., None], 2)
        offsets = np.clip(near - CORNERS, -0.125, 0.125).swapaxes(-1, -2).astype(np.float32)
        cube = (*heat.shape[:2], 16, 16, 16)
        level = np.minimum(heat * 12, 9).astype(np.int64)
        return [heat.reshape(cube), level.reshape(cube), offsets.reshape(*heat.shape[:2], 3, 16, 16, 16)]


def toy(**settings) -> tuple[GoalForecaster, Graph]:
    graph = Graph()
    return GoalForecaster(CARD, Path("toy.onnx"), _opened=[graph], **settings), graph  # pyright: ignore[reportArgumentType]


@pytest.mark.parametrize("check", checks(toy()[0]), ids=str)
def test_what_surrounds_the_graph_holds_the_contract(check: Check) -> None:
    check()


def test_ten_goals_take_three_passes_of_one_five_and_ten() -> None:
    model, graph = toy()
    model.forecast(walkers(people=2))
    assert [asked["known"].shape for asked in graph.asked] == [(2, 1, 2, 3), (2, 5, 2, 3), (2, 10, 2, 3)]
    assert [asked["asked"].tolist() for asked in graph.asked[:2]] == [[RIGHT], [LEFT]]
    assert len(graph.asked[2]["asked"]) == 15
    assert [int(asked["stage"]) for asked in graph.asked] == [0, 1, 2]


def test_the_rest_is_asked_for_with_the_hands_that_were_sampled() -> None:
    model, graph = toy(refine=False, rigid=False)
    scene = walkers(people=1, fps=30)
    answer = model.forecast(scene)
    pelvis, wrist = (answer.poses[:, 0, scene.skeleton.index(name), 2] for name in ("pelvis", "right_wrist"))
    known = graph.asked[2]["known"][0]
    assert len(np.unique(known[:, 0].round(6), axis=0)) > 1  # several right hands
    np.testing.assert_allclose(known[:, 1], known[:, 0] * [-1, 1, 1], atol=0.07)  # the left one follows its right one
    np.testing.assert_allclose(np.sort(wrist - pelvis), np.sort(known[:, 0, 2]), atol=1e-5)


def test_weights_and_heat_are_those_of_the_hands() -> None:
    answer = toy()[0].forecast(walkers(people=1, fps=30))
    assert answer.weights.sum() == pytest.approx(1)
    assert (np.diff(answer.weights[:, 0]) <= 0).all()
    person, place, share = answer.heat_points("right_wrist", least=1e-3)
    assert set(person) == {0}
    assert share.max() == pytest.approx(answer.heat["right_wrist"].max())
    hand = answer.poses[0, 0, answer.skeleton.index("right_wrist")]
    assert np.linalg.norm(place[share.argmax()] - hand) < 0.25


def test_seeds_change_what_is_drawn_and_a_temperature_draws_hands_too() -> None:
    scene = walkers(people=1, fps=30)
    for settings in ({}, {"sampling": "temperature"}):
        model = toy(refine=False, **settings)[0]
        one, other = (model.forecast(scene, seed=seed) for seed in (0, 1))
        assert np.abs(one.poses - other.poses).max() > 0.01
    wrists = [
        toy(refine=False, rigid=False, sampling="temperature")[0].forecast(scene, seed=seed).poses[:, 0, -1]
        for seed in (0, 1)
    ]
    assert np.abs(np.sort(wrists[0], 0) - np.sort(wrists[1], 0)).max() > 0.01


def test_people_have_chances_of_their_own() -> None:
    scene = walkers(people=2, fps=30)
    twins = replace(scene, positions=scene.positions[:, [0, 0]])
    answer = toy(refine=False)[0].forecast(twins)
    assert np.abs(answer.poses[:, 0] - answer.poses[:, 1]).max() > 0.01


def test_refined_poses_have_the_bones_of_the_last_one_and_sampled_ones_do_not() -> None:
    scene = walkers(people=1, fps=30).on(H36M17)
    joints, parents = zip(*H36M17.bones, strict=True)

    def stretch(answer: GoalPoses) -> float:
        then, now = (
            np.linalg.norm(pose[..., joints, :] - pose[..., parents, :], axis=-1)
            for pose in (scene.positions[-1], answer.poses)
        )
        return float(np.abs(now - then).max())

    assert stretch(toy(rigid=False)[0].forecast(scene)) < 0.01
    assert stretch(toy(rigid=False, refine=False)[0].forecast(scene)) > 0.03


def test_who_was_seen_too_briefly_holds_the_last_pose() -> None:
    scene = walkers(people=2, fps=30)
    late = scene.observed.copy()
    late[:-3, 1] = False
    answer = toy()[0].forecast(replace(scene, observed=late))
    assert answer.guessed.tolist() == [False, True]
    assert "person 2" in answer.warnings[0]
    np.testing.assert_allclose(answer.poses[:, 1], scene.positions[[-1] * 10, 1], atol=1e-3)


def test_joints_that_the_model_does_not_know_are_carried() -> None:
    scene = walkers(people=1, fps=30)
    assert not toy()[0].forecast(scene).carried.any()
    assert toy()[0].forecast(scene).skeleton == scene.skeleton


def test_what_cannot_be_asked_is_refused_with_a_sentence() -> None:
    model = toy()[0]
    with pytest.raises(InputError, match="at least 1"):
        model.forecast(walkers(), samples=0)
    with pytest.raises(SceneError, match=r"reads 0\.30 s"):
        model.forecast(walkers(fps=30)[:5])


def test_a_goal_is_a_scene_of_one_frame() -> None:
    scene = walkers(people=2, fps=30)
    answer = toy()[0].forecast(scene)
    assert answer.scene(3).frames == 1
    np.testing.assert_array_equal(answer.scene().positions[0], answer.best)


def test_files_hold_everything_and_a_damaged_one_is_refused(tmp_path: Path) -> None:
    answer = toy()[0].forecast(walkers(people=2, fps=30))
    (file,) = save_goals(answer, tmp_path / "a.npz")
    back = load_goals(file)
    np.testing.assert_array_equal(back.poses, answer.poses)
    np.testing.assert_allclose(back.weights, answer.weights, atol=1e-7)
    np.testing.assert_allclose(back.heat["left_wrist"], answer.heat["left_wrist"], atol=1e-9)
    np.testing.assert_allclose(back.heat_across, answer.heat_across, atol=1e-7)
    assert (back.card, back.people, back.heat_side_m) == (answer.card, answer.people, 2.0)
    np.testing.assert_array_equal(load_scene(file).positions, answer.history.positions)
    with np.load(file) as arrays:
        np.savez(file, **{name: arrays[name] for name in arrays if name != "weights"})  # pyright: ignore[reportArgumentType]
    with pytest.raises(FormatError, match='"weights" is missing'):
        load_goals(file)


def test_answers_have_the_shape_of_their_schema() -> None:
    path = Path(__file__).parents[2] / "docs" / "schemas" / "goals.json"
    schema = Draft202012Validator(json.loads(path.read_text(encoding="utf-8")))
    answer = goals_answer(toy()[0].forecast(walkers(people=2, fps=30)))
    schema.validate(json.loads(json.dumps(answer, default=lambda value: value.tolist())))


def test_goals_that_do_not_fit_together_are_refused() -> None:
    answer = toy()[0].forecast(walkers(people=2, fps=30))
    with pytest.raises(SceneError, match="weights of the goal poses have shape"):
        replace(answer, weights=answer.weights[:3])
    with pytest.raises(SceneError, match="not finite"):
        replace(answer, poses=answer.poses * np.nan)
    with pytest.raises(SceneError, match='a goal is of "nobody"'):
        replace(answer, people=("person 1", "nobody"))


def test_a_model_of_goals_is_found_by_its_card_and_makes_no_futures(tmp_path: Path, monkeypatch) -> None:
    monkeypatch.setenv("MOTIONCAST_HOME", str(tmp_path))
    (tmp_path / "toy-goals.onnx").write_bytes(b"no graph")
    (tmp_path / "toy-goals.json").write_text(replace(CARD, checksum="0").to_json(), encoding="utf-8")
    assert "toy-goals" in [card.name for card in list_models("goals")]
    assert "toy-goals" not in [card.name for card in list_models("forecast")]
    model = load("toy-goals")
    assert isinstance(model, GoalForecaster)
    with pytest.raises(InputError, match="is damaged"):
        model.forecast(walkers(fps=30))
    with pytest.raises(InputError, match="answers with goals, not with futures"):
        load_forecaster("toy-goals")


def test_draws_follow_their_shares_and_a_plateau_is_picked_evenly() -> None:
    shares = np.tile(softmax(np.array([0.0, 1.0, 2.0]))[None, None], (1, 4000, 1))
    found = np.bincount(drawn(shares, [np.random.default_rng(0)])[0], minlength=3) / 4000
    np.testing.assert_allclose(found, shares[0, 0], atol=0.03)
    assert plateau(np.array([9, 9, 9, 1, 9]), 2).tolist() == [0, 4]


def test_a_blur_is_a_mean_of_five_and_repeats_the_edge() -> None:
    heat = np.random.default_rng(0).random((2, 8, 8, 8))
    wide = np.pad(heat, ((0, 0), (2, 2), (2, 2), (2, 2)), mode="edge")
    expected = wide[:, 1:6, 2:7, 3:8].mean((1, 2, 3))
    np.testing.assert_allclose(blurred(heat).reshape(heat.shape)[:, 1, 2, 3], expected)


def test_who_crouches_does_not_hang_in_the_air() -> None:
    last = np.zeros((1, 17, 3))
    last[:, 3, 2], last[:, 6, 2] = -0.9, -0.88
    goals = np.zeros((1, 2, 17, 3))
    goals[0, 0, 3, 2], goals[0, 1, 6, 2] = -0.4, -1.0
    stood = grounded(goals, last)
    np.testing.assert_allclose(stood[..., 2].min(-1), -0.9)
    np.testing.assert_allclose(stood[0, :, 0, 2], [-0.5, 0.1])


def test_the_played_graph_is_no_stranger_to_the_grid() -> None:
    np.testing.assert_array_equal(cell_of(CORNERS + 0.01), numbered())
    assert isinstance(walkers(), Scene)
