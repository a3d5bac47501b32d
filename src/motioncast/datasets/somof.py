"""The SoMoF benchmark of 3DPW: windows of two people, 16 frames in and 14 out at 15 a second, 13 joints.

Read from the user's own copy of the benchmark's JSON files, such as ``3dpw_test_in.json`` and ``3dpw_test_out.json``:
nested lists ``[window][person][frame][39]``, metres, y up. 3DPW may be used for research only and is not shipped
(https://virtualhumans.mpi-inf.mpg.de/3DPW). Its train and test folders are swapped in SoMoF.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np

from motioncast.core.scene import Scene
from motioncast.core.skeletons import SOMOF13
from motioncast.datasets.catalogue import DataSet, below
from motioncast.datasets.windows import Windows
from motioncast.errors import FormatError, InputError
from motioncast.formats.files import atomic_write, read_text

HISTORY, HORIZON, FPS = 16, 14, 15.0
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
    return Windows(positions, np.ones(positions.shape[:-1], bool), takes, ((0,),) * len(positions), HISTORY)


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


def write(windows: Sequence[Scene], folder: str | Path, split: str = "test") -> tuple[Path, ...]:
    """Writes windows as the benchmark's two files of a split; ``read`` gives them back to the last bit.

    Args:
        windows: Scenes of 30 frames at 15 a second with the benchmark's joints (``SOMOF13``) or those they lie between.
        folder: Where ``3dpw_SPLIT_in.json`` and ``3dpw_SPLIT_out.json`` go.
        split: ``train``, ``validation`` or ``test``.

    Raises:
        InputError: If a scene has another length, rate or number of people, or somebody is not observed.
        SkeletonError: If a scene lacks a joint.
        OutputError: If a file cannot be written.
    """
    if not windows:
        raise InputError("no windows came; give at least one scene of 30 frames at 15 a second")
    people = len(windows[0].people)
    rows = []
    for window in windows:
        if (window.frames, window.fps, len(window.people)) != (HISTORY + HORIZON, FPS, people):
            raise InputError(
                f"{window.source} has {window.frames} frames at {window.fps:g} a second and {len(window.people)} "
                f"people; expected {HISTORY + HORIZON} at {FPS:g} and {people} as in the first window"
            )
        scene = window.on(SOMOF13)
        if not scene.observed.all():
            raise InputError(f"{window.source} has joints that are not observed; SoMoF's files have no place for them")
        x, y, z = np.moveaxis(scene.positions, -1, 0)
        rows.append(np.stack([x, z, -y], -1).swapaxes(0, 1).reshape(people, window.frames, -1))
    values = np.stack(rows).astype(np.float64)  # JSON's digits then give each float32 back
    files = []
    for part, frames in (("in", slice(None, HISTORY)), ("out", slice(HISTORY, None))):
        path = Path(folder) / f"3dpw_{SPLITS[split]}_{part}.json"
        with atomic_write(path) as temporary:
            temporary.write_text(json.dumps(values[:, :, frames].tolist()), encoding="utf-8")
        files.append(path)
    return tuple(files)


def scenes(path: str | Path) -> Iterator[Scene]:
    """Each window of a split as a scene of 30 frames, from the path of its history file (``*_in.json``).

    Raises:
        InputError: If the split's other file is missing.
        FormatError: If a file has another layout.
    """
    path = Path(path)
    part = path.stem.removesuffix("_in").rpartition("_")[2]
    split = next(name for name, spelling in SPLITS.items() if spelling == part)
    windows = read(path.parent, split)
    digits = len(str(len(windows) - 1))
    for number, positions in enumerate(windows.positions):
        yield Scene(positions, SOMOF13, FPS, source=f"SoMoF {split} {number:0{digits}d}")


def parts(folder: Path) -> list[Path]:
    """The history files of the splits that a folder holds."""
    found = [path for part in SPLITS.values() for path in below(folder, f"*{part}_in.json")]
    return [path for path in found if "frames" not in path.name]


DATASET = DataSet(
    "somof",
    "SoMoF's windows of 3DPW: two people, 16 + 14 frames at 15 fps, 13 joints",
    "research only; not to be passed on (3DPW)",
    "85 windows to test, 36 to validate, 221 to train; 10 MB",
    "the SoMoF challenge (somof.stanford.edu)",
    ("*test_in.json", "*test_out.json", "*valid_in.json", "*valid_out.json", "*train_in.json", "*train_out.json"),
    parts,
    scenes,
)
