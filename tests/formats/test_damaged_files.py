"""Damage of headers and metadata that the random damage of other tests seldom hits."""

from __future__ import annotations

import json
import zipfile
from pathlib import Path

import numpy as np
import pytest

from motioncast.errors import FormatError, InputError
from motioncast.formats import bvh, npz
from motioncast.formats.files import read_bytes, read_npz

BODY = """HIERARCHY
ROOT Hips
{
  OFFSET 0 0 0
  CHANNELS 3 Xposition Yposition Zposition
  JOINT LHipJoint
  {
    OFFSET 8 -5 0
    CHANNELS 0
    JOINT LeftFoot
    {
      OFFSET 0 -85 0
      CHANNELS 0
    }
  }
  JOINT LowerBack
  {
    OFFSET 0 45 0
    CHANNELS 0
    JOINT Neck
    {
      OFFSET 0 0 0
      CHANNELS 0
      JOINT Neck1
      {
        OFFSET 0 10 0
        CHANNELS 0
        JOINT Head
        {
          OFFSET 0 15 0
          CHANNELS 0
        }
      }
    }
    JOINT LThumb
    {
      OFFSET 20 -40 0
      CHANNELS 0
    }
  }
}
MOTION
Frames: 1
Frame Time: 0.02
0 95 0
"""


def written(path: Path, text: str) -> Path:
    path.write_text(text, encoding="utf-8")
    return path


def test_the_conversion_without_a_thorax_is_told_by_its_neck(tmp_path):
    path = written(tmp_path / "a.bvh", BODY)
    assert "leaves out the thorax" in bvh.read(path).remarks[-1]
    whole = BODY.replace("JOINT Neck\n    {\n      OFFSET 0 0 0", "JOINT Neck\n    {\n      OFFSET 0 8 0")
    assert whole != BODY
    assert not any("thorax" in remark for remark in bvh.read(written(path, whole)).remarks)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("HIERARCHY\nMOTION\nFrames: 1\nFrame Time: 0.02\n0\n", "a.bvh:2: MOTION, but the hierarchy has no joints"),
        (BODY[: BODY.index("Frame Time")], "the file ends before"),
        (BODY.replace("Frame Time: 0.02", "Frame Tim: 0.02"), '"Frame Time: seconds" was expected'),
        (BODY.replace("Frames: 1", "Frames: one"), '"Frames: N" was expected'),
    ],
)
def test_damaged_headers(tmp_path, text, message):
    with pytest.raises(FormatError, match=message):
        bvh.read(written(tmp_path / "a.bvh", text))


def with_meta(path: Path, text: str) -> Path:
    arrays = read_npz(path)
    np.savez(path, **{**arrays, "meta": np.array(text)})
    return path


def test_metadata_that_is_not_json(tmp_path, walkers):
    path = tmp_path / "a.npz"
    npz.write(walkers, path)
    for text in ("{", "[" * 100_000):
        with pytest.raises(FormatError, match='"meta" is not JSON'):
            npz.read(with_meta(path, text))


def test_whole_numbers_serve_as_rates(tmp_path, walkers):
    path = tmp_path / "a.npz"
    npz.write(walkers, path)
    meta = json.loads(str(read_npz(path)["meta"]))
    assert npz.read(with_meta(path, json.dumps({**meta, "fps": 30}))).fps == 30
    with pytest.raises(FormatError, match=r"'thirty'; expected a float"):
        npz.read(with_meta(path, json.dumps({**meta, "fps": "thirty"})))


def test_unknown_layouts_of_arrays_are_refused(tmp_path):
    path = tmp_path / "a.npz"
    with zipfile.ZipFile(path, "w") as archive, archive.open("a.npy", "w") as file:
        np.lib.format.write_array(file, np.zeros(3), version=(3, 0))
    with pytest.raises(FormatError, match=r"expected npy 1\.0 or 2\.0"):
        read_npz(path)


def test_what_cannot_be_read_says_why(tmp_path, monkeypatch):
    path = written(tmp_path / "a.txt", "secret")

    def refused(*_: object) -> None:
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr(Path, "open", refused)
    with pytest.raises(InputError, match="permission denied; check the file"):
        read_bytes(path)
