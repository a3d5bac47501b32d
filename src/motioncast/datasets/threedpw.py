"""3DPW: one or two people out of doors, 30 frames a second, SMPL's 24 joints in the world.

The user's own copy holds ``sequenceFiles/{train,validation,test}/*.pkl``: pickles of Python 2 with, for each person,
``jointPositions`` (frames, 72) in metres, y up, and ``campose_valid`` (frames). The pickles are read as plain data
and can run nothing (``formats.pickles``).

- A frame whose camera could not be aligned is marked as not observed: the person's place in the world is a guess there.
- The world drifts with the moving camera all the same; no camera correction is made, as in all published figures.
- SoMoF swaps the folders: its test windows come from ``train``. ``somof.py`` reads SoMoF's own files.
- Its owners ask not to train on it for the 3DPW challenge.

Names and shapes are those of the data set's readme; no file was at hand to check them against.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from motioncast.core.scene import Scene
from motioncast.core.skeletons import SMPL24
from motioncast.datasets.catalogue import DataSet, below, metric
from motioncast.errors import FormatError
from motioncast.formats.pickles import read_pickle
from motioncast.formats.units import axis_turn

FPS = 30.0
SPLITS = ("train", "validation", "test")


def takes(folder: str | Path, split: str | None = None) -> list[Path]:
    """The files of one of the data set's own splits, or of all."""
    splits = SPLITS if split is None else (split,)
    return [path for part in splits for path in below(Path(folder), f"{part}/*.pkl")]


def read(path: str | Path) -> Iterator[Scene]:
    """The scene of one file.

    Raises:
        InputError: If there is no such file, or its limbs are no people's.
        FormatError: If it is damaged, of another layout, or holds more than plain data.
    """
    data = read_pickle(path)
    if not isinstance(data, dict) or "jointPositions" not in data:
        raise FormatError(path, "has no jointPositions; expected a sequence file of 3DPW")
    people = [_positions(path, entry) for entry in _list(path, data["jointPositions"])]
    frames = {len(person) for person in people}
    if len(frames) != 1:
        raise FormatError(path, f"has people of {sorted(frames)} frames; expected one length for all")
    positions = np.stack(people, 1) @ axis_turn("y").T.astype(np.float32)
    valid = np.ones(positions.shape[:2], bool)
    if "campose_valid" in data:
        masks = [np.asarray(mask).astype(bool).ravel() for mask in _list(path, data["campose_valid"])]
        if [len(mask) for mask in masks] != [len(positions)] * len(people):
            raise FormatError(path, "has a campose_valid of another length than jointPositions")
        valid = np.stack(masks, 1)
    observed = np.broadcast_to(valid[..., None], positions.shape[:3])
    if not np.isfinite(positions[observed]).all():
        raise FormatError(path, "holds positions that are not finite; get the file again")
    yield metric(Scene(positions, SMPL24, FPS, observed, source=f"3DPW {Path(path).stem}"))


def _list(path: str | Path, value: Any) -> list[Any]:
    if not isinstance(value, (list, tuple)) or not value:
        raise FormatError(path, "has no entry for each person where one was expected")
    return list(value)


def _positions(path: str | Path, entry: Any) -> np.ndarray:
    values = np.asarray(entry)
    width = len(SMPL24) * 3
    if values.dtype.kind != "f" or values.ndim != 2 or values.shape[1] != width:
        raise FormatError(path, f"has jointPositions of shape {values.shape}; expected (frames, {width})")
    return values.astype(np.float32).reshape(len(values), len(SMPL24), 3)


DATASET = DataSet(
    "threedpw",
    "3DPW, one or two people out of doors filmed by a moving camera; SMPL's 24 joints, 30 fps",
    "research only; not to be passed on; its owners ask not to train on it for the challenge",
    "60 takes, 51,000 frames, 0.2 GB without the images",
    "virtualhumans.mpi-inf.mpg.de/3DPW (sequenceFiles.zip)",
    ("train/*.pkl", "validation/*.pkl", "test/*.pkl"),
    takes,
    read,
)
