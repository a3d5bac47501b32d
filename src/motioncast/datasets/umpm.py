"""The mixes of CMU's and UMPM's motion that TBIFormer's authors pass on: 3, 6 or 10 people, 75 frames at 25 a second.

``train_3_75_mocap_umpm.npy`` (13,000 scenes), ``test_3_75_mocap_umpm.npy`` (3,000), ``mix1_6persons.npy`` and
``mix2_10persons.npy`` (1,000 each, test only): 50 frames of history, 25 of future, 15 joints as MRT's.

Papers print errors of these files "in mm" as 1,000 times the file's unit. Its authors follow MRT's tools, in which 1.0
is 0.9407 m; that is assumed here for all of a file, so a printed 100 mm is 94 mm. UMPM's own part may have been
scaled otherwise: no file was at hand to check, only limbs that are no people's are refused. The authors' loader leaves
the last frame of history in the truth (their test is off by one frame); windows here are not.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from motioncast.core.scene import Scene
from motioncast.datasets import mixes
from motioncast.datasets.catalogue import DataSet, below
from motioncast.datasets.cmu_mrt import UNIT_M
from motioncast.datasets.windows import Windows
from motioncast.errors import InputError

FPS = 25.0
HISTORY = 50

FILES = {
    "train": "train_3_75_mocap_umpm.npy", "test": "test_3_75_mocap_umpm.npy", "mix1": "mix1_6persons.npy",
    "mix2": "mix2_10persons.npy",
}  # fmt: skip


def read(path: str | Path) -> Iterator[Scene]:
    """The scenes of one file.

    Raises:
        InputError: If there is no such file, or its limbs are no people's.
        FormatError: If it is of another layout or damaged.
    """
    return mixes.scenes(path, UNIT_M, FPS)


def windows(folder: str | Path, split: str = "test") -> Windows:
    """The scenes of a split: ``train``, ``test``, ``mix1`` (six people) or ``mix2`` (ten), 50 of 75 frames history.

    Raises:
        InputError: If the folder lacks the split's file.
        FormatError: If it is of another layout or damaged.
    """
    name = FILES.get(split)
    found = below(Path(folder), name) if name else []
    if not found:
        raise InputError(f'{folder} has no file for the split "{split}"; expected {", ".join(FILES.values())}')
    return mixes.windows(found[0], UNIT_M, 1, HISTORY)


DATASET = DataSet(
    "umpm",
    "mixed scenes of 3, 6 or 10 people from CMU's and UMPM's motion; 15 joints, 3 s at 25 fps",
    "research only (UMPM: Utrecht University); the mixed files state no licence",
    "18,000 scenes, about 1.5 GB",
    "github.com/xiaogangpeng/TBIFormer, whose readme links to them",
    ("train_3_75_mocap_umpm.npy", "test_3_75_mocap_umpm.npy", "mix1_6persons.npy", "mix2_10persons.npy"),
    lambda folder: below(folder, *FILES.values()),
    read,
)
