"""The body: it stands on the joints, keeps its shape and never flips."""

from __future__ import annotations

import numpy as np
import pytest

from motioncast.bodies.openbody import bend, load_body, surface
from motioncast.core.rotation import conjugate, from_axis_angle, multiply, rotate
from motioncast.core.skeleton import Skeleton
from motioncast.core.skeletons import MRT15, SMPL22, SOMOF13
from motioncast.errors import SkeletonError

PLACES = {
    "pelvis": "pelvis", "lower_spine": "spine_01", "middle_spine": "spine_02", "upper_spine": "spine_03",
    "neck": "neck_01", "upper_neck": "head", "head": "head",
    **{
        f"{side}_{place}": f"{bone}_{side[0]}"
        for side in ("left", "right")
        for place, bone in {
            "hip": "thigh", "knee": "calf", "ankle": "foot", "foot": "ball", "toe": "ball",
            "collar": "clavicle", "shoulder": "upperarm", "elbow": "lowerarm", "wrist": "hand",
        }.items()
    },
}  # fmt: skip


def standing(skeleton: Skeleton, frames: int = 1, people: int = 1) -> np.ndarray:
    """The body at rest as joints of a skeleton, soles on the floor."""
    body = load_body()
    points = np.array([body.head(PLACES[place]) for place in skeleton.landmarks])
    points[:, 2] -= body.vertices[:, 2].min()
    return np.tile(points, (frames, people, 1, 1))


def angle(rotation: np.ndarray) -> np.ndarray:
    return 2 * np.arccos(np.clip(np.abs(rotation[..., 0]), 0, 1))


def walking(skeleton: Skeleton, frames: int = 60) -> np.ndarray:
    """A body at rest that walks ahead, swings arms and bends knees and elbows."""
    points = standing(skeleton, frames)
    phase = np.linspace(0, 4 * np.pi, frames)
    swing = {"left_hip": 1.0, "right_hip": -1.0, "left_shoulder": -1.0, "right_shoulder": 1.0}
    for place, sign in swing.items():
        side, _, top = place.partition("_")
        chain = ["knee", "ankle", "foot", "toe"] if top == "hip" else ["elbow", "wrist"]
        for hinge, below, most, bias in (
            (place, chain, 0.5 * sign, 0.0),
            (f"{side}_{chain[0]}", chain[1:], 0.4 if top == "hip" else -0.4, 0.5 if top == "hip" else -0.5),
        ):
            start = points[:, :, skeleton.landmarks.index(hinge)]
            turn = from_axis_angle(np.stack([bias + most * np.sin(phase), 0 * phase, 0 * phase], -1))[:, None]
            for joint in below:
                if (index := skeleton.find(f"{side}_{joint}")) is not None:
                    points[:, :, index] = start + rotate(turn, points[:, :, index] - start)
    points[..., 1] -= np.linspace(0, 1.5, frames)[:, None, None]
    return points


@pytest.mark.parametrize("skeleton", [MRT15, SMPL22, SOMOF13], ids=lambda skeleton: skeleton.label)
def test_the_rest_pose_is_no_turn_at_all(skeleton: Skeleton) -> None:
    body, bent = load_body(), bend(standing(skeleton), skeleton)
    limbs = ("thigh", "calf", "upperarm", "lowerarm")
    exact = [body.bones.index(f"{bone}_{side}") for bone in limbs for side in "lr"]
    assert np.degrees(angle(bent.rotations)).max() < 15  # the torso of 13 joints is a guess
    assert np.degrees(angle(bent.rotations[:, :, exact])).max() < 6
    away = surface(bent)[0, 0] - (body.vertices - [0, 0, body.vertices[:, 2].min()])
    assert np.linalg.norm(away, axis=-1).mean() < 0.02


