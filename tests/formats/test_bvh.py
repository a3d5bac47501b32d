"""BVH: strict, with line numbers; round trips."""

from __future__ import annotations

from contextlib import suppress

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from motioncast.core.kinematics import fit_rotations
from motioncast.errors import FormatError, MotioncastError, SceneError
from motioncast.formats import bvh

TEXT = """HIERARCHY
ROOT Hips
{
  OFFSET 0 0 0
  CHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation
  JOINT LeftUpLeg
  {
    OFFSET 10 -5 0
    CHANNELS 3 Xrotation Zrotation Yrotation
    JOINT LeftLeg
    {
      OFFSET 0 -42 0
      CHANNELS 6 Yrotation Xrotation Zrotation Zposition Yposition Xposition
      JOINT LeftFoot
      {
        OFFSET 0 -41 0
        CHANNELS 3 Zrotation Yrotation Xrotation
        End Site
        {
          OFFSET 0 -5 12
        }
      }
    }
  }
  JOINT Neck
  {
    OFFSET 0 47 0
    CHANNELS 0
    End Site
    {
      OFFSET 0 0 0
    }
  }
}
MOTION
Frames: 2
Frame Time: 0.0333333
1 95 2 0 0 0 0 0 0 0 0 0 0 -42 0 0 0 0
2 95 3 30 20 10 5 6 7 8 9 1 0 -42 0 3 2 1
"""


def saved(tmp_path, text=TEXT):
    path = tmp_path / "ann.bvh"
    path.write_text(text, encoding="utf-8", newline="")
    return path


def test_any_channel_order_against_scipy(tmp_path):
    scene = bvh.read(saved(tmp_path), up="y", unit="cm")
    assert scene.fps == 30
    assert scene.people == ("ann",)
    assert scene.skeleton.names == ("Hips", "LeftUpLeg", "LeftLeg", "LeftFoot", "LeftFoot_end", "Neck")
    hips = Rotation.from_euler("ZXY", [30, 20, 10], degrees=True)
    thigh = hips * Rotation.from_euler("XZY", [5, 6, 7], degrees=True)
    shin = thigh * Rotation.from_euler("YXZ", [8, 9, 1], degrees=True)
    foot = shin * Rotation.from_euler("ZYX", [3, 2, 1], degrees=True)
    at = np.array([2.0, 95, 3])
    expected = [at, at + hips.apply([10, -5, 0])]
    expected.append(expected[-1] + thigh.apply([0, -42, 0]))
    expected.append(expected[-1] + shin.apply([0, -41, 0]))
    expected.append(expected[-1] + foot.apply([0, -5, 12]))
    expected.append(at + hips.apply([0, 47, 0]))
    x, y, z = np.array(expected).T / 100
    np.testing.assert_allclose(scene.positions[1, 0], np.stack([x, -z, y], -1), atol=1e-6)


def test_unit_and_axis_are_inferred_said_and_overridden(tmp_path):
    path = saved(tmp_path)
    scene = bvh.read(path)
    assert "unit cm" in scene.remarks[0]
    assert "up axis y" in scene.remarks[0]
    assert scene.positions[0, 0, 0, 2] == pytest.approx(0.95)
    assert bvh.read(path, fps=25).fps == 25
    with pytest.raises(SceneError, match=r"body would be 17\d m tall.*--unit"):
        bvh.read(path, unit="m")


