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
