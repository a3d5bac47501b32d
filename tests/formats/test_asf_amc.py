from __future__ import annotations

from contextlib import suppress
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from motioncast.errors import FormatError, MotioncastError
from motioncast.formats.asf_amc import bone_ends, parse_amc, parse_asf, read_asf_amc

ASF = """:version 1.10
:name toy
:units
  mass 1.0
  length 0.45
  angle deg
:root
   order TX TY TZ RX RY RZ
   axis XYZ
   position 0 0 0
   orientation 0 0 0
:bonedata
  begin
     id 1
     name thigh
     direction 0 -1 0
     length 4.5
     axis 0 0 0  XYZ
    dof rx ry rz
    limits (-160.0 20.0)
           (-70.0 70.0)
           (-60.0 70.0)
  end
  begin
     id 2
     name shin
     direction 0 -1 0
     length 9
     axis 90 0 0 XYZ
    dof rx
  end
:hierarchy
  begin
    root thigh
    thigh shin
  end
"""

AMC = """#!OML:ASF toy
:FULLY-SPECIFIED
:DEGREES
1
root 0 10 0 0 0 0
thigh 0 0 0
shin 0
2
root 0 10 0 0 0 90
thigh 0 0 0
shin 90
"""

METRES = 0.0254 / 0.45


def positions(asf: str = ASF, amc: str = AMC) -> np.ndarray:
    skeleton = parse_asf(asf, "toy.asf")
    return bone_ends(skeleton, parse_amc(amc, skeleton, "toy.amc")) / METRES


def test_rest_pose_hangs_down() -> None:
    np.testing.assert_allclose(positions()[0], [[0, 10, 0], [0, 5.5, 0], [0, -3.5, 0]], atol=1e-12)


def test_root_turn_carries_the_leg_and_the_shin_bends_in_its_own_frame() -> None:
    # the root turns the leg from down to along +x; a bend of 90 degrees about the shin's x axis, which the
    # turned world axis is too, swings it towards -z
    np.testing.assert_allclose(positions()[1], [[0, 10, 0], [4.5, 10, 0], [4.5, 10, -9]], atol=1e-12)


def test_order_of_freedoms_is_the_order_of_the_turns() -> None:
    both = AMC.replace("thigh 0 0 0\nshin 90", "thigh 90 0 90\nshin 0")
    x_first = positions(amc=both)[1]
    z_first = positions(ASF.replace("dof rx ry rz", "dof rz ry rx"), both)[1]
    assert np.abs(x_first - z_first).max() > 1


def test_axis_order_is_read() -> None:
    one = positions(ASF.replace("axis 90 0 0 XYZ", "axis 90 90 0 XYZ"))
    other = positions(ASF.replace("axis 90 0 0 XYZ", "axis 90 90 0 ZYX"))
    assert np.abs(one - other).max() > 1


def test_radians_and_root_order() -> None:
    radians = ASF.replace("angle deg", "angle rad").replace("order TX TY TZ RX RY RZ", "order RX RY RZ TX TY TZ")
    amc = AMC.replace("root 0 10 0 0 0 90", f"root 0 0 {np.pi / 2} 0 10 0").replace("shin 90", f"shin {np.pi / 2}")
    amc = amc.replace("root 0 10 0 0 0 0", "root 0 0 0 0 10 0")
    np.testing.assert_allclose(positions(radians, amc), positions(), atol=1e-9)


def test_line_reader_agrees_with_column_reader() -> None:
    shuffled = AMC.replace("thigh 0 0 0\nshin 90", "shin 90\nthigh 0 0 0")
    np.testing.assert_array_equal(positions(amc=shuffled), positions())
    np.testing.assert_array_equal(positions(amc=AMC.replace("\n", "\r\n")), positions())
    np.testing.assert_array_equal(positions(amc=AMC.replace("\n2\n", "\n\n2\n") + "\n\n"), positions())


def test_what_stands_for_a_frame_number_is_looked_at() -> None:
    third = AMC[AMC.index("2\n") :].replace("2\n", "third\n", 1)
    with pytest.raises(FormatError, match='bone "third" is not in the skeleton'):
        positions(amc=AMC + third)


