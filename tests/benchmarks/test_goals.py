from __future__ import annotations

import numpy as np
import pytest

from motioncast.benchmarks.goals.guesses import average_pose, nearest_neighbours, random_voxels, zero_velocity
from motioncast.benchmarks.goals.questions import PROTOCOL, Questions, asked_of
from motioncast.benchmarks.goals.run import answers
from motioncast.benchmarks.goals.scoring import BEST, FIRST, result_of, score
from motioncast.core.card import ModelCard
from motioncast.core.goal_poses import GoalPoses
from motioncast.core.rotation import from_axis_angle, rotate
from motioncast.core.scene import Scene
from motioncast.core.skeletons import H36M17
from motioncast.datasets.cmu_goals import GoalSample

SAMPLES = 12


def samples(turn: float = 0.0) -> list[GoalSample]:
    """People who drift about, each in a pose of its own; the same ones turned about the vertical."""
    random = np.random.default_rng(0)
    found = []
    for number in range(SAMPLES):
        way = random.normal(0, 0.3, (1, 17, 3)) + np.cumsum(random.normal(0, 0.02, (31, 17, 3)), 0)
        way[:, [4, 11], 0] -= 1.0  # the left is to the left
        way = rotate(from_axis_angle(np.array([0, 0, turn])), way)
        partner = way[:-1] + 1 if number % 2 else None
        found.append(GoalSample(f"take {number // 2}", "p", 1.0, way[:-1], way[-1], partner))
    return found


@pytest.fixture
def asked() -> Questions:
    return asked_of(samples(), {"take 0": "walk"})


def test_questions_end_before_the_pose_that_they_ask_for(asked: Questions) -> None:
    assert asked.histories.shape == (SAMPLES, 5, 10, 17, 3)
    assert asked.ahead[0].tolist() == [21, 14, 11, 8, 1]
    np.testing.assert_allclose(asked.targets[:, 0], 0)
    np.testing.assert_array_equal(asked.histories[3, -1, -1], samples()[3].history[-1])
    assert asked.kinds[:3] == ("walk", "walk", "")
    assert np.isnan(asked.partners[0]).all()
    assert np.isfinite(asked.partners[1]).all()


def test_answers_seen_from_oneself_come_back_to_the_world(asked: Questions) -> None:
    for start in range(5):
        np.testing.assert_allclose(asked.to_world(asked.own_targets[:, :, None])[:, start, 0], asked.targets, atol=1e-9)


@pytest.mark.parametrize("guess", [zero_velocity, lambda asked: average_pose(asked, asked_of(samples(), {})),
                                   lambda asked: nearest_neighbours(asked, asked_of(samples(), {}))])  # fmt: skip
def test_a_turned_world_has_turned_answers(guess, asked: Questions) -> None:
    turned = guess(asked_of(samples(1.2), {}))
    np.testing.assert_allclose(turned, rotate(from_axis_angle(np.array([0, 0, 1.2])), guess(asked)), atol=1e-9)


def test_who_was_seen_in_training_finds_themselves_first(asked: Questions) -> None:
    poses = nearest_neighbours(asked, asked)
    np.testing.assert_allclose(poses[:, 2, 0], asked.targets, atol=1e-9)
    rows = {row.metric: row.value for row in score(asked, poses)}
    assert rows[BEST] == pytest.approx(0, abs=1e-9)
    assert rows["diversity"] > 0.1


def test_neighbours_are_ten_different_moments(asked: Questions) -> None:
    poses = nearest_neighbours(asked, asked)
    assert len({pose.round(6).tobytes() for pose in poses[0, 0]}) == 10


def test_voxels_are_drawn_within_the_cube_and_again_alike(asked: Questions) -> None:
    poses = random_voxels(asked)
    assert np.abs(poses[..., 2]).max() < 1
    assert np.linalg.norm(poses, axis=-1).max() < np.sqrt(3)
    np.testing.assert_array_equal(poses, random_voxels(asked))


def test_standing_still_is_the_measure_of_all(asked: Questions) -> None:
    rows = {row.metric: row for row in score(asked, zero_velocity(asked))}
    assert rows["ratio_to_zero_velocity"].value == 1
    assert BEST not in rows
    assert rows[FIRST].value == pytest.approx(
        np.mean([rows[f"{FIRST}_from_start_{number}"].value for number in range(1, 6)])
    )
    assert rows[f"{FIRST}_from_start_1"].value > rows[f"{FIRST}_from_start_5"].value
    low, value, high = rows[FIRST].low, rows[FIRST].value, rows[FIRST].high
    assert low is not None
    assert high is not None
    assert low < value < high


def test_a_classifier_adds_its_score(asked: Questions) -> None:
    probabilities = np.full((SAMPLES, 5, 10, 4), 0.25)
    rows = {row.metric: row.value for row in score(asked, random_voxels(asked), probabilities)}
    assert rows["inception_score"] == pytest.approx(1)


class Still:
    """A model whose goals are the last pose, ten times."""

    card = ModelCard("still", "Still", "goals", "h36m17", 10, 1, 30.0)

    def forecast(self, scene: Scene, *, samples: int = 10, seed: int = 0) -> GoalPoses:
        people = len(scene.people)
        return GoalPoses(
            np.repeat(scene.positions[-1:], samples, 0), scene, scene.people, self.card,
            np.full((samples, people), 1 / samples), {}, scene.positions[-1, :, 0], np.tile([1.0, 0.0], (people, 1)),
            np.zeros(17, bool), np.zeros(people, bool),
        )  # fmt: skip


def test_a_model_is_asked_every_question_in_its_place(asked: Questions) -> None:
    poses = answers(Still(), asked)
    assert poses.shape == (SAMPLES, 5, 10, 17, 3)
    np.testing.assert_allclose(poses[:, :, 0], zero_velocity(asked)[:, :, 0], atol=1e-5)
    rows = score(asked, poses)
    result = result_of(Still.card, asked, rows)
    assert result.ratio.value == pytest.approx(1, abs=1e-4)
    assert (result.benchmark, result.windows, result.takes) == ("cmu-goals", 5 * SAMPLES, SAMPLES // 2)
    assert result.setting["skeleton"] == PROTOCOL.skeleton == H36M17.label


def test_the_protocol_changes_with_its_questions(asked: Questions) -> None:
    assert asked.protocol_hash() == asked_of(samples(), {}).protocol_hash()
    assert asked.protocol_hash() != asked_of(samples(0.1), {}).protocol_hash()
