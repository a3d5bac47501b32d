"""C3D, where its reader is installed; what is refused before it is asked."""

from __future__ import annotations

import sys

import numpy as np
import pytest

from motioncast.core.skeletons import MRT15
from motioncast.errors import FormatError, MissingExtra
from motioncast.formats import c3d


def written(path, walkers, labels):
    """A file of the first walker, whose points have these labels."""
    ezc3d = pytest.importorskip("ezc3d")
    file = ezc3d.c3d()
    point = file["parameters"]["POINT"]
    point["RATE"]["value"], point["UNITS"]["value"], point["LABELS"]["value"] = [30], ["m"], labels
    points = np.ones((4, 15, walkers.frames))
    points[:3] = np.moveaxis(walkers.positions[:, 0], -1, 0).swapaxes(1, 2)
    file["data"]["points"] = points
    file.write(str(path))
    return path


def test_points_without_prefixes_are_one_person_named_by_the_file(tmp_path, walkers):
    scene = c3d.read(written(tmp_path / "dancer.c3d", walkers, list(MRT15.names)))
    assert scene.people == ("dancer",)
    order = [scene.skeleton.index(name) for name in MRT15.names]
    np.testing.assert_allclose(scene.positions[:, 0, order], walkers.positions[:, 0], atol=1e-6)


def test_points_that_nobody_labelled_are_refused(tmp_path, walkers):
    path = written(tmp_path / "a.c3d", walkers, [f"*{number}" for number in range(15)])
    with pytest.raises(FormatError, match="no labelled points"):
        c3d.read(path)


def test_other_files_are_refused(tmp_path):
    (tmp_path / "a.c3d").write_text("not so binary", encoding="utf-8")
    with pytest.raises(FormatError, match="does not begin like a C3D file"):
        c3d.read(tmp_path / "a.c3d")


def test_without_its_reader_the_extra_is_named(tmp_path, monkeypatch):
    (tmp_path / "a.c3d").write_bytes(b"\x02P" + b"\0" * 600)
    monkeypatch.setitem(sys.modules, "ezc3d", None)
    with pytest.raises(MissingExtra, match=r"motioncast\[c3d\]"):
        c3d.read(tmp_path / "a.c3d")