@pytest.mark.parametrize("skeleton", [MRT15, SMPL22, SOMOF13], ids=lambda skeleton: skeleton.label)
def test_limbs_start_at_their_joints_and_reach_the_next(skeleton: Skeleton) -> None:
    body, points = load_body(), walking(skeleton)
    bent = bend(points, skeleton)
    for side in ("left", "right"):
        for top, tip, bone in (
            ("hip", "knee", "thigh"), ("knee", "ankle", "calf"),
            ("shoulder", "elbow", "upperarm"), ("elbow", "wrist", "lowerarm"),
        ):  # fmt: skip
            index = body.bones.index(f"{bone}_{side[0]}")
            start, end = (points[:, :, skeleton.landmarks.index(f"{side}_{place}")] for place in (top, tip))
            np.testing.assert_allclose(bent.heads[:, :, index], start, atol=1e-5)
            rest = body.head(PLACES[f"{side}_{tip}"]) - body.heads[index]
            turn = bent.rotations[:, :, index].astype(float)
            reached = start + rotate(turn, rest * bent.scales[0, index, 0])
            np.testing.assert_allclose(reached, end, atol=1e-4)


@pytest.mark.parametrize("skeleton", [MRT15, SMPL22], ids=lambda skeleton: skeleton.label)
def test_no_bone_flips(skeleton: Skeleton) -> None:
    bent = bend(walking(skeleton), skeleton)
    steps = multiply(bent.rotations[1:], conjugate(bent.rotations[:-1]))
    assert np.degrees(angle(steps)).max() < 45


def test_knees_and_elbows_bend_the_right_way() -> None:
    body, bent = load_body(), bend(walking(SMPL22), SMPL22)
    for bone in ("thigh_l", "thigh_r", "calf_l", "calf_r"):
        left = rotate(bent.rotations[:, :, body.bones.index(bone)].astype(float), np.array([1.0, 0, 0]))
        assert left[..., 0].min() > 0.9


def test_it_turns_and_moves_with_the_person() -> None:
    points = walking(SMPL22)
    turn = from_axis_angle(np.array([0, 0, 1.1]))
    shift = np.array([3.0, -2.0, 0.0])
    moved = rotate(turn, points) + shift
    expected = rotate(turn, surface(bend(points, SMPL22)).astype(float)) + shift
    np.testing.assert_allclose(surface(bend(moved, SMPL22)), expected, atol=1e-4)


def test_a_larger_person_gets_a_larger_body() -> None:
    points = walking(SMPL22)
    small, large = (np.ptp(surface(bend(points * size, SMPL22))[0, 0, :, 2]) for size in (1.0, 1.2))
    assert large / small == pytest.approx(1.2, abs=0.02)


def test_feet_on_the_ground_are_flat_and_point_ahead() -> None:
    body = load_body()
    for skeleton in (MRT15, SMPL22):
        bent = bend(standing(skeleton, frames=5), skeleton)
        for side in "lr":
            turn = bent.rotations[:, :, body.bones.index(f"ball_{side}")].astype(float)
            ahead = rotate(turn, np.array([0, -1.0, 0]))
            assert ahead[..., 1].max() < -0.95
            assert np.abs(ahead[..., 2]).max() < 0.05


def test_a_body_without_arms_is_refused_by_name() -> None:
    legs = Skeleton(("a", "b"), (-1, 0), ("left_hip", "left_knee"))
    with pytest.raises(SkeletonError, match="left_elbow"):
        bend(np.zeros((1, 1, 2, 3)), legs)


def test_people_do_not_influence_one_another() -> None:
    one, two = walking(MRT15), walking(MRT15)[::-1] * 1.1
    both = bend(np.concatenate([one, two], 1), MRT15)
    for column, alone in enumerate((one, two)):
        np.testing.assert_allclose(both.rotations[:, column], bend(alone, MRT15).rotations[:, 0], atol=1e-6)


def test_the_mesh_is_whole() -> None:
    body = load_body()
    assert body.faces.max() == len(body.vertices) - 1
    np.testing.assert_allclose(body.weights.sum(1), 1, atol=1e-6)
    assert (body.parents < np.arange(len(body.bones))).all()
    edges = np.sort(np.concatenate([body.faces[:, [0, 1]], body.faces[:, [1, 2]], body.faces[:, [2, 0]]]), 1)
    _, counts = np.unique(edges, axis=0, return_counts=True)
    assert (counts == 2).all()
