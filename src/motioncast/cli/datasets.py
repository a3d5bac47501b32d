"""``motioncast datasets``: the data sets, where to obtain them, and whether a copy is whole."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from motioncast.cli.say import table
from motioncast.errors import InputError


@dataclass(frozen=True)
class DataSet:
    """A data set that motioncast reads, and where it comes from."""

    name: str
    what: str
    licence: str
    origin: str


DATASETS = (
    DataSet(
        "cmu",
        "127 takes of 23 people, two of them dancing together; ASF/AMC",
        "free to use, not to be resold; acknowledge CMU (see NOTICE)",
        "mocap.cs.cmu.edu, .asf and .amc by subject",
    ),
    DataSet(
        "extra",
        "126 further CMU takes as joint positions, and 99 clips of ball play on another skeleton",
        "CMU as above; ball play Apache-2.0 (BallPlay-M of SkillMimic)",
        "mocap.cs.cmu.edu and github.com/wyhuai/SkillMimic",
    ),
)


def datasets() -> None:
    """List the data sets and where to obtain them."""
    table(
        ("data set", "what", "licence", "where"),
        [(entry.name, entry.what, entry.licence, entry.origin) for entry in DATASETS],
    )
    print("\nCheck a copy: motioncast datasets check cmu --data FOLDER")


def check(name: str, /, *, data: Path) -> None:
    """Check a copy of a data set: every take is read once.

    Args:
        name: Name of the data set.
        data: Folder that holds it.
    """
    known = [entry.name for entry in DATASETS]
    if name not in known:
        raise InputError(f'there is no data set "{name}"; choose one of {", ".join(known)}')
    raise NotImplementedError
