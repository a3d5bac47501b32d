"""MPII Cooking 2: people who cook, 272 videos of a fixed camera, labelled step by step (Rohrbach et al., IJCV 2015).

Licence: research only; ask the Max Planck Institute for Informatics. Nothing of it is passed on here.

The owners' annotations are fields of a MATLAB 7.3 file, ``attributesAnnotations_MPII-Cooking-2.mat``. Its fields
``fileName``, ``startFrame``, ``endFrame`` and ``activity`` are read from ``annotations.csv``, which one line of MATLAB
writes, so that nobody needs a reader of HDF5:

    writetable(table(annos.fileName, annos.startFrame, annos.endFrame, annos.activity, 'VariableNames',
    {'fileName', 'startFrame', 'endFrame', 'activity'}), 'annotations.csv')

Frames count from 1 and ends are inclusive, as in MATLAB. FutureHuman3D merges 87 activities to 37 and leaves cupboards
and fridges out by a table that was not published: give yours as ``clusters.tsv`` (``datasets.video_folder``), with
poses, camera, objects and characteristic frames. Fields after what others read; no file was at hand to check against.
"""

from __future__ import annotations

import csv
from collections.abc import Iterator
from pathlib import Path

from motioncast.core.action_sequence import ActionSequence
from motioncast.datasets.video_folder import sequences_of
from motioncast.errors import FormatError, InputError
from motioncast.formats.files import read_text
from motioncast.formats.steps_tsv import Span

COLUMNS = ("fileName", "startFrame", "endFrame", "activity")


def labelled(folder: Path) -> dict[str, list[Span]]:
    """The labelled steps of each video, in order of time.

    Raises:
        InputError: If ``annotations.csv`` is missing.
        FormatError: If it is damaged.
    """
    path = folder / "annotations.csv"
    if not path.is_file():
        raise InputError(f"there is no file {path}; write it from the owners' MATLAB file as docs/datasets.md says")
    table = csv.DictReader(read_text(path).splitlines())
    if not set(COLUMNS) <= set(table.fieldnames or ()):
        raise FormatError(path, f"the columns are {table.fieldnames}; expected {', '.join(COLUMNS)}", 1)
    found: dict[str, list[Span]] = {}
    for line, row in enumerate(table, 2):
        try:
            first, end = int(float(row["startFrame"])) - 1, int(float(row["endFrame"]))
        except (TypeError, ValueError):
            raise FormatError(path, f"{row} has no numbers of frames", line) from None
        if not (0 <= first < end and row["activity"]):
            raise FormatError(path, f"{row} is no step; expected startFrame <= endFrame, and an activity", line)
        found.setdefault(row["fileName"], []).append(Span(first, end, row["activity"]))
    return {video: sorted(spans, key=lambda span: span.first) for video, spans in found.items()}


def sequences(folder: str | Path, split: str | None = None) -> Iterator[ActionSequence]:
    """The videos as steps; see ``datasets.video_folder`` for what the folder holds besides, and for errors."""
    folder = Path(folder)
    yield from sequences_of(folder, labelled(folder), split)