@pytest.mark.parametrize(
    ("old", "new", "line", "words"),
    [
        ("shin 90", "shin ninety", 11, "number"),
        ("shin 90", "shin 90 3", 11, "2 values"),
        ("shin 90", "foot 90", 11, "not in the skeleton"),
        ("shin 90", "shin nan", 11, "finite"),
        ("shin 90", "thigh 0 0 0", 11, "twice"),
        ("shin 90\n", "", 10, "cut off"),
        ("root 0 10 0 0 0 0\n", "", 7, 'without a "root" line'),
        ("\n1\n", "\nroot\n1\n", 4, "before the first frame number"),
        (AMC[AMC.index("1\n") :], "", None, "no frames"),
    ],
)
def test_damaged_motion_names_the_line(old: str, new: str, line: int | None, words: str) -> None:
    with pytest.raises(FormatError, match=words) as caught:
        positions(amc=AMC.replace(old, new))
    assert caught.value.line == line


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("length 0.45", "length 0", "positive"),
        ("axis 90 0 0 XYZ", "axis 90 0 0 XYX", "order"),
        ("thigh shin", "shin thigh", "before it has a parent"),
        ("thigh shin", "thigh shin foot", "no bone data"),
        ("dof rx\n", "dof rq\n", "degrees of freedom"),
        (":hierarchy", ":nothing", "hierarchy"),
        ("    thigh shin\n", "", 'bone "shin" is not in the hierarchy'),
        ("root thigh", "root thigh shin", 'bone "shin" has two parents'),
        ("name shin", "name thigh", 'bone "thigh" comes twice'),
        ("name shin", "name", "number of values"),
        ("name shin", "", "ends without name"),
        ("dof rx\n  end", "dof rx", 'no "end"'),
    ],
)
def test_damaged_skeleton(old: str, new: str, words: str) -> None:
    with pytest.raises(FormatError, match=words):
        positions(asf=ASF.replace(old, new))


@given(st.integers(0, len(AMC) - 1), st.text(max_size=3), st.integers(0, 30))
def test_any_damage_gives_one_clear_error(place: int, put: str, cut: int) -> None:
    error = None
    try:
        positions(amc=AMC[:place] + put + AMC[place + cut :])
    except MotioncastError as caught:
        error = caught
    assert "\n" not in str(error)


@given(st.integers(0, len(ASF) - 1), st.text(max_size=3), st.integers(0, 60))
def test_any_damage_of_the_skeleton_gives_one_clear_error(place: int, put: str, cut: int) -> None:
    with suppress(MotioncastError):
        parse_asf(ASF[:place] + put + ASF[place + cut :], "toy.asf")


def test_scene_is_z_up_and_says_that_the_rate_is_assumed(tmp_path: Path) -> None:
    (tmp_path / "toy.asf").write_text(ASF, encoding="utf-8")
    (tmp_path / "toy_01.amc").write_text(AMC, encoding="utf-8")
    scene = read_asf_amc(tmp_path / "toy.asf", tmp_path / "toy_01.amc")
    np.testing.assert_allclose(scene.positions[0, 0, 0], [0, 0, 10 * METRES], atol=1e-6)
    assert scene.fps == 120
    assert "120" in scene.remarks[0]


@pytest.mark.data
def test_agrees_with_an_independent_reader(shared: Path) -> None:
    from motioncast.datasets import cmu

    reference = np.load(shared / "cmu" / "reference_positions.npz")
    names = list(reference["takes"])
    takes = [take for take in cmu.takes(shared / "cmu") if take.name in names]
    assert len(takes) == len(names)
    for take in takes:
        skeleton, values = cmu.acclaim(take)
        ends = bone_ends(skeleton, values)[reference[f"{take.name}_frames"]]
        order = [skeleton.names.index(name) for name in reference["joint_names"]]
        np.testing.assert_allclose(ends[:, order], reference[f"{take.name}_pos"], atol=1e-6)
