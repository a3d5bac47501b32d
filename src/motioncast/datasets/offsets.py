"""Takes held as a root's path and the other joints' offsets from it, in steps that fit 16-bit whole numbers."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

OFFSET_STEP_M = 5e-5


def unpack(data: Mapping[str, np.ndarray], name: str) -> np.ndarray:
    """World positions of one person, ``(time, 1, joints, 3)`` metres, from ``NAME_root`` and ``NAME_rel``.

    Example:
        >>> packed = {"a_root": np.ones((2, 3), np.float32), "a_rel": np.full((2, 1, 3), 20_000, np.int16)}
        >>> unpack(packed, "a")[0, 0].tolist()
        [[1.0, 1.0, 1.0], [2.0, 2.0, 2.0]]
    """
    root = data[f"{name}_root"].astype(np.float64)[:, None]
    return np.concatenate([root, root + data[f"{name}_rel"] * OFFSET_STEP_M], 1)[:, None]
