"""What an annotator works on: motions, their characteristic moments, and the tables that keep them."""

from __future__ import annotations

import base64
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from motioncast.core.scene import Scene
from motioncast.datasets.moments import extents, moments
from motioncast.errors import InputError
from motioncast.formats.files import read_bytes
from motioncast.formats.moments_tsv import SOURCES, Moment, read_moments, write_moments

SHOWN_FPS = 31.0
"""Frames beyond this rate are left out of what is shown; moments lie on those that are."""

MOST_NOTE = 200

HELD = 3
"""Motions that are held at once: the one that is shown, the one before and the next."""


@dataclass(frozen=True, slots=True)
class Motion:
    """A motion that can be annotated.

    Attributes:
        name: Its name in tables.
        load: Reads it.
        table: The table of its moments; several motions may share one.
    """

    name: str
    load: Callable[[], Scene]
    table: Path


class Desk:
    """Motions to annotate, one after the other; what was annotated before is read from their tables.

    Args:
        motions: The motions.

    Raises:
        InputError: If there is none, or two of one table have one name.
        FormatError: If a table is damaged.
    """

    def __init__(self, motions: Sequence[Motion]) -> None:
        if not motions:
            raise InputError("no motion came; give motion files, or a folder of takes with --data")
        self.motions = tuple(motions)
        names = [(motion.table, motion.name) for motion in motions]
        twice = next((name for _, name in names if names.count((_, name)) > 1), None)
        if twice is not None:
            raise InputError(
                f'two motions are called "{twice}"; give them other names, or annotate one after the other'
            )
        self.tables: dict[Path, list[Moment]] = {
            table: read_moments(table) if table.is_file() else []
            for table in dict.fromkeys(motion.table for motion in motions)
        }
        self._held: dict[int, Scene] = {}

    def listed(self) -> list[dict[str, Any]]:
        """Name of each motion, its moments, how many were not looked at, and whether it was seen at all."""
        rows = []
        for motion in self.motions:
            known = self._known(motion)
            unseen = sum(moment.source == "auto" for moment in known)
            rows.append({"name": motion.name, "moments": len(known), "open": unseen, "seen": bool(known)})
        return rows

    def opened(self, number: int) -> dict[str, Any]:
        """All that the page shows of a motion: joints, extents, and moments, found by the rule where none are known.

        Raises:
            InputError: If the motion cannot be read, or lacks joints that the rule needs.
        """
        scene, stride = self._scene(number)
        shown, motion, skeleton = scene[::stride], self.motions[number], scene.skeleton
        known = self._known(motion) or found(scene, motion.name)
        frames, fps = shown.frames, scene.fps / stride
        hips = [joint for side in ("left_hip", "right_hip") if (joint := skeleton.find(side)) is not None]
        return {
            "name": motion.name,
            "fps": fps,
            "people": scene.people,
            "bones": skeleton.bones,
            "hips": hips,
            "shape": shown.positions.shape,
            "positions": base64.b64encode(shown.positions.astype("<f4").tobytes()).decode(),
            "observed": base64.b64encode(shown.observed.astype(np.uint8).tobytes()).decode(),
            "extents": [extents(scene, person)[::stride].round(4).tolist() for person in range(len(scene.people))],
            "moments": [
                {
                    "frame": min(round(moment.second * fps), frames - 1),
                    "person": scene.people.index(moment.person),
                    "source": moment.source,
                    "note": moment.note,
                }
                for moment in known
                if moment.person in scene.people
            ],
        }

    def keep(self, number: int, rows: Any) -> None:
        """Keep the moments of a motion, as the page sends them: its table is written anew, whole.

        Raises:
            InputError: If they are not moments of this motion.
            OutputError: If the table cannot be written.
        """
        scene, stride = self._scene(number)
        motion = self.motions[number]
        frames = -(-scene.frames // stride)
        if not isinstance(rows, list) or not all(_sound(row, frames, len(scene.people)) for row in rows):
            raise InputError("what came are no moments of this motion; expected frame, person, source and note of each")
        away = [extents(scene, person) for person in range(len(scene.people))]
        kept = [
            Moment(
                motion.name, scene.people[row["person"]], row["frame"] * stride / scene.fps,
                float(away[row["person"]][row["frame"] * stride]), row["source"], " ".join(row["note"].split()),
            )
            for row in rows
        ]  # fmt: skip
        others = [moment for moment in self.tables[motion.table] if moment.take != motion.name]
        write_moments(motion.table, [*others, *kept])
        self.tables[motion.table] = [*others, *kept]

    def _known(self, motion: Motion) -> list[Moment]:
        return [moment for moment in self.tables[motion.table] if moment.take == motion.name]

    def _scene(self, number: int) -> tuple[Scene, int]:
        """A motion, held for when it is asked for again, and how many of its frames a shown one stands for."""
        scene = self._held.pop(number, None) or self.motions[number].load()
        self._held[number] = scene  # the last one that was asked for stands last
        if len(self._held) > HELD:
            del self._held[next(iter(self._held))]
        return scene, max(1, int(np.ceil(scene.fps / SHOWN_FPS)))


def found(scene: Scene, take: str) -> list[Moment]:
    """The moments that the rule finds in a motion."""
    return [
        Moment(take, name, moment.frame / scene.fps, moment.extent_m)
        for person, name in enumerate(scene.people)
        for moment in moments(scene, person)
    ]


def beside(file: Path) -> Path:
    """The table beside a motion file.

    Raises:
        InputError: If there is no such file.

    Example:
        >>> beside(Path(__file__)).name
        'annotate_desk.moments.tsv'
    """
    read_bytes(file, 1)
    return file.with_name(f"{file.stem}.moments.tsv")


def _sound(row: Any, frames: int, people: int) -> bool:
    """Whether a row is a moment of a motion of so many frames and people."""
    if not isinstance(row, dict) or set(row) != {"frame", "person", "source", "note"}:
        return False
    whole = all(type(row[key]) is int and 0 <= row[key] < end for key, end in (("frame", frames), ("person", people)))
    return whole and row["source"] in SOURCES and isinstance(row["note"], str) and len(row["note"]) <= MOST_NOTE
