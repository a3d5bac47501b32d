"""BVH in all its spellings: channel orders, counts, End Sites, several roots, and the file that is written."""

from __future__ import annotations

from dataclasses import replace
from itertools import permutations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from motioncast.core.kinematics import fit_rotations
from motioncast.errors import FormatError, OutputError, SceneError
from motioncast.formats import bvh
from motioncast.testing import walkers

ORDERS = ["".join(axes) for axes in permutations("XYZ")]


def leg(order: str = "ZXY", places: str = "XYZ", ends: str = "0 -8 12", angles=(0.0,) * 12, at=(0.0, 95.0, 0.0)) -> str:
    """A pelvis with one leg; one frame of four joints' angles in degrees."""
    turns = " ".join(f"{axis}rotation" for axis in order)
    rows, names, depth = [], ["Hips", "LeftUpLeg", "LeftLeg", "LeftFoot"], 0
    for name, offset in zip(names, ["0 0 0", "9 -4 0", "0 -42 1", "0 -41 0"], strict=True):
        tab = "  " * depth
        channels = f"{' '.join(f'{axis}position' for axis in places)} {turns}" if depth == 0 else turns
        rows += [f"{tab}{'JOINT' if depth else 'ROOT'} {name}", f"{tab}{{", f"{tab}  OFFSET {offset}",
                 f"{tab}  CHANNELS {len(channels.split())} {channels}"]  # fmt: skip
        depth += 1
    rows += ["End Site", "{", f"OFFSET {ends}", "}"] + ["}"] * depth
    root = " ".join(str(at["XYZ".index(axis)]) for axis in places)
    return "\n".join(["HIERARCHY", *rows, "MOTION", "Frames: 1", "Frame Time: 0.02",
                      f"{root} {' '.join(map(repr, map(float, angles)))}", ""])  # fmt: skip


def read(tmp_path, text, **options):
    path = tmp_path / "leg.bvh"
    path.write_text(text, encoding="utf-8")
    return bvh.read(path, **{"up": "y", "unit": "cm", **options})


@pytest.mark.parametrize("order", ORDERS)
@given(angles=st.lists(st.floats(-180, 180, width=32), min_size=12, max_size=12))
def test_every_order_of_rotations_against_scipy(tmp_path_factory, order, angles):
    scene = read(tmp_path_factory.mktemp("bvh"), leg(order, angles=angles))
    world, at = Rotation.identity(), np.array([0.0, 95.0, 0.0])
    for joint, offset in enumerate([(9, -4, 0), (0, -42, 1), (0, -41, 0), (0, -8, 12)]):
        world = world * Rotation.from_euler(order, angles[3 * joint : 3 * joint + 3], degrees=True)
        at = at + world.apply(offset)
        x, y, z = scene.positions[0, 0, joint + 1]
        np.testing.assert_allclose([x, z, -y], at / 100, atol=1e-5)


@pytest.mark.parametrize("places", ["XYZ", "ZYX", "YZX"])
def test_every_order_of_positions(tmp_path, places):
    scene = read(tmp_path, leg(places=places, at=(10.0, 95.0, 30.0)))
    np.testing.assert_allclose(scene.positions[0, 0, 0], [0.1, -0.3, 0.95], atol=1e-6)


def test_missing_position_channels_leave_the_offset(tmp_path):
    scene = read(tmp_path, leg(places="Y", at=(1.0, 95.0, 1.0)))
    np.testing.assert_allclose(scene.positions[0, 0, 0], [0, 0, 0.95], atol=1e-6)


def test_end_sites_become_joints_unless_they_lie_in_their_parent(tmp_path):
    assert read(tmp_path, leg()).skeleton.names[-1] == "LeftFoot_end"
    assert read(tmp_path, leg(ends="0 0 0")).skeleton.names[-1] == "LeftFoot"


def test_the_name_of_an_end_site_never_collides(tmp_path):
    text = leg().replace("JOINT LeftLeg", "JOINT LeftFoot_end")
    assert read(tmp_path, text).skeleton.names == ("Hips", "LeftUpLeg", "LeftFoot_end", "LeftFoot", "LeftFoot_end_end")


def test_names_with_blanks_and_braces_on_the_same_line(tmp_path):
    text = leg().replace("JOINT LeftLeg\n    {", "JOINT Left Leg {").replace("\n", "\n\n\t ")
    assert "Left Leg" in text
    assert read(tmp_path, text).skeleton.names[2] == "Left Leg"


def test_written_files_are_y_up_in_centimetres(tmp_path):
    scene = fit_rotations(walkers(people=1, frames=3))
    (target,) = bvh.write(scene, tmp_path / "out.bvh")
    text = target.read_text(encoding="utf-8")
    first = [float(word) for word in text.split("Frame Time:")[1].split("\n")[1].split()]
    x, y, z = scene.positions[0, 0, 0] * 100
    np.testing.assert_allclose(first[:3], [x, z, -y], atol=1e-4)
    assert "Xposition Yposition Zposition Zrotation Xrotation Yrotation" in text
    assert "Frames: 3" in text
    assert b"\r" not in target.read_bytes()


