"""Humans in Kitchens: four kitchens, up to 16 people at once, 25 frames a second, 29 joints, metres, z up.

The user's own copy holds ``poses/{A|B|C|D}_PID_SEQ.npz``: one stay of one person, ``poses3d`` (frames, 29, 3) and
``frames`` (their numbers in the recording, from 1). ``scenes/`` is read by ``hik_furniture.py``. Kitchens A, B and C
train, D tests; 16 of D's 24 people are in the training kitchens too.

The evaluation list ``test.json`` (public, with the owners' code) names 961 items of D (and 2,057 of the others): an
action, the person who does it, and the first frame to forecast. The 250 frames before are history, the 250 from it on
the future; who is there at that frame belongs to the item. (The paper calls that frame the last one seen; the owners'
code does not, and is followed.) The owners score the acting person only.

6 % of the poses were filled in by a generative model, and nothing says which. Names, shapes and the counting of frames
are those of the owners' code; no file of poses was at hand to check them against. The list was.
"""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from motioncast.core.scene import Scene
from motioncast.core.skeletons import HIK29
from motioncast.datasets.catalogue import DataSet, below, metric
from motioncast.errors import FormatError, InputError
from motioncast.formats.files import read_text
from motioncast.formats.pickles import read_members

FPS = 25.0
TRAIN, TEST = ("A", "B", "C"), ("D",)
HISTORY = HORIZON = 250


@dataclass(frozen=True, slots=True)
class Item:
    """One item of the evaluation list.

    Attributes:
        kitchen: ``A`` to ``D``.
        action: What the person does, such as ``walking``.
        person: The person who does it.
        frame: The first frame to forecast.
    """

    kitchen: str
    action: str
    person: int
    frame: int


@dataclass(frozen=True, slots=True)
class Stay:
    """One person's stay in a kitchen: a file and its frames."""

    path: Path
    kitchen: str
    person: int
    first: int
    last: int


def items(path: str | Path, kitchen: str = "D") -> list[Item]:
    """The items of a kitchen in an evaluation list, in its order.

    Args:
        path: ``test.json``, or a folder that holds it.
        kitchen: ``A`` to ``D``.

    Raises:
        InputError: If there is no such file.
        FormatError: If it is of another layout.
    """
    path = Path(path)
    if path.is_dir():
        path = next(iter(below(path, "test.json")), path / "test.json")
    try:
        actions = json.loads(read_text(path))[kitchen]
        found = [
            Item(kitchen, action, entry["pid"], entry["frame"])
            for action, entries in actions.items()
            for entry in entries
        ]
    except (ValueError, TypeError, KeyError, AttributeError, RecursionError):
        raise FormatError(
            path, f'is no evaluation list with the kitchen "{kitchen}"; get the owners\' test.json'
        ) from None
    if not all(type(item.person) is int and type(item.frame) is int for item in found):
        raise FormatError(path, "has an item whose pid or frame is no whole number; get the owners' test.json")
    return found


def stays(folder: str | Path, kitchens: tuple[str, ...] = (*TRAIN, *TEST)) -> list[Stay]:
    """Every stay of every person in some kitchens, from the files' names and frame numbers.

    Raises:
        FormatError: If a file is damaged.
    """
    found = []
    for path in takes(folder):
        kitchen, person, _ = path.stem.split("_")
        if kitchen in kitchens:
            frames = _frames(path, read_members(path, ("frames",)))
            found.append(Stay(path, kitchen, int(person), int(frames[0]), int(frames[-1])))
    return found


def window(present: list[Stay], item: Item, history: int = HISTORY, horizon: int = HORIZON) -> Scene:
    """The people of an item, over its history and its future.

    Args:
        present: The stays of the kitchen (``stays``).
        item: The item.
        history: Frames before the item's frame.
        horizon: Frames from it on.

    Returns:
        A scene of everybody who is there at the item's frame, the acting person first; a person is observed while
        the stay lasts.

    Raises:
        InputError: If the acting person is not there.
        FormatError: If a file is damaged.
    """
    there = [stay for stay in present if stay.kitchen == item.kitchen and stay.first <= item.frame <= stay.last]
    there.sort(key=lambda stay: (stay.person != item.person, stay.person))
    if not there or there[0].person != item.person:
        raise InputError(
            f"person {item.person} is not in kitchen {item.kitchen} at frame {item.frame}, as the evaluation list "
            "says; the copy lacks files"
        )
    positions = np.zeros((history + horizon, len(there), len(HIK29), 3), np.float32)
    observed = np.zeros(positions.shape[:3], bool)
    for column, stay in enumerate(there):
        poses, frames = _poses(stay.path)
        rows = frames - (item.frame - history)
        inside = (rows >= 0) & (rows < len(positions))
        positions[rows[inside], column] = poses[inside]
        observed[rows[inside], column] = True
    source = f"HiK {item.kitchen} {item.action} {item.frame}"
    return Scene(positions, HIK29, FPS, observed, tuple(f"person {stay.person}" for stay in there), source=source)


def takes(folder: str | Path) -> list[Path]:
    """The files of all stays."""
    return [path for path in below(Path(folder), "poses/*.npz") if re.fullmatch(r"[A-D]_\d+_\d+", path.stem)]


def read(path: str | Path) -> Iterator[Scene]:
    """The scene of one stay of one person; frames that its numbers leave out are not observed.

    Raises:
        InputError: If there is no such file, or its limbs are no people's.
        FormatError: If it is damaged or of another layout.
    """
    path = Path(path)
    poses, frames = _poses(path)
    rows = frames - frames[0]
    positions = np.zeros((int(rows[-1]) + 1, 1, len(HIK29), 3), np.float32)
    observed = np.zeros(positions.shape[:3], bool)
    positions[rows, 0], observed[rows] = poses, True
    person = path.stem.split("_")[1]
    yield metric(Scene(positions, HIK29, FPS, observed, (f"person {person}",), source=f"HiK {path.stem}"))


def _poses(path: Path) -> tuple[np.ndarray, np.ndarray]:
    data = read_members(path, ("poses3d", "frames"))
    poses, frames = np.asarray(data.get("poses3d")), _frames(path, data)
    if poses.dtype.kind != "f" or poses.shape != (len(frames), len(HIK29), 3) or not np.isfinite(poses).all():
        raise FormatError(path, f"has poses3d of shape {poses.shape}; expected {len(frames)} poses of 29 finite joints")
    return poses.astype(np.float32), frames


LONGEST = 200_000
"""More frames than any of the recordings has."""


def _frames(path: Path, data: dict[str, Any]) -> np.ndarray:
    frames = np.asarray(data.get("frames"))
    if frames.dtype.kind not in "iuf" or frames.ndim != 1 or not len(frames):
        raise FormatError(path, "has no frame numbers; expected a stay of Humans in Kitchens")
    if not (np.diff(frames) > 0).all() or frames[0] < 0 or frames[-1] > LONGEST:
        raise FormatError(path, f"has frame numbers that do not rise from 0 to {LONGEST:,} at most; get the file again")
    return frames.astype(np.int64)


DATASET = DataSet(
    "hik",
    "Humans in Kitchens, up to 16 people at once in four kitchens; 29 joints, 25 fps",
    "non-commercial research only; the list of test items is MIT",
    "90 people, 7 hours, 4 million poses, about 4 GB",
    "github.com/jutanke/hik",
    ("poses/A_*.npz", "poses/B_*.npz", "poses/C_*.npz", "poses/D_*.npz", "test.json"),
    takes,
    read,
)
