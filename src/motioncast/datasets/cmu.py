"""CMU's motion capture: Acclaim files in archives or in a user's tree, and takes held as joint positions.

The folder given to :func:`takes` may hold any of

- ``cmu/``: ``index.csv`` and one ``cmu_NNN.tar.xz`` a subject (skeleton, and motion packed by columns),
- ``extra/``: ``index.csv`` and ``extra_cmu_*.npz`` (joint positions of further takes, z up),
- a tree of ``NN/NN.asf`` and ``NN/NN_TT.amc`` as CMU's site gives it,

or be one of these itself. Splits are by actor and fixed here; no figure is comparable when they move.

Licence: free for research and products, not to be resold directly. CMU asks for this text: The data used in
this project was obtained from mocap.cs.cmu.edu. The database was created with funding from NSF EIA-0196217.
"""

from __future__ import annotations

import csv
import re
import tarfile
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from motioncast.core.rotation import from_matrix
from motioncast.core.scene import Scene, join
from motioncast.core.skeletons import recognise
from motioncast.datasets.offsets import unpack
from motioncast.errors import FormatError, InputError
from motioncast.formats.asf_amc import Acclaim, parse_amc, parse_asf, scene_of
from motioncast.formats.files import read_text

SLOW_SUBJECTS = frozenset({60, 61, 143})
"""Recorded at 60 Hz; all other subjects at 120 Hz."""

VALIDATION_SUBJECTS = frozenset({3, 90, 135, 143})
TEST_SUBJECTS = frozenset({5, 7, 9, 11, 13, 14, 32, 35, 91, 131})
COUPLE = (60, 61)
"""Two people who dance salsa together, take by take in one world and on one clock."""

SAME_ACTOR = {16: 1, 17: 1, 18: 1, 20: 1}
"""Subjects whose skeletons carry the name of another subject's actor, and that subject."""

LAST_BAD_FRAME = {"16_15": 2}
"""Takes that start in a stretched-arm pose and jump out of it: frames to drop."""


@dataclass(frozen=True, slots=True)
class Take:
    """One take of one subject.

    Attributes:
        name: ``NN_TT``.
        subject: Number of the subject.
        number: Number of the take.
        fps: Frames a second.
        split: ``train``, ``validation`` or ``test``.
        place: Archive, npz file or AMC file that holds it.
        description: What is done, where an index says so.
    """

    name: str
    subject: int
    number: int
    fps: float
    split: str
    place: Path
    description: str = ""


def split_of(subject: int, number: int) -> str:
    """The split of a take: by subject, the couple by take.

    Example:
        >>> split_of(1, 4), split_of(35, 1), split_of(60, 11), split_of(60, 12), split_of(61, 15)
        ('train', 'test', 'train', 'validation', 'test')
    """
    if subject in COUPLE:
        return "train" if number <= 11 else "validation" if number <= 13 else "test"
    if subject in TEST_SUBJECTS:
        return "test"
    return "validation" if subject in VALIDATION_SUBJECTS else "train"


def takes(folder: str | Path, split: str | None = None) -> list[Take]:
    """The takes that a folder holds, in the order of their numbers.

    Raises:
        InputError: If the folder holds none, saying what was looked for.
    """
    folder = Path(folder)
    if not folder.is_dir():
        raise InputError(f"there is no folder {folder}; give the folder that holds CMU's files")
    found: dict[str, Take] = {}
    for place in (folder, folder / "cmu", folder / "extra"):
        for take in (*_packed(place), *_positions_only(place)):
            found.setdefault(take.name, take)
    if not found:
        for take in _tree(folder):
            found.setdefault(take.name, take)
    if not found:
        raise InputError(
            f"{folder} holds no CMU motion; expected cmu_NNN.tar.xz with index.csv, extra_cmu_*.npz with index.csv, "
            "or NN/NN_TT.amc beside NN/NN.asf"
        )
    ordered = sorted(found.values(), key=lambda take: (take.subject, take.number))
    return [take for take in ordered if split is None or take.split == split]


