"""The questions of cmu-goals: five histories on the way to each characteristic pose."""

from __future__ import annotations

import hashlib
import json
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np

from motioncast.benchmarks.protocol import tenths_mm
from motioncast.core.skeletons import H36M17
from motioncast.core.voxels import across, turned, turned_back
from motioncast.datasets.cmu_goals import FPS, HISTORY, STARTS, GoalSample, goal_samples, kinds, windows_of

GOALS = 10
"""Poses that are asked for."""


@dataclass(frozen=True, slots=True)
class GoalsProtocol:
    """What makes two figures comparable; it goes into every result.

    Attributes:
        name: Name of the benchmark.
        skeleton: Name of the joint set.
        fps: Frames a second.
        history: Frames of history.
        starts: Where the histories begin, as shares of the way from the moment before.
        goals: Poses asked for.
        metric: What the ratio is of.
        windows: Which questions, in words.
        centring: What poses are compared around.
        seed: Seed of the first question; each has its own.
    """

    name: str = "cmu-goals"
    skeleton: str = "h36m17"
    fps: float = FPS
    history: int = HISTORY
    starts: tuple[float, ...] = STARTS
    goals: int = GOALS
    metric: str = "mpjpe"
    windows: str = "five histories on the way to each characteristic pose, the best of ten poses or the only one"
    centring: str = "each pose around its own hip"
    seed: int = 0


PROTOCOL = GoalsProtocol()


@dataclass(frozen=True, slots=True, eq=False)
class Questions:
    """Histories and the poses that they led to.

    Attributes:
        histories: ``(samples, starts, 10, joints, 3)`` metres, world.
        partners: The same of who dances with them; NaN for who is alone.
        targets: ``(samples, joints, 3)`` metres around the hip, in the directions of the world.
        ahead: Frames from the end of each history to the pose, ``(samples, starts)``.
        takes: The take of each sample: samples of a take are not independent.
        kinds: The coarse kind of each take; empty where no index tells it.
    """

    histories: np.ndarray
    partners: np.ndarray
    targets: np.ndarray
    ahead: np.ndarray
    takes: tuple[str, ...]
    kinds: tuple[str, ...]

    def __len__(self) -> int:
        return len(self.targets)

    @property
    def axes(self) -> np.ndarray:
        """Where each history's person has the right at its end, ``(samples, starts, 2)``."""
        return across(self.histories[:, :, -1], H36M17)

    @property
    def own(self) -> np.ndarray:
        """Histories around the last hip, turned until the right lies along +x, ``(samples, starts, 10, joints, 3)``."""
        hip = self.histories[:, :, -1:, :1]
        return turned_back(self.histories - hip, self.axes[:, :, None, None])

    @property
    def own_targets(self) -> np.ndarray:
        """The poses as seen from the end of each history, ``(samples, starts, joints, 3)``."""
        return turned_back(self.targets[:, None], self.axes[:, :, None])

    def to_world(self, poses: np.ndarray) -> np.ndarray:
        """Answers as seen from the end of histories, ``(samples, starts, goals, joints, 3)``, turned to the world."""
        return turned(poses, self.axes[:, :, None, None])

    def checksum(self) -> str:
        """SHA-256 of histories, partners and targets at 0.1 mm."""
        arrays = (self.histories, np.nan_to_num(self.partners), self.targets)
        return hashlib.sha256(b"".join(map(tenths_mm, arrays))).hexdigest()

    def protocol_hash(self) -> str:
        """A short hash of the protocol and of the questions."""
        told = json.dumps(asdict(PROTOCOL), sort_keys=True) + self.checksum()
        return hashlib.sha256(told.encode()).hexdigest()[:16]


def questions(data: Path, split: str) -> Questions:
    """The questions of a split.

    Raises:
        InputError: If the folder holds no takes of the split.
    """
    return asked_of(list(goal_samples(data, split)), kinds(data))


def asked_of(samples: list[GoalSample], kinds: dict[str, str]) -> Questions:
    """The questions of samples.

    Args:
        samples: Poses, each with the way to it.
        kinds: Coarse kind of each take.
    """
    histories = np.stack([windows_of(sample.history) for sample in samples])
    alone = np.full_like(histories[0], np.nan)
    partners = [alone if sample.partner is None else windows_of(sample.partner) for sample in samples]
    ends = [windows_of(np.arange(len(sample.history)))[:, -1] for sample in samples]
    return Questions(
        histories,
        np.stack(partners),
        np.stack([sample.target - sample.target[:1] for sample in samples]),
        np.stack([len(sample.history) - end for sample, end in zip(samples, ends, strict=True)]),
        tuple(sample.take for sample in samples),
        tuple(kinds.get(sample.take, "") for sample in samples),
    )
