"""Labelled videos of a data set and what its owners never published: the user's own tables beside them.

A folder holds, whatever the data set:

- ``poses/NAME``: what a detector found in the video NAME, a folder of OpenPose's or ``NAME.json`` in COCO's layout,
- ``camera.json``: the camera (``datasets.videos.read_camera``),
- ``clusters.tsv``: columns ``label`` and ``cluster``; steps whose cluster is empty or whose label is not listed are
  left out. Without the file every label stands for itself,
- ``characteristic.tsv``: columns ``video``, ``first``, ``frame``. Without the file, or a line for a step, the most
  articulated pose is taken,
- ``objects.tsv``: columns ``video`` and ``object``, a line for each thing that is seen at the start.
"""

from __future__ import annotations

import csv
import hashlib
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path

from motioncast.core.action_sequence import ActionSequence
from motioncast.datasets.videos import read_camera, steps_of
from motioncast.errors import FormatError, InputError
from motioncast.formats.files import read_text
from motioncast.formats.openpose import read_keypoints
from motioncast.formats.steps_tsv import Span

SHARES = {"train": 0.7, "validation": 0.15, "test": 0.15}
"""How many sequences each split has, as the text splits them; which ones it does not say."""


def split_of(video: str) -> str:
    """The split of a video: by a hash of its name, so that it stays when others come.

    Example:
        >>> split_of("s08-d02-cam-002") in SHARES
        True
    """
    place = int(hashlib.sha256(video.encode()).hexdigest()[:8], 16) / 2**32
    return "train" if place < 0.7 else "validation" if place < 0.85 else "test"


def sequences_of(
    folder: Path, labelled: Mapping[str, Sequence[Span]], split: str | None = None
) -> Iterator[ActionSequence]:
    """The videos of a folder as steps; those without poses are passed over.

    Args:
        folder: The folder.
        labelled: The steps of each video as its owners label them.
        split: ``train``, ``validation`` or ``test``. Default: all.

    Raises:
        InputError: If no video has poses, or the camera is missing.
        FormatError: If a file is damaged.
        SceneError: If a step lies outside its video, or its pose is not seen.
    """
    camera = read_camera(folder / "camera.json")
    clusters = {row["label"]: row["cluster"] for row in _rows(folder / "clusters.tsv", "label", "cluster")}
    named = {
        (row["video"], int(row["first"])): int(row["frame"])
        for row in _rows(folder / "characteristic.tsv", "video", "first", "frame", numbers=("first", "frame"))
    }
    objects: dict[str, list[str]] = {}
    for row in _rows(folder / "objects.tsv", "video", "object"):
        objects.setdefault(row["video"], []).append(row["object"])
    some = False
    for video, spans in sorted(labelled.items()):
        poses = next((path for path in _places(folder / "poses", video) if path.exists()), None)
        kept = [
            replace(span, action=clusters.get(span.action, span.action), characteristic=named.get((video, span.first)))
            for span in spans
            if not clusters or clusters.get(span.action)
        ]
        if poses is None or not kept:
            continue
        some = True
        if split in (None, split_of(video)):
            yield steps_of(video, read_keypoints(poses), kept, camera, objects.get(video, ()))
    if not some:
        raise InputError(
            f"{folder / 'poses'} shows none of the {len(labelled)} labelled videos; run a detector on them"
        )


def _places(folder: Path, video: str) -> tuple[Path, Path]:
    """Where the poses of a video may be; names with a slash are folders."""
    return folder / video, folder / f"{video}.json"


def _rows(path: Path, *columns: str, numbers: Sequence[str] = ()) -> list[dict[str, str]]:
    """The lines of a table between tabs; none where there is no such file."""
    if not path.is_file():
        return []
    table = csv.DictReader(read_text(path).splitlines(), delimiter="\t")
    if not set(columns) <= set(table.fieldnames or ()):
        raise FormatError(path, f"the columns are {table.fieldnames}; expected {', '.join(columns)} between tabs", 1)
    found = []
    for line, row in enumerate(table, 2):
        values = {column: (row[column] or "").strip() for column in columns}
        if any(not values[column].isdigit() for column in numbers):
            raise FormatError(path, f"{values} has no numbers in {', '.join(numbers)}", line)
        found.append(values)
    return found
