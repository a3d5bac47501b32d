"""Numbers on their way into a page: 16-bit integers of a unit each, as steps of steps from frame to frame, deflated.

What moves smoothly has small steps, and the change of these steps is smaller still: a third less than the steps.
"""

from __future__ import annotations

import zlib
from collections.abc import Sequence
from typing import Any

import numpy as np


class Block:
    """Arrays and the entries that describe them: name, shape, and the unit that an integer counts."""

    def __init__(self) -> None:
        self.arrays: list[np.ndarray] = []
        self.entries: list[dict[str, Any]] = []

    def add(self, name: str, values: np.ndarray, scale: float) -> None:
        """Adds an array, rounded to whole multiples of ``scale``."""
        self.arrays.append(np.round(np.asarray(values, np.float64) / scale).astype(np.int16))
        self.entries.append({"name": name, "shape": list(values.shape), "scale": scale})


def pack(arrays: Sequence[np.ndarray]) -> bytes:
    """int16 arrays as one deflated block: zigzag steps of steps along the first axis, low bytes before high bytes."""
    step = np.concatenate([_steps(_steps(array)).ravel() for array in arrays]).astype(np.int16)
    zigzag = ((step << 1) ^ (step >> 15)).view(np.uint16)
    low, high = (zigzag & 255).astype(np.uint8), (zigzag >> 8).astype(np.uint8)
    return zlib.compress(low.tobytes() + high.tobytes(), 9)


def _steps(array: np.ndarray) -> np.ndarray:
    return np.diff(array, axis=0, prepend=np.zeros_like(array[:1]))
