"""The SoMoF benchmark of 3DPW: windows of two people, 16 frames in and 14 out at 15 a second, 13 joints.

Read from the user's own copy of the benchmark's JSON files, such as ``3dpw_test_in.json`` and ``3dpw_test_out.json``:
nested lists ``[window][person][frame][39]``, metres, y up. 3DPW may be used for research only and is not shipped
(https://virtualhumans.mpi-inf.mpg.de/3DPW). Its train and test folders are swapped in SoMoF.
"""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np

from motioncast.core.skeletons import SOMOF13
from motioncast.datasets.windows import Windows
from motioncast.errors import FormatError, InputError
from motioncast.formats.files import read_text

HISTORY, HORIZON = 16, 14
SPLITS = {"test": "test", "validation": "valid", "train": "train"}


def read(folder: str | Path, split: str = "test") -> Windows:
    """The windows of one split.

    Raises:
        InputError: If the folder lacks the split's files.
        FormatError: If a file has another layout.
    """
    past, future = (_positions(_file(Path(folder), split, part), frames) for part, frames in PARTS.items())
    if len(past) != len(future):
        raise InputError(
            f"{folder}: {len(past)} histories came with {len(future)} futures; get both files of one release"
        )
    positions = np.concatenate([past, future], 1)
    takes = tuple(f"SoMoF {split} {window}" for window in range(len(positions)))
    return Windows(positions, np.ones(positions.shape[:-1], bool), takes, (0,) * len(positions), HISTORY)


PARTS = {"in": HISTORY, "out": HORIZON}
"""Suffix of a file and the frames that it holds."""


def _file(folder: Path, split: str, part: str) -> Path:
    pattern = f"*{SPLITS[split]}_{part}.json"
    found = sorted(path for path in folder.rglob(pattern) if "frames" not in path.name)
    if not found:
        raise InputError(
            f"{folder} holds no {pattern}; expected the SoMoF benchmark's files, which its owners give out"
        )
    return found[0]


def _positions(path: Path, frames: int) -> np.ndarray:
    """Positions with z up, ``(windows, frames, people, joints, 3)``."""
    try:
        values = np.array(json.loads(read_text(path)), np.float32)
    except (ValueError, TypeError) as error:
        raise FormatError(path, f"is no nested list of numbers ({str(error)[:60]})") from None
    joints = len(SOMOF13)
    if values.ndim != 4 or values.shape[2:] != (frames, joints * 3):
        raise FormatError(path, f"has the shape {values.shape}; expected (windows, people, {frames}, {joints * 3})")
    x, y, z = np.moveaxis(values.reshape(*values.shape[:3], joints, 3), -1, 0)
    return np.stack([x, -z, y], -1).swapaxes(1, 2)
