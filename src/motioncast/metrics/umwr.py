"""UMWR: how many different real moments does a forecast resemble?

Unique motion word ratio, Mueller et al., Massively multi-person 3D human motion forecasting with scene context (2024),
equation 15. No code of it was released.
"""

from __future__ import annotations

import numpy as np

from motioncast.metrics.words import WORD


def umwr(neighbours: np.ndarray) -> np.ndarray:
    """Share of different nearest real words among a person's words, 0 to 1, ``(...)``.

    A held pose resembles one word only: 1 / words.

    Args:
        neighbours: ``(..., words)``: index of the real word nearest to each word of a person's motion, as
            :meth:`motioncast.metrics.ndms.Dictionary.nearest` finds them, for the words of
            :func:`motioncast.metrics.words.with_seam`.

    Example:
        >>> umwr(np.array([[3, 3, 7, 3], [0, 1, 2, 3], [5, 5, 5, 5]]))
        array([0.5 , 1.  , 0.25])
    """
    ordered = np.sort(neighbours, -1)
    different = 1 + (np.diff(ordered, axis=-1) != 0).sum(-1)
    return different / neighbours.shape[-1]


def umwr_of_second(neighbours: np.ndarray, second: int, fps: float, length: int = WORD) -> np.ndarray:
    """UMWR@ks: that of the words that lie whole within one second, counted from 1, ``(...)``.

    As in the paper the seconds are cut from the observed frames before the seam on, so they are ``length - 1`` frames
    early, and at 25 fps each holds 18 words.

    Args:
        neighbours: ``(..., words)``, as in :func:`umwr`.
        second: Which second.
        fps: Frames a second.
        length: Frames of a word.

    Example:
        >>> bool(umwr_of_second(np.arange(250) // 9, second=1, fps=25) == 2 / 18)
        True
    """
    start, stop = round((second - 1) * fps), round(second * fps)
    return umwr(neighbours[..., start : stop - length + 1])
