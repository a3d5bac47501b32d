"""The ball players of BallPlay-M as an entry of the catalogue; ``ballplay`` reads them."""

from __future__ import annotations

from pathlib import Path

from motioncast.datasets import ballplay
from motioncast.datasets.catalogue import DataSet, below


def parts(folder: Path) -> list[Path]:
    """The folders that hold the clips."""
    return [path.parent for path in below(folder, "extra_ballplay.npz")]


DATASET = DataSet(
    "extra",
    "99 clips of one person and a ball, on another skeleton; CMU takes beside them are read with cmu",
    "Apache-2.0 (BallPlay-M of SkillMimic)",
    "99 clips, 4 minutes, 10 MB",
    "github.com/wyhuai/SkillMimic, skillmimic/data/motions",
    ("extra_ballplay.npz", "ballplay_index.csv"),
    parts,
    ballplay.read,
)
