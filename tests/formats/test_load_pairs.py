"""Several files of one scene, skeleton and motion in two files, and writes that fail half-way."""

from __future__ import annotations

import errno
import os
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from motioncast.core.kinematics import fit_rotations
from motioncast.core.skeletons import MRT15
from motioncast.errors import FormatError, InputError, OutputError, SceneError, SkeletonError
from motioncast.formats import bvh
from motioncast.formats.files import atomic_write
from motioncast.formats.load import format_of, load_forecast, load_scene, read_map, save_forecast, save_scene
from motioncast.testing import walkers

ASF = """# a made-up body
:version 1.10
:name made_up
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
{bones}
:hierarchy
  begin
{tree}
  end
"""

BONES = {  # parent, direction, length: a person in CMU's unit
    "lhipjoint": ("root", "0.8 -0.6 0", 2.0), "lfemur": ("lhipjoint", "0 -1 0", 7.4),
    "ltibia": ("lfemur", "0 -1 0", 7.2),
    "rhipjoint": ("root", "-0.8 -0.6 0", 2.0), "rfemur": ("rhipjoint", "0 -1 0", 7.4),
    "rtibia": ("rfemur", "0 -1 0", 7.2), "thorax": ("root", "0 1 0", 8.0), "lowerneck": ("thorax", "0 1 0", 1.5),
    "head": ("lowerneck", "0 1 0", 3.0),
}  # fmt: skip


def acclaim(folder: Path, asf: str = "07.asf", amc: str = "07_01.amc", frames: int = 3) -> tuple[Path, Path]:
    bones = "\n".join(
        f"  begin\n    id {number}\n    name {name}\n    direction {direction}\n    length {length}\n"
        "    axis 0 0 0 XYZ\n    dof rx\n    limits (-180 180)\n  end"
        for number, (name, (_, direction, length)) in enumerate(BONES.items(), 1)
    )
    tree = "\n".join(f"    {parent} {name}" for name, (parent, _, _) in BONES.items())
    (folder / asf).write_text(ASF.format(bones=bones, tree=tree), encoding="utf-8")
    lines = ["#!OML:ASF", ":FULLY-SPECIFIED", ":DEGREES"]
    for frame in range(1, frames + 1):
        lines += [str(frame), f"root {frame} 16 0 0 0 0", *(f"{name} 0" for name in BONES)]
    (folder / amc).write_text("\n".join(lines) + "\n", encoding="utf-8")
    return folder / asf, folder / amc


def two_takes(folder: Path) -> list[Path]:
    scene = fit_rotations(walkers(people=2, frames=6, fps=30))
    return list(bvh.write(replace(scene, people=("ada", "bea")), folder / "take.bvh"))


def test_files_of_one_person_become_one_scene(tmp_path):
    paths = two_takes(tmp_path)
    scene = load_scene(*paths)
    assert scene.people == ("take_ada", "take_bea")
    expected = walkers(people=2, frames=6, fps=30)
    joints = [scene.skeleton.index(name) for name in MRT15.names]
    np.testing.assert_allclose(scene.positions[:, :, joints], expected.positions, atol=1e-4)
    assert len(scene.remarks) >= 2
    assert load_scene(*map(str, reversed(paths))).people == ("take_bea", "take_ada")


def test_files_of_different_clocks_are_refused_unless_overridden(tmp_path):
    one, two = two_takes(tmp_path)
    two.write_text(two.read_text(encoding="utf-8").replace("0.033333333333", "0.040000000000"), encoding="utf-8")
    with pytest.raises(SceneError, match=r"30 frames a second .* 25"):
        load_scene(one, two)
    assert load_scene(one, two, fps=30).fps == 30


def test_the_same_file_by_another_name_is_still_the_same(tmp_path):
    one, _ = two_takes(tmp_path)
    with pytest.raises(InputError, match="given twice"):
        load_scene(one, one.parent / "." / one.name)
    link = tmp_path / "link.bvh"
    try:
        link.symlink_to(one)
    except OSError:
        pytest.skip("no symbolic links here")
    with pytest.raises(InputError, match="given twice"):
        load_scene(one, link)


