"""The characteristic poses of CMU's takes as an entry of the catalogue; ``cmu_goals`` reads them."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from motioncast.core.scene import Scene
from motioncast.datasets import cmu_check
from motioncast.datasets.catalogue import DataSet
from motioncast.datasets.cmu_goals import table
from motioncast.formats.moments_tsv import read_moments


def read(place: Path) -> Iterator[Scene]:
    """The takes of one archive or file that have a characteristic moment."""
    marked = {moment.take for moment in read_moments(table()) if moment.source != "rejected"}
    return (scene for scene in cmu_check.read(place) if scene.people[0] in marked)


DATASET = DataSet(
    "cmu-goals",
    "1,545 characteristic moments of CMU's takes, in a table of the package; the takes are those of cmu",
    "the moments: Apache-2.0; the takes: as cmu",
    "as cmu",
    "mocap.cs.cmu.edu, .asf and .amc by subject",
    ("cmu_*.tar.xz or extra_cmu_*.npz or *.amc",),
    cmu_check.parts,
    read,
    cmu_check.split,
)
