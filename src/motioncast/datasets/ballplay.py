"""BallPlay-M: people with a basketball, 60 frames a second, 53 joints of an SMPL-like skeleton.

From SkillMimic (Wang et al., arXiv 2408.15270); licence Apache-2.0. The folder holds ``extra_ballplay.npz`` and
``ballplay_index.csv``.
"""

from __future__ import annotations

import csv
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from motioncast.core.scene import Scene
from motioncast.core.skeletons import recognise
from motioncast.datasets.offsets import unpack
from motioncast.errors import InputError
from motioncast.formats.files import read_text

FPS = 60.0


def read(folder: str | Path) -> Iterator[Scene]:
    """All clips, one person each.

    Raises:
        InputError: If the folder does not hold the clips.
    """
    places = (Path(folder), Path(folder) / "extra")
    place = next((place for place in places if (place / "ballplay_index.csv").is_file()), None)
    if place is None or not (place / "extra_ballplay.npz").is_file():
        raise InputError("no ball players there; expected extra_ballplay.npz and ballplay_index.csv")
    clips = [row["id"] for row in csv.DictReader(read_text(place / "ballplay_index.csv").splitlines())]
    with np.load(place / "extra_ballplay.npz", allow_pickle=False) as data:
        names = [str(name) for name in data["joint_names"]]
        skeleton = recognise(names, [int(parent) for parent in data["parents"]], "ballplay53")
        for clip in clips:
            yield Scene(unpack(data, clip), skeleton, FPS, people=(clip,), source=f"BallPlay {clip}")
