"""Characteristic poses of CMU's takes: what came before each, and the pose itself.

The moments stand in ``data/cmu_goals.tsv``: found by the rule of ``moments``, then corrected by eye (column source).
Splits are those of ``cmu``. The 17 joints are Human3.6M's; CMU's body has the base of the skull in the place of the
nose and the middle of the head in that of its top.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from importlib import resources
from pathlib import Path

import numpy as np

from motioncast.core.scene import Scene
from motioncast.core.skeletons import H36M17
from motioncast.datasets import cmu
from motioncast.datasets.windows import every
from motioncast.formats.moments_tsv import Moment, read_moments

FPS = 30.0
HISTORY = 10
"""Frames that a model is handed: a third of a second."""

SHORTEST_SPAN = 14
"""A moment that follows the one before, or a gap of the capture, after fewer frames is left out."""

STARTS = (0.0, 1 / 3, 1 / 2, 2 / 3, 1.0)
"""The five starting points, as shares of the way from the first possible history to the last."""

KINDS: dict[str, tuple[str, ...]] = {
    "climb": ("playground",),
    "couple": ("salsa",),
    "dance": ("dance", "dancing", "lambada"),
    "fight": ("boxing", "punch", "sword", "martial"),
    "signal": ("signals", "direct traffic", "wash windows", "high-five"),
    "ball": ("basketball", "soccer"),
    "exercise": ("jumping jacks", "cartwheel", "balance", "acrobatics", "bend over", "wash self"),
    "jump": ("jump", "hop"),
    "run": ("run",),
    "walk": ("walk", "navigate"),
}
"""Coarse kinds of takes, and the words of CMU's descriptions that tell them; the first that fits counts."""


@dataclass(frozen=True, slots=True, eq=False)
class GoalSample:
    """A characteristic pose and the way to it.

    Attributes:
        take: Name of the take.
        person: Who; the same name where people are recorded one by one.
        second: When the pose is reached, from the first frame of the take.
        history: The person from the moment before up to the frame before the pose, ``(frames, 17, 3)`` metres, z up.
        target: The pose, ``(17, 3)`` metres in the same world.
        partner: Who dances with them, on the clock of the history, ``(frames, 17, 3)``; None for who is alone.
    """

    take: str
    person: str
    second: float
    history: np.ndarray
    target: np.ndarray
    partner: np.ndarray | None = None


def table() -> Path:
    """The table of moments that comes with the package."""
    return Path(str(resources.files("motioncast"))) / "data" / "cmu_goals.tsv"


def goal_samples(data: str | Path, split: str, moments: str | Path | None = None) -> Iterator[GoalSample]:
    """The samples of a split, take by take in the order of time.

    Args:
        data: Folder of CMU's takes, as ``cmu.takes`` wants it.
        split: ``train``, ``validation`` or ``test``.
        moments: Another table of moments than the package's.

    Raises:
        InputError: If the folder holds no takes of the split, or the table is missing.
        FormatError: If a file is damaged.
    """
    found: dict[str, list[Moment]] = {}
    for moment in read_moments(moments or table()):
        if moment.source != "rejected":
            found.setdefault(moment.person, []).append(moment)
    for scene in goal_scenes(data, split):
        yield from samples_of(scene, found)


def kinds(data: str | Path) -> dict[str, str]:
    """The coarse kind of each take that an index describes; a take holds more than its kind says."""
    return {take.name: kind for take in cmu.takes(data) if (kind := kind_of(take.description))}


def kind_of(description: str) -> str:
    """The first of ``KINDS`` of which a word is in a description; empty if there is none.

    Example:
        >>> kind_of("soccer - kick ball"), kind_of("dance - lean forward"), kind_of("Walk digital figure eight")
        ('ball', 'dance', 'walk')
    """
    told = description.lower()
    return next((kind for kind, words in KINDS.items() if any(word in told for word in words)), "")


def goal_scenes(data: str | Path, split: str) -> Iterator[Scene]:
    """The takes of a split at 30 frames a second on 17 joints, the couple's two by two."""
    alone = [take for take in cmu.takes(data, split) if take.subject not in cmu.COUPLE]
    for scene in (*cmu.read(alone), *cmu.couples(data, split)):
        yield every(scene, FPS, H36M17)


def samples_of(scene: Scene, moments: dict[str, list[Moment]]) -> Iterator[GoalSample]:
    """The samples of one scene: each moment with the way to it from the one before, or from a gap of the capture."""
    for person, name in enumerate(scene.people):
        unseen = np.flatnonzero(~scene.observed.all((1, 2)))
        before = 0
        for moment in moments.get(name, []):
            frame = round(moment.second * FPS)
            gaps = unseen[unseen < frame]
            first = max(before, int(gaps[-1]) + 1) if len(gaps) else before
            before = frame
            if frame - first < SHORTEST_SPAN or frame in unseen:
                continue
            span = scene.positions[first:frame]
            partner = span[:, 1 - person] if len(scene.people) == 2 else None
            yield GoalSample(moment.take, name, moment.second, span[:, person], scene.positions[frame, person], partner)


def windows_of(way: np.ndarray, starts: Sequence[float] = STARTS) -> np.ndarray:
    """Histories of 10 frames out of the way to a pose, ``(starts, 10, 17, 3)``.

    Args:
        way: ``GoalSample.history`` or its partner.
        starts: Where they begin, from 0, the first possible frame, to 1, the last one.

    Example:
        >>> windows_of(np.arange(30).reshape(30, 1, 1))[:, 0, 0, 0].tolist()
        [0, 7, 10, 13, 20]
    """
    last = len(way) - HISTORY
    return np.stack([way[int(share * last + 0.5) :][:HISTORY] for share in starts])
