"""What makes two figures comparable: a protocol, and the hash of it and of its windows."""

from __future__ import annotations

import hashlib
import json
from dataclasses import asdict, dataclass

import numpy as np

from motioncast.datasets.windows import Windows
from motioncast.errors import InputError


@dataclass(frozen=True, slots=True)
class Protocol:
    """What makes two figures comparable; it goes into every result.

    Attributes:
        name: Name of the benchmark.
        skeleton: Name of the joint set.
        fps: Frames a second.
        history: Frames of history.
        horizon: Frames of future.
        moments: Forecast frames that are scored, from 1.
        summary: Those of the moments whose mean is divided by that of standing still.
        metric: ``mpjpe`` (mm, at a moment) or ``vim`` (cm, at a moment).
        windows: Which windows, in words.
        stride: Frames between windows of a take.
        condition: What a tracker did to the history (``conditions.CONDITIONS``).
        root: The joint, or the mean of joints, that stands for a person where a metric needs one.
        centring: What is subtracted from the positions before a model sees them.
        samples: Futures asked for; with 1 nothing is chosen by the truth.
        seed: Seed of the samples and of the condition.
    """

    name: str
    skeleton: str
    fps: float
    history: int
    horizon: int
    moments: tuple[int, ...]
    summary: tuple[int, ...]
    metric: str
    windows: str
    stride: int = 5
    condition: str = "clean"
    root: str = "pelvis, or the middle of the hips"
    centring: str = "none: positions in the world"
    samples: int = 1
    seed: int = 0

    @property
    def moments_ms(self) -> tuple[float, ...]:
        """The true times of the scored frames after the last frame of the history.

        Example:
            >>> frames = (2, 4, 8, 10, 14)  # printed by others as 100, 240, 500, 640, 900
            >>> [round(ms) for ms in Protocol("", "", 15, 16, 14, frames, frames, "vim", "").moments_ms]
            [133, 267, 533, 667, 933]
        """
        return tuple(1000 * moment / self.fps for moment in self.moments)

    @property
    def unit(self) -> str:
        """The unit that the metric is printed in."""
        return "mm" if self.metric == "mpjpe" else "cm"

    def hash(self, windows: Windows) -> str:
        """A short hash of the protocol and of its windows."""
        return hashlib.sha256((json.dumps(asdict(self), sort_keys=True) + checksum(windows)).encode()).hexdigest()[:16]


def checksum(windows: Windows) -> str:
    """SHA-256 of windows: positions at 0.1 mm, and which of them were seen."""
    digest = hashlib.sha256(tenths_mm(windows.positions))
    digest.update(windows.observed.tobytes())
    for array in windows.past:
        digest.update(np.ascontiguousarray(array).tobytes())
    return digest.hexdigest()


def tenths_mm(positions: np.ndarray) -> bytes:
    """Positions rounded to 0.1 mm, as bytes."""
    return np.round(positions * 1e4).astype("<i4").tobytes()


def as_asked(futures: np.ndarray, frames: int, people: int) -> np.ndarray:
    """A model's futures ``(..., time, people, joints, 3)``, if they are of the frames and people that were asked for.

    Raises:
        InputError: If not; a single frame or person would pass for all of them unnoticed.
    """
    if futures.shape[-4:-2] != (frames, people):
        raise InputError(
            f"the model answered with {futures.shape[-4]} frames of {futures.shape[-3]} people; {frames} of {people} "
            "were asked for, so correct its forecast"
        )
    return futures
