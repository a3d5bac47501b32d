"""Errors and spread of several samples of the future.

All distances are norms of ONE person's flattened pose, ``sqrt(sum over joints |difference|^2)``, as in DLow (Yuan and
Kitani, ECCV 2020) and those after it. Given the path alone (one joint) they are the errors of trajectories.

Samples are ``(windows, samples, time, people, joints, 3)`` in metres, the most probable sample first.
"""

from __future__ import annotations

from typing import Literal

import numpy as np

from motioncast.metrics.masks import seen_mean


def ade(samples: np.ndarray, truth: np.ndarray, observed: np.ndarray | None = None) -> np.ndarray:
    """Average displacement error of each sample over the horizon, ``(windows, samples, people)`` metres.

    Args:
        samples: ``(windows, samples, time, people, joints, 3)``.
        truth: ``(windows, time, people, joints, 3)``.
        observed: ``(windows, time, people, joints)``; a person counts in a frame where all joints were seen.

    Returns:
        NaN for a person that was never seen.

    Example:
        >>> truth = np.zeros((1, 2, 1, 1, 3))
        >>> ade(truth[:, None] + np.array([1.0, 3.0]).reshape(1, 1, 2, 1, 1, 1) * [1, 0, 0], truth)
        array([[[2.]]])
    """
    seen = None if observed is None else np.all(observed, -1)[:, None]
    return seen_mean(_pose_distance(samples, truth[:, None]), seen, 2)


def fde(samples: np.ndarray, truth: np.ndarray, observed: np.ndarray | None = None) -> np.ndarray:
    """Final displacement error: that of the last frame of the horizon. Arguments and answer as in :func:`ade`.

    Example:
        >>> truth = np.zeros((1, 2, 1, 1, 3))
        >>> fde(truth[:, None] + np.array([1.0, 3.0]).reshape(1, 1, 2, 1, 1, 1) * [1, 0, 0], truth)
        array([[[3.]]])
    """
    return ade(samples[:, :, -1:], truth[:, -1:], None if observed is None else observed[:, -1:])


def _pose_distance(one: np.ndarray, other: np.ndarray) -> np.ndarray:
    return np.linalg.norm(np.subtract(one, other, dtype=np.float64).reshape(*one.shape[:-2], -1), axis=-1)


def best_of(name: str, errors: np.ndarray, k: int, level: Literal["scene", "person"]) -> dict[str, float]:
    """The mean error of the best of the first K samples, and always of the first alone, by names that say so.

    The truth picks the sample: for a scene as a whole, or for each person apart, which is easier. It is never
    picked for each joint or each metric of a table apart: such a person would exist in no sample.

    Args:
        name: Name of the error, such as ``ade_m``.
        errors: ``(windows, samples, people)``; NaN for people who were not seen.
        k: How many samples may be looked at.
        level: Who picks a sample.

    Returns:
        ``NAME_k1`` and ``NAME_best_of_K_per_LEVEL``; each person counts once.

    Raises:
        ValueError: If there are fewer than K samples.

    Example:
        >>> errors = np.array([[[2.0, 3.0], [1.0, 7.0]]])  # two samples of two people
        >>> best_of("ade_m", errors, k=2, level="scene")
        {'ade_m_k1': 2.5, 'ade_m_best_of_2_per_scene': 2.5}
        >>> best_of("ade_m", errors, k=2, level="person")
        {'ade_m_k1': 2.5, 'ade_m_best_of_2_per_person': 2.0}
    """
    if not 1 <= k <= errors.shape[1]:
        raise ValueError(f"best of {k} was asked for; {errors.shape[1]} samples came")
    errors = errors[:, :k]
    seen = ~np.isnan(errors[:, 0])
    filled = np.where(seen[:, None], errors, 0)
    if level == "person":
        best = filled.min(1)
    else:
        chosen = filled.sum(-1).argmin(1)
        best = filled[np.arange(len(filled)), chosen]
    return {
        f"{name}_k1": float(seen_mean(filled[:, 0], seen, (0, 1))),
        f"{name}_best_of_{k}_per_{level}": float(seen_mean(best, seen, (0, 1))),
    }


def apd(samples: np.ndarray) -> np.ndarray:
    """Average pairwise distance: how far samples are apart, ``(windows, people)`` metres.

    As in DLow the norm of a person's whole flattened motion, over all frames, so it grows with the root of the
    horizon's frames. A single sample has no spread: 0.

    Args:
        samples: ``(windows, samples, time, people, joints, 3)``.

    Example:
        >>> apd(np.array([0.0, 1.0, 3.0]).reshape(1, 3, 1, 1, 1, 1) * [1, 0, 0])  # distances 1, 2 and 3
        array([[2.]])
    """
    windows, count, _, people = samples.shape[:4]
    total = np.zeros((windows, people))
    for one in range(count - 1):  # one sample against all later ones: memory stays that of the samples
        apart = np.subtract(samples[:, one + 1 :], samples[:, one : one + 1], dtype=np.float64)
        total += np.sqrt(np.square(apart).sum((2, 4, 5))).sum(1)
    return total / max(count * (count - 1) / 2, 1)
