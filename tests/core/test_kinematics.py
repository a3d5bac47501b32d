from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from motioncast.core import rotation
from motioncast.core.card import ModelCard
from motioncast.core.forecast import Forecast
from motioncast.core.kinematics import SLIDE_M, fit_rotations, forward, local_places, sliding, world_rotations
from motioncast.core.rest import T_POSE
from motioncast.core.scene import Scene
from motioncast.core.skeleton import Skeleton
from motioncast.core.skeletons import MRT15, SMPL22, SOMOF13, recognise

CARD = ModelCard("guess", "guess", "forecast", "mrt15", 5, 5, 30.0)


def rest_offsets(skeleton: Skeleton) -> np.ndarray:
    places = np.array([T_POSE[landmark] for landmark in skeleton.landmarks])
    parents = np.array(skeleton.parents)
    return np.where(parents[:, None] >= 0, places - places[parents], 0)


def turning(seed: int, skeleton: Skeleton, frames: int = 40, people: int = 2, reach: float = 1.0) -> Scene:
    """A scene of smooth random rotations: all that a rigid skeleton can do."""
    random = np.random.default_rng(seed)
    time = np.linspace(0, 1, frames)[:, None, None, None]
    shape = (1, people, len(skeleton), 3)
    waves = sum(
        random.normal(size=shape) / (1 + wave) * np.sin(wave * 3 * time + random.uniform(0, 6, shape))
        for wave in range(3)
    )
    ends = ~np.isin(np.arange(len(skeleton)), skeleton.parents)
    rotations = rotation.from_axis_angle(np.where(ends[:, None], 0, reach * waves))
    sizes = random.uniform(0.9, 1.1, people)
    offsets = rest_offsets(skeleton) * sizes[:, None, None]
    roots = np.cumsum(random.normal(0, 0.02, (frames, people, 3)), 0)
    positions = forward(rotations, roots, offsets, skeleton.parents)
    return Scene(positions, skeleton, 30.0, rotations=rotations, offsets=offsets)


def bare(scene: Scene) -> Scene:
    return Scene(scene.positions, scene.skeleton, scene.fps, scene.observed, scene.people)


def again(scene: Scene) -> np.ndarray:
    """Positions from rotations and rest offsets alone: no joint may slide."""
    return forward(scene.rotations, scene.positions[:, :, 0], scene.offsets, scene.skeleton.parents)


def distance(fitted: Scene, scene: Scene) -> float:
    joints = [fitted.skeleton.index(name) for name in scene.skeleton.names]
    apart = np.linalg.norm(fitted.positions[:, :, joints] - scene.positions, axis=-1)
    return float(apart[scene.observed].max())


