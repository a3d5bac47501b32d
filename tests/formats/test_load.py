"""One door for every file."""

from __future__ import annotations

import numpy as np
import pytest

from motioncast.core.scene import Scene
from motioncast.core.skeletons import MRT15
from motioncast.errors import FormatError, InputError, OutputError, SceneError
from motioncast.formats import units
from motioncast.formats.load import load_scene, read_map, save_scene


@pytest.mark.parametrize("suffix", [".npz", ".csv", ".trc", ".bvh"])
def test_what_is_saved_is_loaded(tmp_path, walkers, suffix):
    back = load_scene(*save_scene(walkers, tmp_path / f"a{suffix}"))
    joints = [back.skeleton.index(name) for name in MRT15.names]
    np.testing.assert_allclose(back.positions[:, :, joints], walkers.positions, atol=1e-5)
    assert len(back.people) == 2


def test_the_content_tells_where_the_suffix_does_not(tmp_path, walkers):
    save_scene(walkers, tmp_path / "a.csv")
    (tmp_path / "a.csv").rename(tmp_path / "a.txt")
    assert load_scene(tmp_path / "a.txt").people == walkers.people
    (tmp_path / "b.txt").write_text("hello", encoding="utf-8")
    with pytest.raises(InputError, match=r"no known format.*\.bvh"):
        load_scene(tmp_path / "b.txt")
    (tmp_path / "b.txt").rename(tmp_path / "b.bvh")
    with pytest.raises(FormatError, match="is it a BVH file"):
        load_scene(tmp_path / "b.bvh")


def test_what_cannot_be_loaded(tmp_path, walkers):
    (path,) = save_scene(walkers, tmp_path / "a.npz")
    with pytest.raises(InputError, match="given twice"):
        load_scene(path, tmp_path / ".." / tmp_path.name / "a.npz")
    with pytest.raises(InputError, match="there is no file"):
        load_scene(tmp_path / "no.bvh")
    with pytest.raises(InputError, match="no motion file"):
        load_scene()
    (tmp_path / "a.asf").write_text("", encoding="utf-8")
    with pytest.raises(InputError, match="skeleton without motion"):
        load_scene(tmp_path / "a.asf")
    (tmp_path / "sub").mkdir()
    (tmp_path / "sub" / "01_02.amc").write_text("1\n", encoding="utf-8")
    with pytest.raises(InputError, match=r"no skeleton file 01\.asf"):
        load_scene(tmp_path / "sub" / "01_02.amc")
    with pytest.raises(OutputError, match="suffix"):
        save_scene(walkers, tmp_path / "a.fbx")


def test_absurd_numbers_are_a_sentence(tmp_path, walkers):
    far = Scene(walkers.positions + np.float32(1e6), MRT15, 30)
    with pytest.raises(SceneError, match="from the origin"):
        load_scene(*save_scene(far, tmp_path / "far.npz"))
    big = Scene(walkers.positions * 100, MRT15, 30)
    with pytest.raises(SceneError, match=r"1\d\d m tall.*--unit"):
        load_scene(*save_scene(big, tmp_path / "big.npz"))


@pytest.mark.parametrize("unit", list(units.UNITS_M))
@pytest.mark.parametrize("up", ["z", "y", "-y"])
def test_unit_and_axis_follow_from_the_body(walkers, unit, up):
    turn = units.axis_turn(up)
    points = walkers.positions @ turn / units.UNITS_M[unit]
    world = units.settle("a", points, walkers.observed, MRT15, up=None, unit=None, usual_up="x")
    np.testing.assert_allclose(world.points(points), walkers.positions, atol=1e-4)
    assert f"unit {unit} " in world.remarks[0]
    assert world.remarks[0].endswith("override with --unit and --up")


@pytest.mark.parametrize("up", ["x", "y", "z", "-x", "-y", "-z"])
def test_turns_are_rotations_that_raise_their_axis(up):
    turn = units.axis_turn(up)
    assert np.linalg.det(turn) == pytest.approx(1)
    axis = np.eye(3)["xyz".index(up[-1])] * (-1 if up[0] == "-" else 1)
    np.testing.assert_array_equal(turn @ axis, [0, 0, 1])


def test_no_unit_makes_a_person(walkers):
    with pytest.raises(SceneError, match="no person's stature"):
        units.settle("a", walkers.positions * 1e6, walkers.observed, MRT15, up=None, unit=None, usual_up="z")


def test_maps(tmp_path):
    path = tmp_path / "map.txt"
    path.write_text("# mine\nHip = pelvis # the root\n\nTail=\n", encoding="utf-8")
    assert read_map(path) == {"Hip": "pelvis", "Tail": ""}
    path.write_text("Hip pelvis\n", encoding="utf-8")
    with pytest.raises(FormatError, match=r"map.txt:1.*joint = landmark"):
        read_map(path)
    path.write_text("a = pelvis\na = neck\n", encoding="utf-8")
    with pytest.raises(FormatError, match="comes twice"):
        read_map(path)
