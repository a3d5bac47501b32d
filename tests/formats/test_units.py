"""Unit and up axis: inferred from bodies of any pose, and never against the user's word."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from motioncast.core import rotation
from motioncast.core.scene import Scene
from motioncast.core.skeleton import Skeleton
from motioncast.core.skeletons import COCO17, MRT15, SOMOF13
from motioncast.errors import InputError, SceneError
from motioncast.formats import units
from motioncast.testing import walkers
from motioncast.testing.scenes import standing_pose

AXES = ["x", "y", "z", "-x", "-y", "-z"]


def in_file(positions: np.ndarray, up: str, unit: str) -> np.ndarray:
    """Positions in metres with z up as a file with another axis and unit would hold them."""
    return positions @ units.axis_turn(up) / units.UNITS_M[unit]


def settled(positions, *, up=None, unit=None, usual_up="y", rest=None, skeleton=MRT15, observed=None) -> units.World:
    observed = np.ones(positions.shape[:3], bool) if observed is None else observed
    return units.settle("take.bvh", positions, observed, skeleton, up=up, unit=unit, usual_up=usual_up, rest=rest)


def lying() -> np.ndarray:
    """A sleeper along x, ``(8, 1, 15, 3)`` metres, z up."""
    pose = standing_pose()
    return np.broadcast_to(np.stack([pose[:, 2], pose[:, 0], pose[:, 1] + 0.2], -1), (8, 1, 15, 3))


@pytest.mark.parametrize("unit", units.UNITS_M)
@pytest.mark.parametrize("up", ["y", "z"])
@pytest.mark.parametrize("stature", [1.5, 1.7, 1.95])
def test_adults_of_any_stature_tell_unit_and_axis(unit, up, stature):
    people = walkers(people=2, frames=20).positions * (stature / 1.7)
    world = settled(in_file(people, up, unit))
    assert world.scale == units.UNITS_M[unit]
    np.testing.assert_allclose(world.points(in_file(people, up, unit)), people, atol=1e-4)
    assert f"unit {unit} " in world.remarks[0]
    assert f"up axis {up} " in world.remarks[0]


@pytest.mark.parametrize("skeleton", [SOMOF13, MRT15], ids=lambda skeleton: skeleton.label)
def test_bodies_without_a_pelvis_tell_as_well(skeleton):
    people = walkers(people=1, frames=5).on(skeleton).positions
    world = settled(in_file(people, "y", "mm"), usual_up="z", skeleton=skeleton)
    np.testing.assert_allclose(world.points(in_file(people, "y", "mm")), people, atol=1e-4)


def test_the_bodies_of_the_image_detectors_point_down():
    """Image coordinates have y down: the head has the smaller y."""
    pose = np.zeros((3, 1, 17, 3))
    for joint, name in enumerate(COCO17.names):
        pose[:, 0, joint] = standing_pose()[MRT15.index(name if name in MRT15.names else "head")]
    world = settled(in_file(pose, "-y", "mm"), skeleton=COCO17)
    np.testing.assert_allclose(world.points(in_file(pose, "-y", "mm")), pose, atol=1e-9)


@pytest.mark.parametrize("up", ["y", "z"])
def test_the_rest_pose_helps_where_somebody_lies(up):
    rest = in_file(standing_pose(), up, "cm")
    other = "z" if up == "y" else "y"
    world = settled(in_file(lying(), up, "cm"), usual_up=other, rest=rest)
    np.testing.assert_allclose(world.points(in_file(lying(), up, "cm")), lying(), atol=1e-9)


@pytest.mark.parametrize("usual_up", ["y", "z"])
def test_the_usual_axis_serves_where_nothing_tells(usual_up):
    world = settled(lying() * 100, usual_up=usual_up)
    np.testing.assert_array_equal(world.turn, units.axis_turn(usual_up))


def test_what_the_user_says_is_not_inferred_and_not_remarked():
    people = walkers(people=1, frames=5).positions * 100
    world = settled(people, up="y", unit="cm")
    assert world.remarks == ()
    np.testing.assert_array_equal(world.turn, units.axis_turn("y"))  # though the walkers' z is up
    assert settled(people, up="z").remarks[0].startswith("take.bvh: unit cm")
    assert "unit" not in settled(people, unit="cm").remarks[0].split("override")[0]


def test_children_need_the_users_word_and_get_their_size():
    child = walkers(people=1, frames=5).positions * 0.45  # 0.77 m
    with pytest.raises(SceneError, match="give the unit by --unit"):
        settled(child)
    assert settled(child, unit="m").scale == 1


@pytest.mark.parametrize("unit", ["m", "inch", "cm", "0.1"])
def test_an_impossible_unit_is_refused_with_what_it_would_mean(unit):
    people = walkers(people=1, frames=5).positions * 1000
    with pytest.raises(SceneError, match=rf'in the unit "{unit}" the body would be .* m tall; .*--unit'):
        settled(people, unit=unit)


def test_bodies_too_far_away_are_damage():
    people = walkers(people=1, frames=5).positions.astype(float)
    people[3, 0, 0, 1] = 1e7
    with pytest.raises(SceneError, match="m from the origin"):
        settled(people)
    with pytest.raises(SceneError, match="m from the origin"):
        units.check_size(Scene(people, MRT15, 15))


@given(st.integers(0, 2**32 - 1))
def test_any_heading_and_place_tells_the_same(seed):
    random = np.random.default_rng(seed)
    people = walkers(people=1, frames=4, seed=seed % 1000)
    turn = rotation.from_axis_angle(np.array([0, 0, random.uniform(0, 6)]))
    moved = rotation.rotate(turn, people.positions) + np.array([*random.uniform(-50, 50, 2), 0])
    world = settled(in_file(moved, "y", "cm"), usual_up="z")
    np.testing.assert_allclose(world.points(in_file(moved, "y", "cm")), moved, atol=1e-6)


def test_unseen_joints_do_not_count():
    people = walkers(people=2, frames=10).positions * 100
    observed = np.ones(people.shape[:3], bool)
    observed[:, 1] = observed[:7, 0, 3] = False
    people = np.where(observed[..., None], people, 0)
    assert settled(people, observed=observed).scale == 0.01
    nobody = np.zeros(observed.shape, bool)
    assert units.stature(people, nobody, MRT15) == 0


def test_bodies_without_known_joints_are_measured_whole():
    points = np.zeros((3, 1, 4, 3))
    points[:, 0, :, 1] = [0.0, 60.0, 120.0, 180.0]
    unknown = Skeleton(("a", "b", "c", "d"), (-1, 0, 1, 2), ("",) * 4)
    assert units.stature(points, np.ones((3, 1, 4), bool), unknown) == pytest.approx(180)
    assert settled(points, skeleton=unknown).scale == 0.01


def test_stature_does_not_depend_on_the_pose():
    scene = walkers(people=1, frames=30)
    standing = units.stature(standing_pose()[None, None], np.ones((1, 1, 15), bool), MRT15)
    assert units.stature(scene.positions, scene.observed, MRT15) == pytest.approx(standing, rel=1e-3)
    assert units.stature(lying(), np.ones((8, 1, 15), bool), MRT15) == pytest.approx(standing)
    assert 1.5 < standing < 1.9


@pytest.mark.parametrize("up", AXES)
@given(seed=st.integers(0, 2**32 - 1))
def test_points_and_rotations_turn_alike(up, seed):
    random = np.random.default_rng(seed)
    world = units.World(units.axis_turn(up), 0.01)
    turn, point = rotation.normalise(random.normal(size=4)), random.normal(size=3)
    there = world.points(rotation.rotate(turn, point))
    np.testing.assert_allclose(rotation.rotate(world.rotations(turn), world.points(point)), there, atol=1e-12)


@pytest.mark.parametrize("up", AXES)
def test_axes_turn_without_mirroring(up):
    turn = units.axis_turn(up)
    np.testing.assert_allclose(turn @ turn.T, np.eye(3))
    assert np.linalg.det(turn) == pytest.approx(1)
    np.testing.assert_array_equal(units.axis_turn(f" +{up.upper()} ") if up[0] != "-" else turn, turn)


@pytest.mark.parametrize("up", ["", "w", "xy", "--y", "up", "1"])
def test_unknown_axes_are_refused(up):
    with pytest.raises(InputError, match=r"up axis .* is unknown; use one of"):
        units.axis_turn(up)


@pytest.mark.parametrize(
    ("name", "metres"),
    [("m", 1), ("Metres", 1), ("CM", 0.01), (" centimeters ", 0.01), ("mm", 0.001), ("inches", 0.0254), ("in", 0.0254),
     ("cmu", 0.0254 / 0.45), ("0.3048", 0.3048), ("1e-2", 0.01)],
)  # fmt: skip
def test_units_by_name_or_number(name, metres):
    assert units.unit_in_m(name) == pytest.approx(metres)


@pytest.mark.parametrize("unit", ["", "s", "foot", "nan", "inf", "0", "-1", "1e300", "1_0e-2m"])
def test_unknown_units_are_refused(unit):
    with pytest.raises(InputError, match=r"unit .* is unknown; use one of m, cm"):
        units.unit_in_m(unit)
