"""Limbs of two bones whose end is known: where the knee or the elbow is."""

from __future__ import annotations

import numpy as np

REACH = 0.999
"""A limb is never quite straight: its joint would not know where to bend."""


def middle_joint(
    start: np.ndarray, end: np.ndarray, upper: float, lower: float, pole: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """The joint between two bones that lead from ``start`` towards ``end``, by the law of cosines.

    Args:
        start: Hip or shoulder, ``(..., 3)``.
        end: Where the ankle or the wrist should be.
        upper: Length of the first bone.
        lower: Length of the second.
        pole: Direction in which the joint bends, ``(..., 3)``, of any length.

    Returns:
        The joint, and the end that was reached: nearer to ``start`` where the limb is too short.

    Example:
        >>> knee, ankle = middle_joint(np.zeros(3), np.array([0, 0, -0.8]), 0.5, 0.5, np.array([1.0, 0, 0]))
        >>> knee.round(6) + 0.0
        array([ 0.3,  0. , -0.4])
    """
    way = end - start
    length = np.linalg.norm(way, axis=-1, keepdims=True)
    along = way / np.maximum(length, 1e-9)
    far = np.clip(length, abs(upper - lower) + 1e-3, REACH * (upper + lower))
    aside = pole - (pole * along).sum(-1, keepdims=True) * along
    aside /= np.maximum(np.linalg.norm(aside, axis=-1, keepdims=True), 1e-9)
    share = (far**2 + upper**2 - lower**2) / (2 * far)
    bend = np.sqrt(np.maximum(upper**2 - share**2, 0))
    return start + share * along + bend * aside, start + far * along


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
