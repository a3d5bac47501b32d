"""Means over what was seen."""

from __future__ import annotations

import numpy as np


def seen_mean(values: np.ndarray, seen: np.ndarray | None, axes: int | tuple[int, ...]) -> np.ndarray:
    """The mean of the values that were seen, over some axes; NaN where nothing was.

    Args:
        values: Any shape; what stands where nothing was seen does not matter.
        seen: Which values count, broadcast to ``values``. Default: all.
        axes: Axes over which to average.

    Example:
        >>> seen_mean(np.array([[1.0, 3.0], [5.0, np.nan]]), np.array([[True, True], [True, False]]), 1)
        array([2., 5.])
    """
    values = np.asarray(values, np.float64)
    seen = np.broadcast_to(True if seen is None else seen, values.shape)
    sums, counts = np.where(seen, values, 0).sum(axes), seen.sum(axes)
    return np.divide(sums, counts, out=np.full(np.shape(sums), np.nan), where=counts > 0)