def _take(name: str, place: Path, description: str = "") -> Take:
    subject, number = (int(part) for part in name.split("_"))
    fps = 60.0 if subject in SLOW_SUBJECTS else 120.0
    return Take(name, subject, number, fps, split_of(subject, number), place, description)


def _rows(place: Path) -> list[dict[str, str]]:
    index = place / "index.csv"
    return list(csv.DictReader(read_text(index).splitlines())) if index.is_file() else []


def _packed(place: Path) -> Iterator[Take]:
    for row in _rows(place):
        if row.get("archive", "").endswith(".tar.xz"):
            yield _take(row["name"], place / row["archive"], row.get("description", ""))


def _positions_only(place: Path) -> Iterator[Take]:
    for row in _rows(place):
        if row.get("archive", "").startswith("extra_cmu_"):
            yield _take(row["id"], place / row["archive"], row.get("description", ""))


def _tree(folder: Path) -> Iterator[Take]:
    for amc in sorted(folder.rglob("*.amc")):
        if re.fullmatch(r"\d+_\d+", amc.stem):
            yield _take(amc.stem, amc)


def read(takes: list[Take]) -> Iterator[Scene]:
    """The scenes of some takes, one person each, in the given order of files; each file is opened once.

    Frames in which the capture jumps (see :func:`sound`) are marked as not observed.

    Raises:
        InputError: If a file is missing.
        FormatError: If one is damaged.
    """
    by_place: dict[Path, list[Take]] = {}
    for take in takes:
        by_place.setdefault(take.place, []).append(take)
    for place, group in by_place.items():
        if not place.is_file():
            raise InputError(f"{place} is missing; its index names it for {', '.join(take.name for take in group)}")
        reader = {".xz": _read_archive, ".npz": _read_positions, ".amc": _read_tree}[place.suffix]
        for scene in reader(place, group):
            scene = scene[LAST_BAD_FRAME.get(scene.people[0], 0) :]
            yield replace(scene, observed=scene.observed & sound(scene)[..., None])


def couples(folder: str | Path, split: str | None = None) -> Iterator[Scene]:
    """The takes of the dancing couple, two people each.

    Raises:
        InputError: If one of the two is missing.
    """
    wanted = [take for take in takes(folder, split) if take.subject in COUPLE]
    people = {scene.people[0]: scene for scene in read(wanted)}
    for number in sorted({take.number for take in wanted}):
        names = [f"{subject}_{number:02d}" for subject in COUPLE]
        missing = [name for name in names if name not in people]
        if missing:
            raise InputError(f"take {missing[0]} is missing; a couple's scene needs {' and '.join(names)}")
        yield join([people[name] for name in names])


def acclaim(take: Take) -> tuple[Acclaim, dict[str, np.ndarray]]:
    """Skeleton and channel values of a take that an archive holds."""
    ((_, skeleton, values),) = _motions(take.place, [take])
    return skeleton, values


def _read_archive(place: Path, group: list[Take]) -> Iterator[Scene]:
    for take, skeleton, values in _motions(place, group):
        yield scene_of(skeleton, values, take.fps, take.name, f"CMU {take.name}")


def _motions(place: Path, group: list[Take]) -> Iterator[tuple[Take, Acclaim, dict[str, np.ndarray]]]:
    wanted = {f"{take.name}.colamc": take for take in group}
    skeleton: Acclaim | None = None
    packed: dict[str, str] = {}
    try:
        with tarfile.open(place, "r:xz") as archive:
            for member in archive:
                name = Path(member.name).name
                stream = archive.extractfile(member)
                if stream is None or not (name.endswith(".asf") or name in wanted):
                    continue
                text = stream.read().decode("latin-1")
                if name.endswith(".asf"):
                    skeleton = parse_asf(text, f"{place}/{name}")
                else:
                    packed[name] = text
    except (tarfile.TarError, EOFError, OSError) as error:
        raise FormatError(place, f"the archive is damaged ({error}); fetch it again") from None
    if skeleton is None:
        raise FormatError(place, "the archive holds no .asf skeleton")
    for name, take in wanted.items():
        if name not in packed:
            raise FormatError(place, f"the archive lacks {name}, which its index names")
        yield take, skeleton, _unpack(packed.pop(name), f"{place}/{name}")


