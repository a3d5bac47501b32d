from __future__ import annotations

import csv
from pathlib import Path

import numpy as np
import pytest

from motioncast.core.scene import Scene
from motioncast.core.skeletons import recognise
from motioncast.datasets import cmu
from motioncast.errors import InputError

NAMES = ["root", "lhipjoint", "rhipjoint", "lowerback", "lfemur"]
BODY = recognise(NAMES, [-1, 0, 0, 0, 1], "part")
POSE = np.array([[0, 0, 1], [0.1, 0, 0.95], [-0.1, 0, 0.95], [0, 0.02, 1.1], [0.1, 0, 0.55]], np.float32)


def still(frames: int = 40) -> np.ndarray:
    return np.broadcast_to(POSE, (frames, 1, 5, 3)).copy()


def test_still_people_are_sound() -> None:
    assert cmu.sound(Scene(still(), BODY, 120)).all()


def test_a_turned_pelvis_for_a_frame_is_masked() -> None:
    positions = still()
    positions[20, 0, 1], positions[20, 0, 2] = POSE[2], POSE[1]
    good = cmu.sound(Scene(positions, BODY, 120))[:, 0]
    assert not good[19:22].any()
    assert good[:17].all()
    assert good[25:].all()


def test_a_jumping_knee_is_masked_and_a_walk_is_not() -> None:
    positions = still()
    positions[30:, 0, 4, 0] += 0.5
    assert not cmu.sound(Scene(positions, BODY, 120))[29:31].any()
    walking = still() + np.linspace(0, 0.5, 40, dtype=np.float32)[:, None, None, None]
    assert cmu.sound(Scene(walking, BODY, 120)).all()


def test_a_folder_without_motion_says_what_was_expected(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="expected"):
        cmu.takes(tmp_path)
    with pytest.raises(InputError, match="no folder"):
        cmu.takes(tmp_path / "nowhere")


TREE_ASF = """:units
  length 0.45
  angle deg
:root
   order TX TY TZ RX RY RZ
   axis XYZ
   position 0 0 0
   orientation 0 0 0
:bonedata
  begin
     name lhipjoint
     direction 1 0 0
     length 2
  end
  begin
     name rhipjoint
     direction -1 0 0
     length 2
  end
  begin
     name lowerback
     direction 0 1 0
     length 2
     axis 0 0 0 XYZ
     dof rx
  end
:hierarchy
  begin
    root lhipjoint rhipjoint lowerback
  end
"""
TREE_AMC = "1\nroot 0 17 0 0 0 0\nlowerback 0\n2\nroot 0 17 0 0 5 0\nlowerback 1\n"


def test_a_users_tree_is_read(tmp_path: Path) -> None:
    (tmp_path / "60").mkdir()
    (tmp_path / "60" / "60.asf").write_text(TREE_ASF, encoding="utf-8")
    (tmp_path / "60" / "60_12.amc").write_text(TREE_AMC, encoding="utf-8")
    (take,) = cmu.takes(tmp_path)
    assert (take.name, take.fps, take.split) == ("60_12", 60.0, "validation")
    (scene,) = cmu.read([take])
    np.testing.assert_allclose(scene.positions[0, 0, 3], [0, 0, 19 * 0.0254 / 0.45], atol=1e-6)
    with pytest.raises(InputError, match="61_12 is missing"):
        list(cmu.couples(tmp_path))


def test_a_take_whose_archive_is_gone_is_named(tmp_path: Path) -> None:
    (tmp_path / "index.csv").write_text("name,archive\n01_01,cmu_001.tar.xz\n", encoding="utf-8")
    with pytest.raises(InputError, match=r"cmu_001.tar.xz is missing.*01_01"):
        list(cmu.read(cmu.takes(tmp_path)))


@pytest.mark.data
def test_splits_and_rates_are_those_of_the_index(shared: Path) -> None:
    takes = {take.name: take for take in cmu.takes(shared)}
    for folder in ("cmu", "extra"):
        for row in csv.DictReader((shared / folder / "index.csv").read_text(encoding="utf-8").splitlines()):
            take = takes[row.get("name") or row["id"]]
            assert (take.split, take.fps) == (row["split"], float(row["fps"])), take.name
    assert len(takes) == 253


@pytest.mark.data
def test_known_defects_are_masked(shared: Path) -> None:
    takes = [take for take in cmu.takes(shared) if take.name in ("60_15", "61_15", "16_15", "05_16")]
    scenes = {scene.people[0]: scene for scene in cmu.read(takes)}
    assert not scenes["60_15"].observed[732].any()
    assert scenes["61_15"].observed.all()
    assert not scenes["05_16"].observed[465].any()
    index = (shared / "cmu" / "index.csv").read_text(encoding="utf-8")
    raw = next(row for row in csv.DictReader(index.splitlines()) if row["name"] == "16_15")
    assert scenes["16_15"].frames == int(raw["frames"]) - 2
