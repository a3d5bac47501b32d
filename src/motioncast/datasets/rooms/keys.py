"""Values between keys."""

from __future__ import annotations

import numpy as np


def hermite(times: np.ndarray, values: np.ndarray, slopes: np.ndarray, at: np.ndarray) -> np.ndarray:
    """Values between keys: a cubic from key to key with given slopes.

    Args:
        times: Of the keys, ``(keys,)``, rising.
        values: ``(keys, ...)``.
        slopes: Likewise, per unit of time.
        at: Moments, ``(n,)``; before the first and after the last key its value is held.

    Example:
        >>> hermite(np.array([0.0, 1.0]), np.array([0.0, 1.0]), np.zeros(2), np.array([0.25, 0.5, 2.0]))
        array([0.15625, 0.5    , 1.     ])
    """
    at = np.clip(at, times[0], times[-1])
    left = np.clip(np.searchsorted(times, at, "right") - 1, 0, len(times) - 2)
    span = times[left + 1] - times[left]
    shape = (-1, *(1,) * (values.ndim - 1))
    u, span = ((at - times[left]) / span).reshape(shape), span.reshape(shape)
    one, other = values[left], values[left + 1]
    return (
        one
        + (other - one) * u**2 * (3 - 2 * u)
        + slopes[left] * span * u * (1 - u) ** 2
        - slopes[left + 1] * span * u**2 * (1 - u)
    )