def _unpack(text: str, path: str) -> dict[str, np.ndarray]:
    """The values of each bone from a motion packed by columns (COLAMC 1)."""
    lines = text.split("\n")
    try:
        if lines[0] != "COLAMC 1":
            raise ValueError
        header, _, frames, bones, _ = map(int, lines[1].split())
        start = 2 + header
        widths = [line.rsplit(" ", 1) for line in lines[start : start + bones]]
        start += bones
        values = {}
        for name, width in widths:
            end = start + int(width) * frames
            values[name] = np.array(lines[start:end], dtype=np.float64).reshape(int(width), frames).T
            start = end
    except (ValueError, IndexError):
        raise FormatError(path, "not a whole COLAMC 1 text; fetch the archive again") from None
    return values


def _read_positions(place: Path, group: list[Take]) -> Iterator[Scene]:
    with np.load(place, allow_pickle=False) as data:
        names = [str(name) for name in data["joint_names"]]
        skeleton = recognise(names, [int(parent) for parent in data["parents"]], "cmu31")
        for take in group:
            yield Scene(unpack(data, take.name), skeleton, take.fps, people=(take.name,), source=f"CMU {take.name}")


def _read_tree(place: Path, group: list[Take]) -> Iterator[Scene]:
    take = group[0]
    skeletons = sorted(place.parent.glob("*.asf"))
    asf = next((path for path in skeletons if path.stem.lstrip("0") == str(take.subject)), None)
    if asf is None:
        raise InputError(f"{place} has no {take.subject:02d}.asf beside it; an AMC file needs its subject's skeleton")
    skeleton = parse_asf(read_text(asf), asf)
    yield scene_of(skeleton, parse_amc(read_text(place), skeleton, place), take.fps, take.name, f"CMU {take.name}")


def sound(scene: Scene, turn_deg: float = 25.0, speed_m_s: float = 30.0, reach: int = 2) -> np.ndarray:
    """Frames without a jump of the capture, ``(time, people)`` bool.

    A frame is unsound where the pelvis turns, or a joint other than the hands moves, faster than a person can;
    so are its neighbours and the few frames between two jumps.

    Args:
        scene: People with a pelvis, hips and a lower spine.
        turn_deg: Largest turn of the pelvis from frame to frame, in degrees.
        speed_m_s: Largest speed of a joint.
        reach: Frames on either side that are left out too.
    """
    places = scene.skeleton.landmarks
    pelvis, left, right, spine = (
        scene.positions[:, :, places.index(name)].astype(np.float64)
        for name in ("pelvis", "left_hip", "right_hip", "lower_spine")
    )
    across = left - right
    x = across / np.linalg.norm(across, axis=-1, keepdims=True)
    z = np.cross(x, np.cross(spine - pelvis, x))
    z /= np.linalg.norm(z, axis=-1, keepdims=True)
    facing = from_matrix(np.stack([x, np.cross(z, x), z], -1))
    cosine = np.abs((facing[1:] * facing[:-1]).sum(-1)).clip(0, 1)
    hands = ("wrist", "hand", "fingers", "thumb")
    body = [joint for joint, place in enumerate(places) if not place.endswith(hands)]
    speed = np.linalg.norm(np.diff(scene.positions[:, :, body], axis=0), axis=-1).max(-1) * scene.fps
    jumps = (np.degrees(2 * np.arccos(cosine)) > turn_deg) | (speed > speed_m_s)
    good = np.ones(scene.positions.shape[:2], bool)
    for person in range(len(scene.people)):
        at = np.flatnonzero(jumps[:, person])
        for first in at:
            later = at[(at > first) & (at <= first + scene.fps / 5)]
            last = later[-1] if len(later) else first
            good[max(0, first + 1 - reach) : last + 1 + reach, person] = False
    return good
