"""CMU's motion capture as an entry of the catalogue; ``cmu`` reads it."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from motioncast.core.scene import Scene
from motioncast.datasets import cmu
from motioncast.datasets.catalogue import DataSet


def parts(folder: Path) -> list[Path]:
    """The archives, npz files and AMC files that hold the takes.

    Raises:
        InputError: If the folder holds none, saying what was looked for.
    """
    return list(dict.fromkeys(take.place for take in cmu.takes(folder)))


def read(place: Path) -> Iterator[Scene]:
    """The takes of one archive or file."""
    # an archive is known by the index beside it, an AMC file by its own name
    return cmu.read([take for take in cmu.takes(place.parent) if take.place == place])


def split(scene: Scene) -> str:
    """The split of a take, from its name ``NN_TT``."""
    subject, number = scene.people[0].split("_")
    return cmu.split_of(int(subject), int(number))


DATASET = DataSet(
    "cmu",
    "127 takes of 23 people, two of them dancing together; ASF/AMC",
    "free to use, not to be resold; acknowledge CMU (see NOTICE)",
    "23 archives and 3 npz files, 50 MB",
    "mocap.cs.cmu.edu, .asf and .amc by subject",
    ("cmu_*.tar.xz or extra_cmu_*.npz or *.amc",),
    parts,
    read,
    split,
)