def test_the_skeleton_beside_the_motion_is_found(tmp_path):
    _, amc = acclaim(tmp_path)
    scene = load_scene(amc)
    assert scene.frames == 3
    assert scene.fps == 120
    head = scene.skeleton.find("head")
    assert head is not None
    assert scene.positions[0, 0, head, 2] == pytest.approx((16 + 12.5) * 0.0254 / 0.45, rel=1e-4)
    assert load_scene(amc, fps=60).fps == 60


def test_the_right_skeleton_of_several_is_taken(tmp_path):
    acclaim(tmp_path, "08.asf", "08_01.amc")
    (tmp_path / "07.asf").write_text("damaged", encoding="utf-8")
    assert load_scene(tmp_path / "08_01.amc").frames == 3
    (tmp_path / "07_01.amc").write_bytes((tmp_path / "08_01.amc").read_bytes())
    with pytest.raises(FormatError, match=r"07\.asf"):
        load_scene(tmp_path / "07_01.amc")
    (tmp_path / "09_01.amc").write_bytes((tmp_path / "08_01.amc").read_bytes())
    with pytest.raises(InputError, match=r"no skeleton file 09\.asf"):
        load_scene(tmp_path / "09_01.amc")
    assert load_scene(tmp_path / "08.asf", tmp_path / "09_01.amc").frames == 3


def test_a_pair_and_its_motion_alone_give_the_same(tmp_path):
    asf, amc = acclaim(tmp_path)
    np.testing.assert_array_equal(load_scene(asf, amc).positions, load_scene(amc).positions)


@pytest.mark.parametrize("option", [{"up": "z"}, {"unit": "m"}, {"named": {"head": "head"}}])
def test_options_that_do_not_fit_acclaim_are_refused(tmp_path, option):
    _, amc = acclaim(tmp_path)
    with pytest.raises(InputError, match="leave --"):
        load_scene(amc, **option)


def test_a_skeleton_without_its_motion_is_refused(tmp_path):
    asf, _ = acclaim(tmp_path)
    with pytest.raises(InputError, match="without motion"):
        load_scene(asf)
    with pytest.raises(InputError, match="without motion"):
        load_scene(asf, *two_takes(tmp_path))
    with pytest.raises(InputError, match="there is no file"):
        load_scene(tmp_path / "no_01.amc")


def test_suffixes_in_capitals(tmp_path):
    one, _ = two_takes(tmp_path)
    loud = one.rename(tmp_path / "LOUD.BVH")
    assert load_scene(loud).people == ("LOUD",)
    assert format_of(loud) is bvh
    _, amc = acclaim(tmp_path, "07.ASF", "07_01.AMC")
    assert load_scene(amc).frames == 3


@pytest.mark.parametrize(("joint", "other"), [("left_hip", "right_hip"), ("right_hip", "left_hip")])
def test_a_map_wins_over_the_landmarks_of_a_scene_file(tmp_path, joint, other):
    save_scene(walkers(people=1, frames=3), tmp_path / "a.npz")
    skeleton = load_scene(tmp_path / "a.npz", named={joint: other}).skeleton
    assert skeleton.find(other) == skeleton.index(joint)
    assert skeleton.find(joint) is None
    assert skeleton.find("neck") == skeleton.index("neck")
    with pytest.raises(InputError, match='"tail"'):
        load_scene(tmp_path / "a.npz", named={"tail": "neck"})


def test_a_map_names_unknown_joints(tmp_path):
    one, _ = two_takes(tmp_path)
    text = one.read_text(encoding="utf-8").replace("left_knee", "hinge")
    one.write_text(text, encoding="utf-8")
    assert load_scene(one).skeleton.find("left_knee") is None
    (tmp_path / "map.txt").write_text("hinge = left_knee\n", encoding="utf-8")
    named = read_map(tmp_path / "map.txt")
    assert load_scene(one, named=named).skeleton.find("left_knee") is not None
    with pytest.raises(SkeletonError, match='"tail", which is not in'):
        load_scene(one, named={"tail": "head"})


@pytest.mark.parametrize(
    ("text", "line"), [("a = b\nc\n", 2), ("= pelvis\n", 1), ("# fine\n\n\nx: y", 4), ("a = b\r\na = c", 2)]
)
def test_a_damaged_map_names_its_line(tmp_path, text, line):
    path = tmp_path / "map.txt"
    path.write_text(text, encoding="utf-8", newline="")
    with pytest.raises(FormatError) as caught:
        read_map(path)
    assert caught.value.line == line


