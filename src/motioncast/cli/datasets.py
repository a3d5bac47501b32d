"""``motioncast datasets``: the data sets, where to obtain them, and whether a copy is whole."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from motioncast.cli import say
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
        "99 clips of one person and a ball, on another skeleton; CMU takes beside them are read with cmu",
        "Apache-2.0 (BallPlay-M of SkillMimic)",
        "github.com/wyhuai/SkillMimic, skillmimic/data/motions",
    ),
)


def datasets() -> None:
    """List the data sets and where to obtain them."""
    for entry in DATASETS:
        print(f"{entry.name}: {entry.what}\n  licence: {entry.licence}\n  from:    {entry.origin}")
    print("\ncheck a copy: motioncast datasets check cmu --data FOLDER")


def check(name: str, /, *, data: Path) -> None:
    """Check a copy of a data set: every take is read once.

    Args:
        name: Name of the data set.
        data: Folder that holds it.
    """
    if name == "cmu":
        _check_cmu(data)
    elif name == "extra":
        _check_ball_players(data)
    else:
        known = ", ".join(entry.name for entry in DATASETS)
        raise InputError(f'there is no data set "{name}"; choose one of {known}')


def _check_cmu(data: Path) -> None:
    from motioncast.datasets import cmu

    takes = cmu.takes(data)
    split = {take.name: take.split for take in takes}
    counts = {name: [0, 0.0, 0] for name in ("train", "validation", "test")}
    with say.progress("reading every take") as progress:
        for number, scene in enumerate(cmu.read(takes), 1):
            count = counts[split[scene.people[0]]]
            count[0] += 1
            count[1] += scene.duration_s / 60
            count[2] += int((~scene.observed.any((1, 2))).sum())
            progress(number / len(takes))
    rows = [(name, takes, f"{minutes:.1f}", gaps) for name, (takes, minutes, gaps) in counts.items()]
    say.table(("split", "takes", "minutes", "frames masked as jumps"), rows)


def _check_ball_players(data: Path) -> None:
    from motioncast.datasets import ballplay

    clips = list(ballplay.read(data))
    print(f"{len(clips)} clips, {sum(clip.duration_s for clip in clips) / 60:.1f} minutes")
