"""CSV and TRC tables, and C3D files where ezc3d is installed."""

from __future__ import annotations

from contextlib import suppress
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from motioncast.core.skeletons import MRT15
from motioncast.errors import FormatError, MotioncastError, SceneError
from motioncast.formats import c3d, csv, trc


def by_name(scene):
    return scene.positions[:, :, [scene.skeleton.index(name) for name in MRT15.names]]


def gappy(scene):
    seen = scene.observed.copy()
    seen[5:9, 0, 3] = False
    seen[20:30, 1] = False
    return replace(scene, observed=seen)


def test_csv_round_trip(tmp_path, walkers):
    scene = gappy(walkers)
    csv.write(scene, tmp_path / "a.csv")
    back = csv.read(tmp_path / "a.csv")
    np.testing.assert_allclose(by_name(back), scene.positions, atol=1e-6)
    assert back.observed.sum() == scene.observed.sum()
    assert (back.people, back.fps, back.remarks) == (scene.people, scene.fps, ())
    assert back.skeleton.find("left_wrist") is not None


def test_csv_without_comments_infers_and_says(tmp_path, walkers):
    csv.write(walkers, tmp_path / "a.csv")
    path = tmp_path / "b.csv"
    lines = (tmp_path / "a.csv").read_text(encoding="utf-8").splitlines()[3:]
    path.write_text("\r\n".join(lines), encoding="utf-8", newline="")
    back = csv.read(path)
    assert back.fps == 30
    assert "unit m" in back.remarks[0]
    np.testing.assert_allclose(by_name(back), walkers.positions, atol=1e-6)


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("time_s", "t", 'no column "time_s"'),
        ("neck_y", "neck_q", "breaks this order"),
        ("0.000000,ada", "zero,ada", r"a.csv:5: \"zero\""),
        ("0.033333,ada", "0.000000,ada", "two rows"),
        ("0.033333,ada", "0.045000,ada", "do not lie on a clock"),
        ("0.033333,ada", "1e15,ada", "more than are read"),
        ("# fps: 30.0", "# fps: -3", "no frame rate"),
        ("# unit: m", "# unit: mm", "tall; expected"),
        ("# up: z", "# up: w", "up axis"),
        ("0.000000,ada,", "0.000000,ada,inf,", "cells; the header has"),
    ],
)
def test_csv_errors(tmp_path, walkers, old, new, message):
    path = tmp_path / "a.csv"
    csv.write(walkers, path)
    text = path.read_text(encoding="utf-8")
    assert old in text
    path.write_text(text.replace(old, new, 1), encoding="utf-8")
    with pytest.raises(MotioncastError, match=message):
        csv.read(path)


def test_trc_round_trip(tmp_path, walkers):
    scene = gappy(walkers)
    targets = trc.write(scene, tmp_path / "a.trc")
    for person, target in enumerate(targets):
        back = trc.read(target)
        np.testing.assert_allclose(by_name(back)[:, 0], scene.positions[:, person], atol=1e-6)
        assert back.observed.sum() == scene.observed[:, person].sum()
        assert back.fps == 30


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("PathFileType", "Path", "PathFileType"),
        ("\t60\t15\tm\t", "\t61\t15\tm\t", "declares 61 frames but has 60"),
        ("\t60\t15\tm\t", "\t60\t16\tm\t", "names 15 markers"),
        ("\t60\t15\tm\t", "\t60\t15\tmm\t", "tall; expected"),
        ("\n1\t0.000000\t", "\n1\t0.000000\tx", "a.trc:6"),
    ],
)
def test_trc_errors(tmp_path, walkers, old, new, message):
    path = tmp_path / "a.trc"
    trc.write(walkers.select(["ada"]), path)
    text = path.read_text(encoding="utf-8")
    assert old in text
    path.write_text(text.replace(old, new, 1), encoding="utf-8")
    with pytest.raises(MotioncastError, match=message):
        trc.read(path)


@pytest.mark.parametrize("module", [csv, trc])
def test_damage_is_always_a_sentence(tmp_path, walkers, module):
    path = tmp_path / f"a{module.suffixes[0]}"
    module.write(walkers[:3].select(["ada"]), path)
    content = path.read_bytes()

    @given(st.integers(0, 10_000), st.binary(min_size=0, max_size=3), st.booleans())
    def damage(place, junk, cut):
        place %= len(content)
        path.write_bytes(content[:place] if cut else content[:place] + junk + content[place + 1 :])
        with suppress(MotioncastError):
            module.read(path)

    damage()


def test_c3d(tmp_path, walkers):
    ezc3d = pytest.importorskip("ezc3d")
    file = ezc3d.c3d()
    labels = [f"{person}:{joint}" for person in walkers.people for joint in MRT15.names] + ["*7", "LHipAngles"]
    points = np.full((4, len(labels), 60), 1.0)
    for person in range(2):
        rows = slice(15 * person, 15 * person + 15)
        points[:3, rows] = np.moveaxis(walkers.positions[:, person] * 1000, -1, 0).swapaxes(1, 2)
    points[:3, 4, 10] = np.nan
    point = file["parameters"]["POINT"]
    point["RATE"]["value"], point["UNITS"]["value"], point["LABELS"]["value"] = [30], ["mm"], labels
    file.add_parameter("POINT", "ANGLES", ["LHipAngles"])
    file["data"]["points"] = points
    path = tmp_path / "a.c3d"
    file.write(str(path))
    scene = c3d.read(path)
    assert scene.people == walkers.people
    assert scene.fps == 30
    assert np.argwhere(~scene.observed).tolist() == [[10, 0, scene.skeleton.index(MRT15.names[4])]]
    known = np.ones((60, 2, 15), bool)
    known[10, 0, 4] = False
    np.testing.assert_allclose(by_name(scene)[known], walkers.positions[known], atol=1e-6)
    path.write_bytes(b"\x02P" + b"\0" * 600)
    with pytest.raises((FormatError, SceneError)):
        c3d.read(path)