@pytest.mark.parametrize("name", ["a", "a.", "a.docx", ".npz.zip"])
def test_unknown_suffixes_to_write_are_refused(tmp_path, name):
    with pytest.raises(OutputError, match=r"unknown; use \.npz"):
        save_scene(walkers(people=1, frames=3), tmp_path / name)
    assert list(tmp_path.iterdir()) == []


def test_an_empty_file_and_a_folder_are_named(tmp_path):
    for suffix in ("bvh", "npz", "csv", "trc"):
        (tmp_path / f"empty.{suffix}").write_bytes(b"")
        with pytest.raises(FormatError, match=rf"empty\.{suffix}"):
            load_scene(tmp_path / f"empty.{suffix}")
    with pytest.raises(InputError, match="is a folder"):
        load_scene(tmp_path)


def test_forecast_files_hold_the_question_too(tmp_path):
    from motioncast.core.card import ModelCard
    from motioncast.core.forecast import Forecast

    scene = walkers(people=1, frames=6)
    card = ModelCard("steps", "A guess", "forecast", "mrt15", 15, 10, 15.0)
    forecast = Forecast(np.broadcast_to(scene.positions[-1], (1, 4, 1, 15, 3)), scene, scene.people, card)
    save_forecast(forecast, tmp_path / "f.npz")
    np.testing.assert_array_equal(load_scene(tmp_path / "f.npz").positions, scene.positions)
    np.testing.assert_array_equal(load_forecast(tmp_path / "f.npz").samples, forecast.samples)
    save_forecast(forecast, tmp_path / "f.trc")
    np.testing.assert_allclose(load_scene(tmp_path / "f.trc").positions, forecast.best, atol=1e-5)


# --- writes that fail ---------------------------------------------------------------------------------------


@pytest.mark.parametrize("suffix", [".npz", ".csv", ".trc", ".bvh", ".glb"])
@pytest.mark.parametrize("number", [errno.ENOSPC, errno.EACCES])
def test_a_write_that_fails_leaves_the_old_file(tmp_path, monkeypatch, suffix, number):
    target = tmp_path / f"a{suffix}"
    target.write_bytes(b"old")

    def refuse(*_):
        raise OSError(number, os.strerror(number))

    monkeypatch.setattr(os, "replace", refuse)
    with pytest.raises(OutputError, match="disk is full" if number == errno.ENOSPC else "permission denied") as caught:
        save_scene(walkers(people=1, frames=3), target)
    assert "\n" not in str(caught.value)
    assert [entry.name for entry in tmp_path.iterdir()] == [target.name]
    assert target.read_bytes() == b"old"


def test_a_disk_that_fills_up_half_way_leaves_nothing(tmp_path, monkeypatch):
    def half(self, text, *_, **__):
        with self.open("w", encoding="utf-8") as file:
            file.write(text[: len(text) // 2])
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(Path, "write_text", half)
    with pytest.raises(OutputError, match="free some space"):
        bvh.write(fit_rotations(walkers(people=1, frames=3)), tmp_path / "a.bvh")
    assert list(tmp_path.iterdir()) == []


def test_the_temporary_file_keeps_suffix_and_folder_and_hides(tmp_path):
    with atomic_write(tmp_path / "take.tar.npz") as temporary:
        assert temporary.parent == tmp_path
        assert temporary.suffix == ".npz"
        assert temporary.name.startswith(".")
        temporary.write_bytes(b"x")
        assert not (tmp_path / "take.tar.npz").exists()
    assert (tmp_path / "take.tar.npz").read_bytes() == b"x"


def test_errors_inside_the_block_pass_through(tmp_path):
    def fails():
        with atomic_write(tmp_path / "a.txt") as temporary:
            temporary.write_text("half", encoding="utf-8")
            raise ZeroDivisionError

    with pytest.raises(ZeroDivisionError):
        fails()
    assert list(tmp_path.iterdir()) == []


def test_a_block_that_writes_nothing_is_an_error(tmp_path):
    with pytest.raises(OutputError, match="cannot write"), atomic_write(tmp_path / "a.txt"):
        pass
    assert list(tmp_path.iterdir()) == []
