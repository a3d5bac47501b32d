"""MuPoTS-3D in MRT's layout: two or three people out of doors, 120 (or 150) frames, 15 joints; test only.

MRT's tools write ``mupots_120_3persons.npy`` and ``mupots_120_2persons.npy``, TBIFormer's authors pass on
``mupots_150_*``. Every second frame is read, 15 of history and 45 (TBIFormer: 25 of 50 + 25) of future.

- Unit: the tools' history holds two scales: 1 m is 1.02 or 0.9 of the file. The one that makes adults of the people
  is taken, and the scenes' remark says which. Figures in papers are not divided by 1.8 as those of CMU are.
- ``head`` is the top of the head here.
- Windows start every 15 frames and overlap; x and z are centred and the floor is found on the whole take, so all
  windows of a take share what is known of its future.
- Of the 20 takes, 1 to 5 were filmed at 30 frames a second and 6 to 20 at 60 (a remark in the tools), yet all are
  written alike. Which windows run at the double rate cannot be told from the file; 30 is taken for all.

Layout, order and scales are those of the public tools; no file was at hand to check them against.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np

from motioncast.core.scene import Scene
from motioncast.core.skeletons import MRT15
from motioncast.datasets import mixes
from motioncast.datasets.catalogue import DataSet, below
from motioncast.datasets.windows import Windows
from motioncast.errors import InputError
from motioncast.formats.units import ADULT_STATURE_M, stature

SCALES = (1.02, 0.9)
"""Units of the file per metre, in the tools' history."""

FPS = 30.0
HISTORY, STEP = 15, 2

SKELETON = replace(
    MRT15,
    landmarks=tuple("head_top" if place == "head" else place for place in MRT15.landmarks),
    label="mupots15",
)


def read(path: str | Path) -> Iterator[Scene]:
    """The scenes of one file.

    Raises:
        InputError: If there is no such file, or its limbs are no people's.
        FormatError: If it is of another layout or damaged.
    """
    unit = unit_m(path)
    remark = f"{Path(path).name}: 1 m is taken for {1 / unit:g} units, which makes adults of the people"
    return mixes.scenes(path, unit, FPS, SKELETON, remark)


def unit_m(path: str | Path) -> float:
    """Metres per unit of a file: of the known scales the one that makes adults of the people."""
    values = mixes.stored(path)
    some = values[:: max(1, len(values) // 50), :, ::15]
    frames = mixes.upright(np.asarray(some), 1.0).reshape(-1, values.shape[1], len(SKELETON), 3)
    size = stature(frames, np.ones(frames.shape[:3], bool), SKELETON)
    return min((1 / scale for scale in SCALES), key=lambda unit: abs(size * unit - ADULT_STATURE_M))


def windows(folder: str | Path, people: int = 3) -> Windows:
    """The scenes of so many people at 15 frames a second, 15 of 60 frames history.

    Raises:
        InputError: If the folder lacks the file.
        FormatError: If it is of another layout or damaged.
    """
    name = f"mupots_120_{people}persons.npy"
    found = below(Path(folder), name)
    if not found:
        raise InputError(f"{folder} has no {name}; obtain it from {DATASET.origin}")
    return mixes.windows(found[0], unit_m(found[0]), STEP, HISTORY)


DATASET = DataSet(
    "mupots",
    "MuPoTS-3D, two or three people out of doors, in MRT's layout; 15 joints, test only",
    "non-commercial research only (Max Planck Institute for Informatics)",
    "a few hundred windows of 20 takes, about 100 MB",
    "vcai.mpi-inf.mpg.de/projects/SingleShotMultiPerson, then mupots3d/ of github.com/jiashunwang/MRT",
    ("mupots_120_3persons.npy or mupots_150_3persons.npy", "mupots_120_2persons.npy or mupots_150_2persons.npy"),
    lambda folder: below(folder, "mupots_1[25]0_[23]persons.npy"),
    read,
)
