"""Scenes: what they refuse, and what slicing, selecting, mapping and joining keep."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from motioncast.core.scene import Scene, join
from motioncast.core.skeleton import Skeleton
from motioncast.core.skeletons import COCO17, MRT15, SOMOF13
from motioncast.errors import SceneError, SkeletonError
from motioncast.testing import walkers

ZERO = np.zeros((4, 2, 15, 3))


def turned(scene: Scene) -> Scene:
    """The scene with rotations and offsets, all different."""
    random = np.random.default_rng(0)
    shape = scene.positions.shape
    return replace(
        scene,
        rotations=random.normal(size=(*shape[:3], 4)).astype(np.float32),
        offsets=random.normal(size=shape[1:]).astype(np.float32),
    )


@pytest.mark.parametrize("shape", [(4, 2, 15), (4, 2, 14, 3), (4, 2, 15, 2), (2, 15, 3), (1, 4, 2, 15, 3)])
def test_positions_of_another_shape_are_refused(shape):
    with pytest.raises(SceneError, match=r"positions have shape .*15 joints"):
        Scene(np.zeros(shape), MRT15, 30)


@pytest.mark.parametrize("fps", [0, -30, float("nan"), float("inf")])
def test_impossible_rates_are_refused(fps):
    with pytest.raises(SceneError, match="frame rate"):
        Scene(ZERO, MRT15, fps)


@pytest.mark.parametrize("people", [("a",), ("a", "a"), ("a", "b", "c")])
def test_every_person_needs_an_id(people):
    with pytest.raises(SceneError, match="give each its own"):
        Scene(ZERO, MRT15, 30, people=people)


@pytest.mark.parametrize(
    ("field", "shape"),
    [("observed", (4, 2)), ("observed", (4, 15, 2)), ("rotations", (4, 2, 15, 3)), ("rotations", (3, 2, 15, 4)),
     ("offsets", (2, 15, 4)), ("offsets", (15, 3))],
)  # fmt: skip
def test_companions_of_another_shape_are_refused(field, shape):
    with pytest.raises(SceneError, match=r"shape .*; expected \("):
        Scene(ZERO, MRT15, 30, **{field: np.zeros(shape)})


@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf, 1e300])
def test_observed_positions_must_be_finite(value):
    positions = ZERO.copy()
    positions[3, 1, 7, 2] = value
    with pytest.raises(SceneError, match=r'"neck" of person 2 in frame 3'):
        Scene(positions, MRT15, 30)


def test_what_was_not_observed_is_zero_whatever_stood_there():
    positions = ZERO + 1
    positions[1, 0, 2] = np.nan
    observed = np.ones((4, 2, 15), bool)
    observed[1, 0, 2] = observed[2, 1, 0] = False
    scene = Scene(positions, MRT15, 30, observed)
    assert not scene.positions[1, 0, 2].any()
    assert not scene.positions[2, 1, 0].any()
    assert scene.positions.sum() == 3 * observed.sum()


def test_construction_leaves_the_callers_array_alone_and_makes_float32():
    positions = ZERO + 1
    observed = np.zeros((4, 2, 15), bool)
    scene = Scene(positions, MRT15, 30, observed)
    assert positions.all()
    assert scene.positions.dtype == np.float32
    assert type(scene.fps) is float
    with pytest.raises(AttributeError):
        scene.fps = 60  # pyright: ignore[reportAttributeAccessIssue]


def test_an_empty_scene_is_a_scene():
    nobody = Scene(np.zeros((4, 0, 15, 3)), MRT15, 30)
    assert nobody.people == ()
    assert nobody.duration_s == pytest.approx(4 / 30)


def test_slices_cut_everything_that_has_time():
    scene = turned(walkers(people=2, frames=10))
    part = scene[-3:]
    assert (part.frames, part.people, part.fps) == (3, scene.people, scene.fps)
    np.testing.assert_array_equal(part.positions, scene.positions[7:])
    np.testing.assert_array_equal(part.rotations, scene.rotations[7:])
    np.testing.assert_array_equal(part.offsets, scene.offsets)


def test_select_takes_people_in_the_given_order():
    scene = turned(walkers(people=3, frames=4))
    two = scene.select(["person 3", "person 1"])
    assert two.people == ("person 3", "person 1")
    for name in ("positions", "observed", "rotations"):
        np.testing.assert_array_equal(getattr(two, name), getattr(scene, name)[:, [2, 0]])
    np.testing.assert_array_equal(two.offsets, scene.offsets[[2, 0]])
    assert scene.select([]).positions.shape == (4, 0, 15, 3)


def test_select_names_who_is_there():
    with pytest.raises(SceneError, match=r'no person "eve"; the scene has person 1, person 2'):
        walkers(people=2, frames=4).select(["person 1", "eve"])


def test_on_another_skeleton_joints_keep_their_places():
    scene = turned(walkers(people=2, frames=4))
    other = scene.on(SOMOF13)
    for landmark in SOMOF13.landmarks:
        here, there = SOMOF13.find(landmark), MRT15.find(landmark)
        np.testing.assert_array_equal(other.positions[:, :, here], scene.positions[:, :, there])
    assert other.rotations is None
    assert other.offsets is None
    assert other.people == scene.people


def test_a_joint_between_others_is_their_middle_and_seen_where_all_are():
    random = np.random.default_rng(0)
    observed = np.ones((2, 1, 17), bool)
    observed[1, 0, COCO17.index("left_hip")] = False
    scene = Scene(random.normal(size=(2, 1, 17, 3)), COCO17, 30, observed)
    body = scene.on(MRT15)
    hips = [COCO17.index("left_hip"), COCO17.index("right_hip")]
    np.testing.assert_allclose(body.positions[0, 0, 0], scene.positions[0, 0, hips].mean(0), rtol=1e-6)
    assert body.observed[:, 0, 0].tolist() == [True, False]
    assert not body.positions[1, 0, 0].any()


def test_on_a_skeleton_with_other_places_fails():
    with pytest.raises(SkeletonError, match="no joint for head"):
        Scene(np.zeros((2, 1, 13, 3)), SOMOF13, 30).on(MRT15)


def test_joined_takes_share_a_clock_and_shorter_ones_end_early():
    long, short = walkers(people=1, frames=9, seed=1), walkers(people=2, frames=5, seed=2)
    scene = join([replace(long, people=("ada",), remarks=("same",)), replace(short, remarks=("same", "other"))])
    assert scene.positions.shape == (9, 3, 15, 3)
    assert scene.people == ("ada", "person 1", "person 2")
    np.testing.assert_array_equal(scene.positions[:5, 1:], short.positions)
    assert scene.observed[:5].all()
    assert not scene.observed[5:, 1:].any()
    assert scene.observed[:, 0].all()
    assert scene.remarks == ("same", "other")


def test_joined_namesakes_get_numbers():
    one = walkers(people=1, frames=3)
    assert join([one, one, replace(one, people=("eve",))]).people == ("person 1 (1)", "person 1 (2)", "eve")


def test_joined_rotations_are_kept_only_where_all_have_them():
    one, two = turned(walkers(people=1, frames=6)), turned(walkers(people=1, frames=4))
    both = join([one, two])
    assert both.rotations is not None
    np.testing.assert_array_equal(both.rotations[:4, 1], two.rotations[:, 0])
    np.testing.assert_array_equal(both.offsets[1], two.offsets[0])
    assert join([one, walkers(people=1, frames=4)]).rotations is None


def test_takes_that_do_not_fit_together_are_refused():
    one = walkers(people=1, frames=3)
    with pytest.raises(SceneError, match="give at least one file"):
        join([])
    with pytest.raises(SceneError, match=r"15 frames a second .* 30; .*--fps"):
        join([one, replace(one, fps=30)])
    with pytest.raises(SceneError, match="different joints or trees"):
        join([one, one.on(SOMOF13)])
    flat = Skeleton(MRT15.names, (-1,) * 15, MRT15.landmarks, "flat")  # the same names, another tree
    with pytest.raises(SceneError, match="different joints or trees"):
        join([one, replace(one, skeleton=flat)])
