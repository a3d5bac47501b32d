"""NDMS: does each moment of a forecast move as some real person did?

Normalised directional motion similarity, Tanke et al., Intention-based long-term human motion anticipation (3DV 2021)
and Humans in Kitchens (NeurIPS 2023). Their release finds neighbours approximately; here they are exact.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from motioncast.metrics.neighbours import Neighbours, prepare

FLOOR_M = 1e-7
"""Shortest step: shorter ones count as this, as in the release."""


@dataclass(frozen=True, slots=True, eq=False)
class Dictionary:
    """Words of real motion to compare with; make one with :func:`dictionary`.

    Attributes:
        words: ``(words, length, joints, 3)`` metres: :func:`motioncast.metrics.words.motion_words` of real people.
        search: The flattened words, ready for searching.
    """

    words: np.ndarray
    search: Neighbours

    def nearest(self, words: np.ndarray) -> np.ndarray:
        """Index of the real word that is nearest to each word, ``(...)`` of ``(..., length, joints, 3)``.

        Nearest by the norm of the flattened difference; of equally near ones the first.
        """
        flat = words.reshape(-1, self.search.points.shape[1])
        return self.search.nearest(flat).reshape(words.shape[:-3])


def dictionary(words: np.ndarray) -> Dictionary:
    """A dictionary of real words, ``(words, length, joints, 3)`` metres."""
    return Dictionary(words, prepare(words.reshape(len(words), -1)))


def similarity(words: np.ndarray, real: np.ndarray) -> np.ndarray:
    """How alike two words move, 0 to 1, ``(...)``.

    For each joint and each step from frame to frame with displacements a and b:
    ``(cos(a, b) + 1) / 2 * min(|a|, |b|) / max(|a|, |b|)``, the lengths at least 1e-7 m; then the mean over both.
    Two people who both stand perfectly still have no direction and score 0.5; one who stands beside one who moves
    scores 0.

    Args:
        words: ``(..., length, joints, 3)`` metres.
        real: The same shape.

    Example:
        >>> still = np.zeros((2, 1, 3))
        >>> ahead, slower, back = (np.array([0.0, step]).reshape(2, 1, 1) * [1, 0, 0] for step in (0.2, 0.1, -0.2))
        >>> [round(float(similarity(a, b)), 6) for a, b in ((ahead, ahead), (ahead, slower), (ahead, back))]
        [1.0, 0.5, 0.0]
        >>> [round(float(similarity(a, b)), 6) for a, b in ((still, still), (still, ahead))]
        [0.5, 0.0]
    """
    steps = [np.diff(np.asarray(word, np.float64), axis=-3) for word in (words, real)]
    lengths = [np.maximum(np.sqrt(np.einsum("...i,...i->...", step, step)), FLOOR_M) for step in steps]
    cosine = np.einsum("...i,...i->...", *steps) / (lengths[0] * lengths[1])
    ratio = np.minimum(*lengths) / np.maximum(*lengths)
    return ((cosine + 1) / 2 * ratio).mean((-2, -1))


def ndms(words: np.ndarray, real: Dictionary) -> np.ndarray:
    """NDMS of each word of a forecast, 0 to 1, ``(...)``: its likeness to the nearest real word.

    Given the words of :func:`motioncast.metrics.words.with_seam`, value k (from 1) is of the word that ends at frame
    k; a table's NDMS until a frame is the mean of the first k, that of a model the mean of all.

    Args:
        words: ``(..., length, joints, 3)`` metres.
        real: Words of real people.

    Example:
        >>> real = np.arange(8).reshape(1, 8, 1, 1) * [0.0, 0.1, 0.0]
        >>> ndms(np.concatenate([real, real / 2]), dictionary(real)).round(6)
        array([1. , 0.5])
    """
    found = real.nearest(words)
    flat, indices = words.reshape(-1, *words.shape[-3:]), found.reshape(-1)
    # a block at a time: the matched words of 250,000 words would be 700 MB; a small block stays in the cache
    blocks = range(0, len(flat), 256)
    scores = [similarity(flat[i : i + 256], real.words[indices[i : i + 256]]) for i in blocks]
    return np.concatenate([np.zeros(0), *scores]).reshape(found.shape)
