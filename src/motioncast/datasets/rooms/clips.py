"""The takes that rooms are made of: 25 frames a second, 31 joints, floor at z = 0, whole stretches without a fault."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from motioncast.core.resample import resample
from motioncast.core.scene import Scene
from motioncast.core.skeletons import CMU31
from motioncast.datasets import cmu
from motioncast.datasets.rooms.contacts import FPS, floor_height, runs
from motioncast.datasets.rooms.splits import LEFT_OUT, split_of

SHORTEST = 25
"""Frames of the shortest stretch that is kept: one second."""


@dataclass(frozen=True, slots=True, eq=False)
class Clip:
    """A stretch of one take, of one person or of the couple.

    Attributes:
        name: Of the take, ``NN_TT``.
        positions: ``(time, people, 31, 3)`` float32, floor at z = 0.
    """

    name: str
    positions: np.ndarray

    @property
    def subject(self) -> int:
        """Number of the (first) subject."""
        return int(self.name.split("_")[0])


@dataclass(frozen=True, slots=True, eq=False)
class Library:
    """The clips of one split.

    Attributes:
        singles: Clips of one person by subject.
        couples: Clips of the couple.
    """

    singles: dict[int, list[Clip]]
    couples: list[Clip]


def load(data: str | Path, split: str) -> Library:
    """The clips of one split of rooms (see ``splits``).

    Args:
        data: Folder with CMU's takes: see :func:`motioncast.datasets.cmu.takes`.
        split: ``train``, ``validation`` or ``test``.

    Raises:
        InputError: If the folder holds none.
    """
    wanted = [
        take
        for take in cmu.takes(data)
        if split_of(take.subject, take.number) == split and take.subject not in {*LEFT_OUT, *cmu.COUPLE}
    ]
    singles: dict[int, list[Clip]] = {}
    for scene in cmu.read(wanted):
        for clip in clips_of(scene):
            singles.setdefault(clip.subject, []).append(clip)
    couples = [clip for scene in cmu.couples(data, split) for clip in clips_of(scene)]
    return Library(singles, couples)


def clips_of(scene: Scene) -> list[Clip]:
    """The stretches of a scene in which everybody is seen throughout."""
    order = [
        scene.skeleton.index(name) for name in CMU31.names
    ]  # Acclaim files list the same joints in their own order
    positions, observed = scene.positions[:, :, order], scene.observed[:, :, order]
    scene = resample(Scene(positions, CMU31, scene.fps, observed, scene.people), FPS)
    seen = np.all(scene.observed, (1, 2))
    if not seen.any():
        return []
    floors = [floor_height(scene.positions[seen, person]) for person in range(len(scene.people))]
    positions = scene.positions.copy()
    positions[..., 2] -= np.array(floors, np.float32)[None, :, None]
    return [Clip(scene.people[0], positions[first:end]) for first, end in runs(seen) if end - first >= SHORTEST]
