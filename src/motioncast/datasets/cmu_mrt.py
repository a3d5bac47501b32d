"""MRT's mixed scenes of CMU's motion: three people, 120 frames at 30 a second, 15 joints.

MRT's tools (Wang et al., NeurIPS 2021) write ``train_3_120_mocap.npy`` (6,000 scenes), ``test_3_120_mocap.npy`` (800)
and ``discriminator_3_120_mocap.npy``; the model reads every second frame, 15 of history and 45 of future.

- Unit: 0.06 of CMU's, so 1.0 is 0.9407 m. Errors in the papers' tables are divided by 1.8 on top of that.
- Positions are centred on the mean of all 120 frames, past and future: where the origin lies tells a little of what
  comes. A scene relative to its last frame of history is free of it.
- Trials are split into train and test, people are not: everybody of the test file may be in the train file.
- The generator has no seed, so every copy is another data set, and its loop over the subjects 33 and 34 stops after
  their first trial. State the checksum of your file beside a figure.

Layout, unit and rates are those of the public tools; no file of the authors was at hand to check them against.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from motioncast.core.scene import Scene
from motioncast.datasets import mixes
from motioncast.datasets.catalogue import DataSet, below
from motioncast.datasets.windows import Windows
from motioncast.errors import InputError
from motioncast.formats.units import UNITS_M

UNIT_M = UNITS_M["cmu"] / 0.06
FPS = 30.0
HISTORY, STEP = 15, 2

FILES = {"train": "train_3_120_mocap.npy", "test": "test_3_120_mocap.npy"}


def read(path: str | Path) -> Iterator[Scene]:
    """The scenes of one file.

    Raises:
        InputError: If there is no such file, or its limbs are no people's.
        FormatError: If it is of another layout or damaged.
    """
    return mixes.scenes(path, UNIT_M, FPS)


def windows(folder: str | Path, split: str = "test") -> Windows:
    """The scenes of a split at 15 frames a second, 15 of 60 frames history.

    Raises:
        InputError: If the folder lacks the split's file.
        FormatError: If it is of another layout or damaged.
    """
    name = FILES.get(split)
    found = below(Path(folder), name) if name else []
    if not found:
        raise InputError(f'{folder} has no file for the split "{split}"; expected {" and ".join(FILES.values())}')
    return mixes.windows(found[0], UNIT_M, STEP, HISTORY)


DATASET = DataSet(
    "cmu-mrt",
    "MRT's mixed scenes of three people from CMU's motion; 15 joints, 4 s at 30 fps",
    "free to use, not to be resold (CMU's motion); MRT's tools that write it state no licence",
    "6,000 + 800 scenes, about 900 MB",
    "mocap.cs.cmu.edu, then mocap/ of github.com/jiashunwang/MRT, of which every run gives another mix",
    tuple(FILES.values()),
    lambda folder: below(folder, *FILES.values()),
    read,
)