def test_a_written_file_is_read_without_being_told_its_unit(tmp_path):
    scene = fit_rotations(walkers(people=1, frames=8))
    (target,) = bvh.write(scene, tmp_path / "out.bvh")
    back = bvh.read(target)
    joints = [back.skeleton.index(name) for name in scene.skeleton.names]
    np.testing.assert_allclose(back.positions[:, :, joints], scene.positions, atol=1e-4)
    assert back.rotations is not None or any("change their length" in remark for remark in back.remarks)
    assert back.fps == pytest.approx(scene.fps)


@pytest.mark.parametrize("fps", [1, 12, 15, 24, 25, 29.97, 30, 59.94, 60, 100, 119.88, 120, 240, 1000])
def test_rates_survive_a_round_trip(tmp_path, fps):
    scene = replace(fit_rotations(walkers(people=1, frames=2)), fps=fps)
    (target,) = bvh.write(scene, tmp_path / "out.bvh")
    assert bvh.read(target).fps == pytest.approx(fps, rel=1e-6)


def test_gaps_hold_the_last_pose_and_the_clock_stays(tmp_path):
    scene = fit_rotations(walkers(people=2, frames=10))
    observed = scene.observed.copy()
    observed[:2, 0] = observed[5, 0] = observed[8:, 0] = False
    paths = bvh.write(replace(scene, observed=observed), tmp_path / "out.bvh")
    back = bvh.read(paths[0])
    assert back.frames == 8
    root = back.positions[:, 0, 0]
    np.testing.assert_array_equal(root[:2], root[[2, 2]])
    np.testing.assert_array_equal(root[5], root[4])
    assert bvh.read(paths[1]).frames == 10


def test_scenes_that_cannot_be_written(tmp_path):
    scene = walkers(people=1, frames=3)
    with pytest.raises(SceneError, match="joint positions only"):
        bvh.write(scene, tmp_path / "out.bvh")
    unseen = replace(fit_rotations(scene), observed=np.zeros(scene.observed.shape, bool))
    with pytest.raises(SceneError, match="never seen"):
        bvh.write(unseen, tmp_path / "out.bvh")
    with pytest.raises(OutputError, match="no folder"):
        bvh.write(fit_rotations(scene), tmp_path / "no" / "out.bvh")
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("old", "new", "line", "complaint"),
    [
        ("ROOT Hips", "JOINT Hips", 2, "outside of a joint"),
        ("  JOINT LeftUpLeg", "ROOT LeftUpLeg", 6, "inside a joint"),
        ("JOINT LeftLeg", "JOINT", 10, "has no name"),
        ("  OFFSET 9 -4 0\n", "", 6, "has no OFFSET"),
        ("OFFSET 0 -8 12", "OFFSET 0 -8 1e999", 20, "1e999"),
        ("OFFSET 0 -8 12", "OFFSET 0 -8 12\nCHANNELS 3 Xrotation Yrotation Zrotation", 21, "in an End Site"),
        ("OFFSET 0 -8 12", "JOINT Toe\n{\n", 20, "no children"),
        ("OFFSET 0 -8 12", "COLOUR 0 -8 12", 20, "was expected"),
        ("Frames: 1", "Frames: one", 27, "Frames: N"),
        ("Frames: 1", "Frames: 0", 27, "0 frames"),
        ("Frame Time: 0.02", "Frame Time: nan", 28, "nan"),
        ("Frame Time: 0.02", "Frame Time: 1e-9", 28, "frame time"),
        ("0.0 95.0 0.0 ", "0.0 95.0 1_0.0 ", 29, "1_0"),
        ("0.0 95.0 0.0 ", "0.0 95.0 ٣ ", 29, "٣"),
    ],
)
def test_errors_name_the_line(tmp_path, old, new, line, complaint):
    text = leg()
    assert old in text
    with pytest.raises(FormatError, match=complaint) as caught:
        read(tmp_path, text.replace(old, new, 1))
    assert caught.value.line == line
    assert str(caught.value).startswith(f"{tmp_path / 'leg.bvh'}:{line}: ")


def test_ten_thousand_nested_joints_are_refused_and_not_recursed_into(tmp_path):
    deep = "".join(f"JOINT j{i}\n{{\nOFFSET 0 1 0\nCHANNELS 0\n" for i in range(10_000))
    with pytest.raises(FormatError, match="more than 2000 joints"):
        read(tmp_path, f"HIERARCHY\nROOT r\n{{\nOFFSET 0 0 0\nCHANNELS 0\n{deep}")


@pytest.mark.parametrize("fps", [0, -30, float("nan")])
def test_an_impossible_rate_of_the_users_is_not_passed_over(tmp_path, fps):
    with pytest.raises(SceneError, match="frame rate"):
        read(tmp_path, leg(), fps=fps)


def test_the_thorax_remark_is_for_cgspeeds_files_only(tmp_path):
    assert read(tmp_path, leg()).remarks == ()
