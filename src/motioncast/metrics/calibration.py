"""Does a forecast know how sure it may be? Error radii that hold, samples that spread as the truth does."""

from __future__ import annotations

import numpy as np

from motioncast.metrics.masks import seen_mean


def coverage_at(errors: np.ndarray, radius_m: np.ndarray, observed: np.ndarray | None = None) -> np.ndarray:
    """Share of joints within their error radius at each frame, ``(time,)``; 0.9 for honest radii of level 0.9.

    Args:
        errors: ``(windows, time, people, joints)`` metres.
        radius_m: ``(time, joints)``, as in :attr:`motioncast.core.forecast.Forecast.radius_m`.
        observed: ``(windows, time, people, joints)``. Default: all.

    Example:
        >>> coverage_at(np.array([0.1, 0.2, 0.3, 0.4]).reshape(4, 1, 1, 1), np.array([[0.3]]))
        array([0.75])
    """
    return seen_mean(errors <= radius_m[:, None], observed, (0, 2, 3))


def rank_histogram(samples: np.ndarray, truth: np.ndarray) -> np.ndarray:
    """How often the truth is above 0, 1, ..., K of the K samples, ``(K + 1,)`` shares.

    Flat where samples spread as the truth does; high at both ends where they spread too little, in the middle where
    too much. Where the truth equals samples its ranks share the count. Hamill, Monthly Weather Review 129 (2001) 550.

    Args:
        samples: ``(samples, ...)`` numbers, such as coordinates of joints relative to the last pose.
        truth: ``(...)``, those that were seen.

    Example:
        >>> rank_histogram(np.array([[1.0, 1.0], [2.0, 2.0]]), np.array([0.0, 2.0]))  # rank 0; rank 1 or 2
        array([0.5 , 0.25, 0.25])
    """
    count = len(samples)
    below = (samples < truth).sum(0).reshape(-1)
    above = below + (samples == truth).sum(0).reshape(-1)
    ranks = np.arange(count + 1)[:, None]
    shares = ((ranks >= below) & (ranks <= above)) / (above - below + 1)
    return shares.mean(1)


def unevenness(histogram: np.ndarray) -> float:
    """How far a rank histogram is from flat: half the sum of differences, 0 (flat) to almost 1.

    Example:
        >>> unevenness(np.array([0.5, 0.0, 0.0, 0.5]))
        0.5
    """
    return float(np.abs(histogram - 1 / len(histogram)).sum() / 2)


def energy_score(samples: np.ndarray, truth: np.ndarray) -> np.ndarray:
    """Energy score of samples, ``(...)`` in the unit of the vectors: lower is better, least for the true distribution.

    ``mean |X - y| - 1/2 mean |X - X'|`` over samples X and pairs of different samples (the fair form, so that the
    number of samples does not matter). For one sample it is its distance from the truth. Gneiting and Raftery, JASA
    102 (2007) 359.

    Args:
        samples: ``(samples, ..., n)`` vectors, such as a person's flattened pose.
        truth: ``(..., n)``.

    Example:
        >>> float(energy_score(np.array([[0.0], [4.0]]), np.array([1.0])))  # (1 + 3) / 2 - 4 / 2
        0.0
        >>> float(energy_score(np.array([[3.0]]), np.array([1.0])))
        2.0
    """
    samples = np.asarray(samples, np.float64)
    count = len(samples)
    score = np.linalg.norm(samples - truth, axis=-1).mean(0)
    for one in range(count - 1):  # one sample against all later ones: memory stays that of the samples
        apart = np.linalg.norm(samples[one + 1 :] - samples[one], axis=-1)
        score -= apart.sum(0) / (count * (count - 1))
    return score