@pytest.mark.parametrize(
    ("old", "new", "line", "message"),
    [
        ("HIERARCHY", "HIERARCY", 1, "is it a BVH file"),
        ("OFFSET 10 -5 0", "OFFSET 10 -5", 8, "OFFSET has 2 values"),
        ("OFFSET 10 -5 0", "OFFSET 10 nan 0", 8, '"nan"'),
        ("CHANNELS 3 Xrotation Zrotation Yrotation", "CHANNELS 4 Xrotation Zrotation Yrotation", 9, "declares 4"),
        ("CHANNELS 3 Xrotation Zrotation Yrotation", "CHANNELS 3 Xrotation Xrotation Yrotation", 9, "CHANNELS names"),
        ("JOINT LeftFoot", "JOINT LeftLeg", 14, "comes twice"),
        ("Frames: 2", "Frames: 999999999999", 36, "has 2; the file seems cut off"),
        ("Frames: 2", "Frames: 1", 36, "has 2; lines were added"),
        ("Frame Time: 0.0333333", "Frame Time: 0", 37, "frame time is 0"),
        ("1 95 2 0", "1 95 x 0", 38, '"x"'),
        ("1 95 2 0", "1 95 inf 0", 38, '"inf"'),
        ("1 95 2 0", "1 95 2,5 0", 38, '"2,5"'),
        ("8 9 1 0 -42 0 3 2 1", "8 9 1", 39, "12 values in a frame"),
        ("\n}\nMOTION", "\nMOTION", 34, 'has no "}"'),
    ],
)
def test_errors_name_the_line(tmp_path, old, new, line, message):
    assert TEXT.count(old) >= 1
    with pytest.raises(FormatError, match=message) as caught:
        bvh.read(saved(tmp_path, TEXT.replace(old, new, 1)))
    assert caught.value.line == line


def test_line_ends_do_not_matter(tmp_path):
    unix = bvh.read(saved(tmp_path))
    windows = bvh.read(saved(tmp_path, TEXT.replace("\n", "\r\n")))
    np.testing.assert_array_equal(unix.positions, windows.positions)


@pytest.mark.parametrize(
    ("text", "fps"),
    [("0.0333333", 30), ("0.033333", 30), ("0.00833333", 120), ("0.0166667", 60), ("0.04", 25),
     ("0.033367", 30000 / 1001), ("0.0125", 80)],
)  # fmt: skip
def test_frame_times_are_rates(tmp_path, text, fps):
    assert bvh.read(saved(tmp_path, TEXT.replace("0.0333333", text))).fps == pytest.approx(fps, rel=1e-9)


def test_round_trip(tmp_path, walkers):
    scene = fit_rotations(walkers)
    targets = bvh.write(scene, tmp_path / "out.bvh")
    assert [target.name for target in targets] == ["out_ada.bvh", "out_bea.bvh"]
    for person, target in enumerate(targets):
        back = bvh.read(target, up="y", unit="cm")
        joints = [back.skeleton.index(name) for name in scene.skeleton.names]
        np.testing.assert_allclose(back.positions[:, 0, joints], scene.positions[:, person], atol=2e-6)
        assert back.fps == 30


def test_a_read_file_is_written_as_it_was(tmp_path):
    still = TEXT.replace("-42 0 3 2 1", "-42 0 3 2 1")
    scene = bvh.read(saved(tmp_path, still), up="y", unit="cm")
    assert scene.rotations is not None
    (target,) = bvh.write(scene, tmp_path / "b.bvh")
    back = bvh.read(target, up="y", unit="cm")
    assert back.skeleton.names == scene.skeleton.names
    np.testing.assert_allclose(back.positions, scene.positions, atol=1e-6)
    np.testing.assert_allclose(back.offsets, scene.offsets, atol=1e-6)
    assert target.read_text(encoding="utf-8").count("End Site") == 2


def test_sliding_bones_are_said(tmp_path):
    scene = bvh.read(saved(tmp_path, TEXT.replace("8 9 1 0 -42 0 3 2 1", "8 9 1 0 -45 0 3 2 1")))
    assert scene.rotations is None
    assert any("change their length" in remark for remark in scene.remarks)


@given(st.integers(0, 10_000), st.binary(min_size=0, max_size=3), st.booleans())
def test_damage_is_always_a_sentence(tmp_path_factory, place, junk, cut):
    content = TEXT.encode()
    place %= len(content)
    path = tmp_path_factory.mktemp("bvh") / "a.bvh"
    path.write_bytes(content[:place] if cut else content[:place] + junk + content[place + 1 :])
    with suppress(MotioncastError):
        bvh.read(path)
