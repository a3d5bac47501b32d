"""Tables and TRC: blanks, clocks, forecasts, and what is refused."""

from __future__ import annotations

import re

import numpy as np
import pytest

from motioncast.core.skeletons import MRT15
from motioncast.errors import FormatError, MotioncastError
from motioncast.formats import csv, trc
from motioncast.formats.load import load_scene, save_forecast
from motioncast.inference.baselines import SimpleGuess


@pytest.fixture
def table(tmp_path, walkers):
    """A table of two people, and its text."""
    path = tmp_path / "a.csv"
    csv.write(walkers, path)
    return path, path.read_text(encoding="utf-8")


@pytest.fixture
def markers(tmp_path, walkers):
    """A TRC file of one person, and its text."""
    path = tmp_path / "a.trc"
    trc.write(walkers.select(["ada"]), path)
    return path, path.read_text(encoding="utf-8")


def changed(file, pattern: str, new: str):
    """The path, after the first match of the pattern was replaced in the file."""
    path, text = file
    text, count = re.subn(pattern, lambda _: new, text, count=1)
    assert count == 1
    path.write_text(text, encoding="utf-8")
    return path


@pytest.mark.parametrize("blank", ["", "NA", " nan ", "NaN"])
def test_a_blank_cell_is_a_joint_that_is_not_seen(table, walkers, blank):
    path = changed(table, r"(?<=0\.033333,bea,)[-0-9.]+", blank)
    scene = csv.read(path)
    assert np.argwhere(~scene.observed).tolist() == [[1, 1, scene.skeleton.index("pelvis")]]


def test_people_may_go_unnamed_where_there_is_one(tmp_path, walkers):
    csv.write(walkers.select(["ada"]), tmp_path / "solo.csv")
    text = (tmp_path / "solo.csv").read_text(encoding="utf-8")
    (tmp_path / "solo.csv").write_text(text.replace(",person", "").replace(",ada", ""), encoding="utf-8")
    scene = csv.read(tmp_path / "solo.csv")
    assert scene.people == ("solo",)
    assert scene.frames == 60


@pytest.mark.parametrize("fps", [30, 25, 120, 30000 / 1001])
def test_the_clock_follows_from_the_times(tmp_path, walkers, fps):
    times = np.arange(60) / fps
    lines = ["time_s,person," + ",".join(f"{name}_{axis}" for name in MRT15.names for axis in "xyz")]
    for time, pose in zip(times, walkers.positions[:, 0], strict=True):
        lines.append(f"{time:.6f},ada," + ",".join(f"{value:.6f}" for value in pose.ravel()))
    (tmp_path / "a.csv").write_text("\n".join(lines), encoding="utf-8")
    assert csv.read(tmp_path / "a.csv").fps == pytest.approx(fps, rel=1e-9)


@pytest.mark.parametrize(
    ("pattern", "new", "message"),
    [
        (r"0\.033333,ada", "1000000.0,ada", "check time_s"),
        (r"0\.033333,ada", '0.033333,"ada', "not a table of comma-separated values"),
        (r"(?<=0\.033333,ada,)[-0-9.]+", "inf", "infinite number"),
        (r"(?<=0\.033333,ada,)[-0-9.]+", "1,5", "cells; the header has"),
        (r"(?<=0\.033333,ada,)[-0-9.]+", "1m", "decimal point"),
        (r"(?s)0\.000000,ada.*", "", "no rows"),
        (r"(?s)time_s.*", "", "no header"),
    ],
)
def test_tables_that_are_refused(table, pattern, new, message):
    with pytest.raises(MotioncastError, match=message):
        csv.read(changed(table, pattern, new))


def test_one_moment_needs_a_rate(table):
    path, text = table
    lines = text.splitlines()[3:5]  # without comments: the header and one row
    path.write_text("\n".join(lines), encoding="utf-8")
    with pytest.raises(FormatError, match="one moment only"):
        csv.read(path)
    assert csv.read(path, fps=25).fps == 25


def test_a_forecast_as_a_table(tmp_path, walkers):
    forecast = SimpleGuess("constant-velocity").forecast(walkers, horizon_s=1.0)
    assert save_forecast(forecast, tmp_path / "f.csv") == (tmp_path / "f.csv",)
    head, *rows = [
        line.split(",")
        for line in (tmp_path / "f.csv").read_text(encoding="utf-8").splitlines()
        if not line.startswith("#")
    ]
    assert head[:5] == ["sample", "weight", "time_s", "person", "pelvis_x"]
    assert [row[:4] for row in rows[:2]] == [["0", "1", "0.033333", "ada"], ["0", "1", "0.033333", "bea"]]
    values = np.array([row[4:] for row in rows], float).reshape(forecast.samples.shape)
    np.testing.assert_allclose(values, forecast.samples, atol=1e-6)
    with pytest.raises(FormatError, match="holds a forecast, not a scene"):
        load_scene(tmp_path / "f.csv")


@pytest.mark.parametrize(
    ("pattern", "new", "message"),
    [
        (r"\n30\t", "\n0\t", "data rate is 0"),
        (r"\t60\t15\tm\t", "\tsixty\t15\tm\t", '"sixty" where a number of frames'),
        (r"(?<=\n2\t0\.033333\t)", "1.0\t", "a.trc:7: 48 cells; expected frame, time and 45"),
        (r"\tneck\t", "\tpelvis\t", '"pelvis" comes twice'),
        (r"\tUnits\t", "\tUnit\t", 'no value for "Units"'),
    ],
)
def test_markers_that_are_refused(markers, pattern, new, message):
    with pytest.raises(MotioncastError, match=message):
        trc.read(changed(markers, pattern, new))


def test_editors_add_and_strip_blanks_at_the_end_of_a_line(markers, walkers):
    path, text = markers
    lines = text.splitlines()
    lines[5] += "\t\t"
    lines[6] = "\t".join(lines[6].split("\t")[:-3])
    path.write_text("\n".join(lines), encoding="utf-8")
    scene = trc.read(path)
    assert scene.frames == 60
    assert np.argwhere(~scene.observed).tolist() == [[1, 0, scene.skeleton.index(MRT15.names[-1])]]
