"""Every data set that motioncast reads: licence, size, where to obtain it, and whether a copy is whole.

A data set is one module of this folder that defines ``DATASET``; nothing else lists it.
"""

from __future__ import annotations

import difflib
import pkgutil
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from typing import Literal

import numpy as np

from motioncast.core.scene import Scene
from motioncast.errors import InputError, MotioncastError

LIMB_M = (0.2, 0.6)
"""Thighs, shins, upper arms and forearms of people are this long; outside, a unit is wrong."""

LIMBS = tuple(
    (f"{side}_{start}", f"{side}_{end}")
    for side in ("left", "right")
    for start, end in (("hip", "knee"), ("knee", "ankle"), ("shoulder", "elbow"), ("elbow", "wrist"))
)


@dataclass(frozen=True, slots=True)
class Finding:
    """Something that a check found.

    Attributes:
        kind: Whether it is as it must be, not there, or there and odd.
        what: One sentence.
    """

    kind: Literal["there", "missing", "odd"]
    what: str


@dataclass(frozen=True, slots=True)
class DataSet:
    """A data set, as its owners give it out.

    Attributes:
        name: Short name.
        what: What it holds.
        licence: What one may do with it.
        size: How large it is.
        origin: Where to obtain it.
        files: Patterns of the files that a copy must hold, anywhere below its folder; `` or `` between alternatives.
        parts: The files of a copy that are read one by one.
        read: The scenes of such a part.
        split: Under which name a scene is counted.
    """

    name: str
    what: str
    licence: str
    size: str
    origin: str
    files: tuple[str, ...]
    parts: Callable[[Path], Sequence[Path]]
    read: Callable[[Path], Iterator[Scene]]
    split: Callable[[Scene], str] = lambda scene: "all"

    def scenes(self, folder: Path) -> Iterator[Scene]:
        """All scenes of a copy.

        Raises:
            InputError: If the folder is missing or holds none of the files.
            FormatError: If a file is damaged.
        """
        parts = self._parts(folder)
        if not parts:
            raise InputError(f"{folder} holds no {', no '.join(self.files)}; obtain {self.name} from {self.origin}")
        for part in parts:
            yield from self.read(part)

    def check(self, folder: Path, progress: Callable[[float], None] = lambda share: None) -> list[Finding]:
        """What a copy has, what it lacks and what is odd in it; every scene is read once.

        Args:
            folder: The copy.
            progress: Is told the share that is done.

        Raises:
            InputError: If there is no such folder.
        """
        parts = self._parts(folder)
        findings = [_looked_for(folder, pattern) for pattern in self.files]
        counts: dict[str, _Count] = {}
        for number, part in enumerate(parts, 1):
            try:
                for scene in self.read(part):
                    counts.setdefault(self.split(scene), _Count()).add(scene)
                    findings += [Finding("odd", f"{scene.source}: {oddity}") for oddity in oddities(scene)]
            except MotioncastError as error:
                findings.append(Finding("odd", str(error)))
            progress(number / len(parts))
        return findings + [Finding("there", f"{name}: {count}") for name, count in counts.items()]

    def _parts(self, folder: Path) -> Sequence[Path]:
        if not folder.is_dir():
            raise InputError(f"there is no folder {folder}; give the folder that holds {self.name}")
        return self.parts(folder)


@dataclass(slots=True)
class _Count:
    """What some scenes hold together."""

    scenes: int = 0
    seconds: float = 0.0
    people: int = 0
    unseen: int = 0

    def add(self, scene: Scene) -> None:
        self.scenes += 1
        self.seconds += scene.duration_s
        self.people = max(self.people, len(scene.people))
        self.unseen += int((~scene.observed.any((1, 2))).sum())

    def __str__(self) -> str:
        crowd = "one person" if self.people == 1 else f"up to {self.people} people"
        masked = f", {self.unseen:,} frames masked" if self.unseen else ""
        return f"{self.scenes:,} scenes of {crowd}, {self.seconds / 60:,.1f} minutes{masked}"


def catalogue() -> dict[str, DataSet]:
    """Every data set by name.

    Example:
        >>> "threedpw" in catalogue(), catalogue()["cmu"].licence
        (True, 'free to use, not to be resold; acknowledge CMU (see NOTICE)')
    """
    package = __package__ or ""
    modules = (import_module(f"{package}.{entry.name}") for entry in pkgutil.iter_modules([str(Path(__file__).parent)]))
    found = [module.DATASET for module in modules if hasattr(module, "DATASET")]
    return {entry.name: entry for entry in sorted(found, key=lambda entry: entry.name)}


def data_set(name: str) -> DataSet:
    """The data set of a name.

    Raises:
        InputError: If there is none, naming the closest.
    """
    known = catalogue()
    if name in known:
        return known[name]
    close = difflib.get_close_matches(name, known, 1, 0.3)
    advice = f'did you mean "{close[0]}"? ' if close else ""
    raise InputError(f'there is no data set "{name}"; {advice}choose one of {", ".join(known)}')


def below(folder: Path, *patterns: str) -> list[Path]:
    """The files below a folder whose name or path fits one of some patterns, sorted, each once."""
    return sorted({path for pattern in patterns for path in folder.rglob(pattern) if path.is_file()})


def limb_lengths(scene: Scene) -> dict[str, float]:
    """Median length in metres of each thigh, shin, upper arm and forearm that is seen."""
    lengths: dict[str, float] = {}
    for start, end in LIMBS:
        a, b = scene.skeleton.find(start), scene.skeleton.find(end)
        if a is None or b is None:
            continue
        seen = scene.observed[:, :, a] & scene.observed[:, :, b]
        if seen.any():
            bones = np.linalg.norm(scene.positions[:, :, a] - scene.positions[:, :, b], axis=-1)
            lengths[f"{start} to {end}"] = float(np.median(bones[seen]))
    return lengths


def metric(scene: Scene) -> Scene:
    """The scene itself, if its limbs have the length of people's.

    Raises:
        InputError: If one has not: the unit is not what it was taken for.
    """
    for bone, length in limb_lengths(scene).items():
        if not LIMB_M[0] <= length <= LIMB_M[1]:
            raise InputError(
                f"{scene.source}: {bone} is {length:.3g} m; expected {LIMB_M[0]} to {LIMB_M[1]} m, so the file is in "
                "another unit than its release; get the release's own file"
            )
    return scene


def oddities(scene: Scene) -> Iterator[str]:
    """What is odd in a scene that could be read, one sentence each."""
    for bone, length in limb_lengths(scene).items():
        if not LIMB_M[0] <= length <= LIMB_M[1]:
            yield f"{bone} is {length:.3g} m; people's are {LIMB_M[0]} to {LIMB_M[1]} m"
    if scene.frames < 2:
        yield f"it has {scene.frames} frames"
    elif scene.observed.all() and not np.ptp(scene.positions, axis=0).any():
        yield "nobody moves"


def _looked_for(folder: Path, pattern: str) -> Finding:
    found = below(folder, *pattern.split(" or "))
    if not found:
        return Finding("missing", pattern)
    size = sum(path.stat().st_size for path in found) / 1e6
    return Finding("there", f"{pattern}: {len(found):,} files, {size:,.1f} MB")
