"""IKEA ASM: people who assemble furniture, 370 videos of three fixed cameras (Ben-Shabat et al., WACV 2021).

Licence: CC BY-NC-SA 4.0; obtain it from ikeaasm.github.io. Nothing of it is passed on here.

The owners' ``gt_segments.json`` holds, under ``database``, a name for each video, such as
``Lack_Coffee_Table/0007_white_floor_...``, with ``annotation``: a list of ``label`` and ``segment``, the first and the
last frame from 0. ``NA`` is no action. No objects are labelled. The split of FutureHuman3D is by chance and not
published; the owners' own, by room, is not used. Give poses, camera and characteristic frames as
``datasets.video_folder`` says. Layout after what others read; no file was at hand to check it against.
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path

from motioncast.core.action_sequence import ActionSequence
from motioncast.datasets.video_folder import sequences_of
from motioncast.errors import FormatError, InputError
from motioncast.formats.files import read_text
from motioncast.formats.steps_tsv import Span

NOTHING = "NA"


def labelled(folder: Path) -> dict[str, list[Span]]:
    """The labelled steps of each video, in order of time.

    Raises:
        InputError: If ``gt_segments.json`` is missing.
        FormatError: If it is damaged.
    """
    path = folder / "gt_segments.json"
    if not path.is_file():
        raise InputError(f"there is no file {path}; obtain IKEA ASM's annotations from ikeaasm.github.io")
    try:
        database = json.loads(read_text(path))["database"]
        found = {
            video: [
                Span(int(entry["segment"][0]), int(entry["segment"][1]) + 1, str(entry["label"]))
                for entry in told["annotation"]
                if entry["label"] != NOTHING
            ]
            for video, told in database.items()
        }
    except (ValueError, KeyError, TypeError, IndexError, AttributeError, RecursionError):
        raise FormatError(path, 'no "database" of videos with "annotation", "segment" and "label"') from None
    for video, spans in found.items():
        if any(not 0 <= span.first < span.end for span in spans):
            raise FormatError(path, f"a segment of {video} ends before it begins")
    return {video: sorted(spans, key=lambda span: span.first) for video, spans in found.items()}


def sequences(folder: str | Path, split: str | None = None) -> Iterator[ActionSequence]:
    """The videos as steps; see ``datasets.video_folder`` for what the folder holds besides, and for errors."""
    folder = Path(folder)
    yield from sequences_of(folder, labelled(folder), split)