def angle(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    return np.linalg.norm(rotation.to_axis_angle(rotation.multiply(a, rotation.conjugate(b))), axis=-1)


def test_forward_agrees_with_a_naive_walk_over_matrices():
    scene = turning(0, SMPL22, frames=3)
    for frame in range(3):
        turns = [Rotation.from_quat(np.roll(q, -1)).as_matrix() for q in scene.rotations[frame, 1]]
        world, places = [], []
        for joint, parent in enumerate(SMPL22.parents):
            above = np.eye(3) if parent < 0 else world[parent]
            bone = above @ scene.offsets[1, joint]
            places.append(scene.positions[frame, 1, 0] if parent < 0 else places[parent] + bone)
            world.append(above @ turns[joint])
        np.testing.assert_allclose(scene.positions[frame, 1], places, atol=1e-6)


@given(st.integers(0, 10_000), st.sampled_from([MRT15, SMPL22]), st.floats(0.1, 2.0))
@settings(max_examples=10)
def test_a_rigid_body_comes_back_without_pivots_or_sliding(seed, skeleton, reach):
    scene = bare(turning(seed, skeleton, reach=reach))
    fitted = fit_rotations(scene)
    assert fitted.skeleton == skeleton
    np.testing.assert_allclose(again(fitted), scene.positions, atol=1e-5)
    np.testing.assert_allclose(np.linalg.norm(fitted.rotations, axis=-1), 1, atol=1e-5)
    assert not sliding(fitted, local_places(fitted)).any()


@given(st.integers(0, 10_000), st.booleans())
@settings(max_examples=10)
def test_the_seam_has_no_step_and_lengths_go_on(seed, known):
    whole = turning(seed, SMPL22, reach=0.7)
    history = whole[:25] if known else fit_rotations(bare(whole)[:25])
    future = fit_rotations(bare(whole)[25:], history if known else bare(whole)[:25])
    np.testing.assert_allclose(again(future), whole.positions[25:], atol=1e-5)
    np.testing.assert_allclose(future.offsets, history.offsets, atol=1e-6)
    before, after = history.rotations[-1].astype(float), future.rotations[0].astype(float)
    assert (before * after).sum(-1).min() > 0  # the quaternions' signs go on too
    moved = angle(whole.rotations[25], whole.rotations[24]).max()
    # errors of one joint's twist are made good by its child, hence the factor
    assert angle(after, before).max() < 4 * moved + 0.02


def test_a_joint_of_several_children_gets_the_very_rotation_of_the_history():
    whole = turning(3, SMPL22)
    future = fit_rotations(bare(whole)[20:], whole[:20])
    assert angle(future.rotations[:, :, 0], whole.rotations[20:, :, 0]).max() < 1e-3


def arm(directions: np.ndarray, fps: float = 30.0, **known) -> Scene:
    skeleton = Skeleton(("shoulder", "elbow"), (-1, 0), ("left_shoulder", "left_elbow"))
    positions = np.zeros((len(directions), 1, 2, 3))
    positions[:, 0, 1] = 0.3 * directions / np.linalg.norm(directions, axis=-1, keepdims=True)
    return Scene(positions, skeleton, fps, **known)


def test_twist_is_carried_from_the_history():
    twist = rotation.from_axis_angle(np.array([1.1, 0, 0]))  # the arm's rest axis is x
    swing = rotation.between(np.array([1.0, 0, 0]), np.array([1.0, 0.3, 0]))
    turns = np.tile(rotation.IDENTITY, (1, 1, 2, 1))
    turns[0, 0, 0] = rotation.multiply(swing, twist)
    offsets = np.array([[[0, 0, 0], [0.3, 0, 0]]])
    history = arm(np.array([[1, 0.3, 0]]), rotations=turns, offsets=offsets)
    sway = 0.3 + 0.2 * np.sin(np.arange(60) / 5)
    future = fit_rotations(arm(np.stack([np.ones(60), sway, 0 * sway], -1)), history)
    shortest = rotation.between(np.array([1.0, 0, 0]), future.positions[:, 0, 1])
    left = rotation.multiply(rotation.conjugate(shortest), future.rotations[:, 0, 0])
    np.testing.assert_allclose(rotation.to_axis_angle(left), np.tile([1.1, 0, 0], (60, 1)), atol=1e-3)


def test_no_flip_where_the_bone_passes_by_the_opposite_of_its_rest_axis():
    past = np.stack([-np.ones(61), np.linspace(-1, 1, 61), np.full(61, 0.01)], -1)
    fitted = fit_rotations(arm(past))
    cosine = (fitted.positions[1:, 0, 1] * fitted.positions[:-1, 0, 1]).sum(-1) / 0.09
    swing = np.arccos(np.clip(cosine, -1, 1))
    turn = angle(fitted.rotations[1:, 0, 0], fitted.rotations[:-1, 0, 0])
    assert (turn < swing + np.pi / 30 + 0.01).all()  # at most what the fading twist adds
    shortest = rotation.between(np.array([1.0, 0, 0]), fitted.positions[:, 0, 1])
    assert angle(shortest[1:], shortest[:-1]).max() > 1  # the naive answer does flip


def test_circling_leaves_no_twist_behind():
    turns = np.linspace(0, 20 * 2 * np.pi, 1201)
    fitted = fit_rotations(arm(np.stack([np.ones(1201), np.cos(turns), np.sin(turns)], -1)))
    shortest = rotation.between(np.array([1.0, 0, 0]), fitted.positions[:, 0, 1])
    # plain parallel transport would be 20 times 105 degrees off by now
    assert angle(fitted.rotations[:, 0, 0], shortest).max() < np.pi / 2 + 0.3
    assert angle(fitted.rotations[-60:, 0, 0], shortest[-60:]).std() < 0.1


def test_the_spine_turns_with_the_pelvis():
    """Someone who turns on the spot must not wring his spine."""
    still = turning(1, SMPL22, frames=61, people=1, reach=0.0)
    yaw = rotation.from_axis_angle(np.linspace(0, 1, 61)[:, None] * [0, 0, 2 * np.pi])
    turned = rotation.rotate(yaw[:, None, None], still.positions.astype(float))
    fitted = fit_rotations(Scene(turned, SMPL22, 30.0))
    joints = np.arange(len(SMPL22)) > 0
    assert angle(fitted.rotations[:, :, joints], np.array(rotation.IDENTITY)).max() < 1e-3


def torso_that_bends(frames: int = 60) -> Scene:
    """Fifteen joints without a spine: neck and shoulders come nearer to the pelvis and to one another."""
    scene = turning(5, MRT15, frames=frames, people=1, reach=0.4)
    positions = scene.positions.copy()
    phase = np.sin(np.arange(frames) / 6)[:, None]
    side, _, up = (rotation.rotate(scene.rotations[:, 0, 0], axis) for axis in np.eye(3))
    upper = [joint for joint, name in enumerate(MRT15.names) if "hip" not in name and joint > 6]
    positions[:, 0, upper] += (0.04 * phase * up)[:, None]
    left = [joint for joint in upper if MRT15.names[joint] in ("left_shoulder", "left_elbow", "left_wrist")]
    positions[:, 0, left] += (0.03 * phase * side)[:, None]
    return Scene(positions, MRT15, 30.0)


@pytest.mark.parametrize("skeleton", [MRT15, SOMOF13])
def test_a_torso_that_is_not_rigid_stays_within_a_centimetre(skeleton):
    scene = torso_that_bends().on(skeleton)
    fitted = fit_rotations(scene)
    places = local_places(fitted)
    roots = fitted.positions[:, :, 0]
    exact = forward(fitted.rotations, roots, places, fitted.skeleton.parents)
    np.testing.assert_allclose(exact, fitted.positions, atol=1e-5)
    assert distance(fitted, scene) <= SLIDE_M + 1e-5
    slides = {fitted.skeleton.names[joint] for joint in np.flatnonzero(sliding(fitted, places))}
    assert "neck" in slides
    assert not slides & {"left_knee", "right_knee", "left_wrist"}


def test_a_known_body_keeps_its_joints_when_the_forecast_bends_it():
    scene = torso_that_bends()
    history = turning(5, MRT15, frames=60, people=1, reach=0.4)[:1]
    fitted = fit_rotations(scene[1:], history)
    assert fitted.skeleton == MRT15
    assert distance(fitted, scene[1:]) <= SLIDE_M + 1e-5


def test_people_who_come_and_go_hold_their_pose():
    scene = bare(turning(8, SMPL22))
    observed = scene.observed.copy()
    observed[:10, 0] = observed[30:, 0] = False
    observed[:, 1, SMPL22.index("left_wrist")] = False
    gappy = Scene(scene.positions, SMPL22, 30.0, observed)
    fitted = fit_rotations(gappy)
    assert np.isfinite(fitted.rotations).all()
    assert distance(fitted, gappy) < 1e-5
    turns = fitted.rotations[:, 0]
    np.testing.assert_array_equal(turns[:10], np.tile(turns[10], (10, 1, 1)))
    np.testing.assert_array_equal(turns[30:], np.tile(turns[29], (10, 1, 1)))


def test_someone_never_seen_and_someone_for_one_frame():
    scene = bare(turning(9, SMPL22, frames=5))
    observed = np.zeros_like(scene.observed)
    observed[2, 1] = True
    fitted = fit_rotations(Scene(scene.positions, SMPL22, 30.0, observed))
    assert np.isfinite(fitted.rotations).all()
    assert np.isfinite(local_places(fitted)).all()
    np.testing.assert_allclose(fitted.positions[2, 1], scene.positions[2, 1], atol=1e-5)


def test_the_rest_pose_stands_with_arms_out():
    fitted = fit_rotations(bare(turning(2, SMPL22, people=1)))
    still = np.tile(rotation.IDENTITY, (1, 1, 22, 1))
    rest = forward(still, np.zeros((1, 1, 3)), fitted.offsets, SMPL22.parents)[0, 0]
    place = {name: rest[SMPL22.index(name)] for name in SMPL22.names}
    assert place["left_ankle"][2] < place["left_knee"][2] < place["left_hip"][2] < place["neck"][2]
    assert place["left_wrist"][0] > place["left_elbow"][0] > 0.3 > -0.3 > place["right_elbow"][0]
    assert abs(place["left_wrist"][2] - place["left_shoulder"][2]) < 0.1


@given(st.integers(0, 10_000), st.integers(2, 6))
def test_kabsch_agrees_with_scipy(seed, count):
    random = np.random.default_rng(seed)
    rest, bones = random.normal(size=(2, 3, count, 3))
    ours = rotation.kabsch(rest, bones)
    for one in range(3):
        theirs = np.roll(Rotation.align_vectors(bones[one], rest[one])[0].as_quat(), 1)
        assert abs(abs(ours[one] @ theirs) - 1) < 1e-9


def test_world_rotations_chain():
    scene = turning(4, SMPL22, frames=2)
    world = world_rotations(scene.rotations, SMPL22.parents)
    knee, hip = SMPL22.index("left_knee"), SMPL22.index("left_hip")
    local = rotation.multiply(rotation.conjugate(world[:, :, hip]), world[:, :, knee])
    np.testing.assert_allclose(np.abs((local * scene.rotations[:, :, knee]).sum(-1)), 1)


@pytest.mark.parametrize("known", [True, False])
def test_history_and_forecast_join_to_one_scene(known):
    whole = turning(6, MRT15, reach=0.5)
    history = whole[:25] if known else bare(whole)[:25]
    answer = Forecast(whole.positions[None, 25:], history, history.people, CARD)
    joined = answer.continued()
    np.testing.assert_allclose(joined.positions, whole.positions, atol=1e-5)
    assert (joined.rotations is not None) == known
    if known:
        np.testing.assert_array_equal(joined.rotations[:25], history.rotations)
        np.testing.assert_allclose(again(joined), whole.positions, atol=1e-5)


@pytest.mark.data
def test_real_takes(shared):
    with np.load(shared / "extra" / "extra_cmu_bvh.npz") as data:
        skeleton = recognise([str(name) for name in data["joint_names"]], data["parents"].tolist(), "cmu31")
        roots, bones = data["49_02_root"][::6, None], data["49_02_rel"][::6] * 5e-5
    positions = np.concatenate([roots, roots + bones], 1)[:, None]
    for scene in (Scene(positions, skeleton, 20.0), Scene(positions, skeleton, 20.0).on(MRT15)):
        fitted = fit_rotations(scene)
        assert distance(fitted, scene) < SLIDE_M + 1e-4
        future = fit_rotations(scene[200:], scene[:200])
        assert distance(future, scene[200:]) < SLIDE_M + 1e-4
    whole = fit_rotations(Scene(positions, skeleton, 20.0))
    assert not sliding(whole, local_places(whole)).any()  # every bone of CMU's keeps its length
