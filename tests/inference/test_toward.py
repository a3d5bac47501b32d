"""Futures that end in a goal: it is reached, seen from the hips; standing feet stay; the first frame follows on."""

from __future__ import annotations

import numpy as np
import pytest

from motioncast.core.basis_points import hip_frame
from motioncast.core.card import ModelCard
from motioncast.core.goal_poses import GoalPoses
from motioncast.core.scene import Scene
from motioncast.core.voxels import turned_back
from motioncast.inference.registry import load
from motioncast.inference.toward import into_goals, toward
from motioncast.testing import walkers

CARD = ModelCard("toy-goals", "toy", "goals", "mrt15", history=10, horizon=1, fps=30.0)


def standing() -> Scene:
    scene = walkers(people=1, frames=60, fps=30)
    return Scene(np.repeat(scene.positions[-1:], 60, 0), scene.skeleton, 30, people=scene.people)


def goals_of(scene: Scene, arm: float = 0.0, leg: float = 0.0) -> GoalPoses:
    """Two goals: right arm and leg swung by angles in radians, twice as likely as staying."""
    now = scene.positions[-1].copy()
    swung = now.copy()
    for angle, limb in ((arm, ("shoulder", "elbow", "wrist")), (leg, ("hip", "knee", "ankle"))):
        first, *others = (scene.skeleton.index(f"right_{place}") for place in limb)
        cosine, sine = np.cos(angle), np.sin(angle)
        matrix = np.array([[1, 0, 0], [0, cosine, -sine], [0, sine, cosine]], np.float32)
        for joint in others:
            swung[:, joint] = now[:, first] + (now[:, joint] - now[:, first]) @ matrix.T
    people = len(scene.people)
    return GoalPoses(
        np.stack([swung, now]), scene, scene.people, CARD, np.tile([[2 / 3], [1 / 3]], people), {},
        now[:, 0], np.tile([[1.0, 0.0]], (people, 1)), np.zeros(len(scene.skeleton), bool), np.zeros(people, bool),
    )  # fmt: skip


def from_the_hips(scene: Scene, pose: np.ndarray) -> np.ndarray:
    origin, across = hip_frame(pose, scene.skeleton)
    return turned_back(pose - origin[..., None, :], across[..., None, :])


@pytest.mark.parametrize("name", ["zero-velocity", "root-velocity-damped", "somoformer-fast"])
def test_the_hand_is_where_the_goal_has_it(name: str) -> None:
    scene = walkers(people=2, frames=60, fps=30)
    goals = goals_of(scene, arm=1.2)
    answer = toward(load(name), goals, horizon_s=1.5)
    wrist = scene.skeleton.index("right_wrist")
    reached, wanted = (from_the_hips(scene, pose)[:, wrist] for pose in (answer.samples[0, -1], goals.poses[0]))
    assert np.linalg.norm(reached - wanted, axis=-1).max() < 0.02
    np.testing.assert_allclose(answer.weights, [0.8, 0.2], atol=1e-6)  # of two people who choose alone
    assert np.linalg.norm(answer.samples[0, 0] - scene.positions[-1], axis=-1).max() < 0.1
    assert any("toy-goals" in sentence for sentence in answer.warnings)


def test_who_reaches_on_the_spot_keeps_both_feet_there() -> None:
    scene = standing()
    answer = into_goals(goals_of(scene, arm=1.2))
    for side in ("left", "right"):
        ankle = scene.skeleton.index(f"{side}_ankle")
        moved = np.linalg.norm(answer.samples[:, :, 0, ankle] - scene.positions[-1, 0, ankle], axis=-1)
        assert moved.max() < 0.005


def test_a_foot_that_has_to_go_elsewhere_is_lifted() -> None:
    scene = standing()
    goals = goals_of(scene, leg=0.5)
    path = into_goals(goals).samples[0, :, 0, scene.skeleton.index("right_ankle")]
    start = scene.positions[-1, 0, scene.skeleton.index("right_ankle")]
    assert path[:, 2].max() > start[2] + 0.04
    assert np.linalg.norm(path[-1, :2] - start[:2]) > 0.2


def test_bones_keep_their_length_on_the_way() -> None:
    scene = standing()
    skeleton = scene.skeleton
    answer = into_goals(goals_of(scene, arm=1.5, leg=0.1))
    for joint, parent in skeleton.bones:
        if skeleton.names[joint].endswith(("knee", "ankle", "elbow", "wrist")):
            length = np.linalg.norm(answer.samples[..., joint, :] - answer.samples[..., parent, :], axis=-1)
            now = np.linalg.norm(scene.positions[-1, 0, joint] - scene.positions[-1, 0, parent])
            np.testing.assert_allclose(length, now, atol=2e-3)
