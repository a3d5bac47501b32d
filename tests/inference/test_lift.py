from __future__ import annotations

import numpy as np

from motioncast.core import rotation
from motioncast.core.resample import bridge
from motioncast.core.scene import Scene
from motioncast.core.skeleton import Skeleton
from motioncast.core.skeletons import MRT15
from motioncast.inference.lift import Lift, between_frames, keep_lengths, last_pose, lower, rigid_bones
from motioncast.testing import walkers

FULLER = Skeleton(
    (*MRT15.names, "left_hand", "right_toe"),
    (*MRT15.parents, MRT15.index("left_wrist"), MRT15.index("right_ankle")),
    (*MRT15.landmarks, "left_hand", "right_toe"),
    "fuller",
)


def fuller(scene: Scene) -> np.ndarray:
    """The last pose with a hand and a toe put on."""
    last = scene.positions[-1].astype(np.float64)
    hand = last[:, [MRT15.index("left_wrist")]] + [0.02, 0.0, -0.09]
    toe = last[:, [MRT15.index("right_ankle")]] + [0.0, -0.15, -0.05]
    return np.concatenate([last, hand, toe], 1)


def test_a_turned_body_carries_hand_and_toe() -> None:
    last = fuller(walkers(people=2))
    turn = rotation.from_axis_angle(np.array([0.3, -0.2, 1.0]))
    moved = rotation.rotate(turn, last) + np.array([1.0, 2.0, 0.0])
    lift = Lift.between(MRT15, FULLER)
    np.testing.assert_allclose(lift(moved[None, :, :15], last)[0], moved, atol=1e-6)
    assert [FULLER.names[joint] for joint in np.flatnonzero(lift.carried)] == ["left_hand", "right_toe"]


def test_the_same_pose_stays_and_a_straight_arm_does_not_spin() -> None:
    scene = walkers(people=1)
    last = fuller(scene)
    shoulder, elbow, wrist = (MRT15.index(f"left_{place}") for place in ("shoulder", "elbow", "wrist"))
    for share, joint in ((0.5, elbow), (1.0, wrist)):
        last[:, joint] = last[:, shoulder] + share * np.array([0.0, 0.0, -0.5])
    last[:, 15] = last[:, wrist] + [0.05, 0.0, -0.08]
    noise = np.random.default_rng(0).normal(0, 1e-4, (20, 1, 15, 3))
    lifted = Lift.between(MRT15, FULLER)(last[None, :, :15] + noise, last)
    assert np.abs(lifted[:, 0, 15] - last[0, 15]).max() < 0.01


def test_limbs_are_rigid_and_kept() -> None:
    scene = walkers()
    lengths = rigid_bones(scene)
    knee = MRT15.index("left_knee")
    assert not np.isnan(lengths[:, knee]).any()
    shrunk = scene.positions[-5:].astype(np.float64) * 0.9
    kept = keep_lengths(shrunk, MRT15, lengths)
    apart = np.linalg.norm(kept[:, :, knee] - kept[:, :, MRT15.parents[knee]], axis=-1)
    np.testing.assert_allclose(apart, np.broadcast_to(lengths[:, knee], apart.shape), rtol=1e-5)


def test_a_stretching_bone_is_not_called_rigid() -> None:
    positions = walkers().positions.copy()
    positions[:, :, 8, 2] += np.linspace(0, 0.1, len(positions), dtype=np.float32)[:, None]
    assert np.isnan(rigid_bones(Scene(positions, MRT15, 15))[:, 8]).all()


def test_the_answer_passes_through_the_models_frames() -> None:
    line = np.linspace(0, 1, 20)[:, None]
    fast = between_frames(line, now=9, step=15 / 60, frames=40)
    np.testing.assert_allclose(fast[3::4], line[10:], atol=1e-9)
    assert np.diff(fast[:, 0]).min() > 0


def test_a_short_history_is_not_observed_before_it_begins() -> None:
    past = lower(walkers(frames=6), MRT15, 15, 15)
    assert past.frames == 15
    assert not past.observed[:9].any()
    assert past.observed[9:].all()


def test_the_last_pose_is_the_end_of_the_bridged_history() -> None:
    scene = walkers(people=3)
    seen = np.random.default_rng(0).random(scene.observed.shape) < 0.2
    seen[:, 1, 4] = False
    gappy = Scene(scene.positions, MRT15, 15, seen)
    np.testing.assert_allclose(last_pose(gappy), bridge(gappy.positions, gappy.observed)[-1], atol=1e-6)


def test_a_hand_is_carried_as_a_fit_of_its_own_would() -> None:
    """A naive twin: one joint, one person and one frame at a time, with singular values."""
    scene = walkers(people=2)
    last, answer = fuller(scene), scene.positions[:4, :, :, :].astype(np.float64)
    lift = Lift.between(MRT15, FULLER)
    lifted = lift(answer, last)
    torso = [MRT15.index(name) for name in MRT15.names if name.endswith(("pelvis", "hip", "neck", "shoulder"))]
    for joint in np.flatnonzero(lift.carried):
        carriers = lift.carriers[joint]
        for frame, person in np.ndindex(4, 2):
            pose, rest = answer[frame, person], last[person]
            turn = rotation.kabsch(rest[torso] - rest[torso].mean(0), pose[torso] - pose[torso].mean(0))
            before = (rest[carriers] - rest[carriers[0]]) / np.arange(1, 4)[:, None]
            after = (pose[carriers] - pose[carriers[0]]) / np.arange(1, 4)[:, None]
            axes = np.eye(3) * np.sqrt(0.02 * np.square(before).sum())
            turn = rotation.kabsch(np.vstack([before, axes]), np.vstack([after, rotation.rotate(turn, axes)]))
            expected = pose[carriers[0]] + rotation.rotate(turn, rest[joint] - rest[carriers[0]])
            np.testing.assert_allclose(lifted[frame, person, joint], expected, atol=1e-6)
