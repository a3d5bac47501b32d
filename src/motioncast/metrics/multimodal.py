"""Errors against all futures that followed a similar last pose, not only against the one that happened.

After DLow (Yuan and Kitani, ECCV 2020). One person a window; poses in the person's own frame, else nothing is similar.
"""

from __future__ import annotations

import numpy as np


def similar_pasts(last_poses: np.ndarray, threshold_m: float = 0.5) -> np.ndarray:
    """Which windows end their history in similar poses, ``(windows, windows)`` bool; each is similar to itself.

    Args:
        last_poses: ``(windows, joints, 3)`` metres, root and heading taken out.
        threshold_m: Largest norm of the flattened difference. The papers' 0.5 is for 17 joints.

    Example:
        >>> similar_pasts(np.array([0.0, 0.4, 0.8]).reshape(3, 1, 1) * [1, 0, 0]).astype(int)
        array([[1, 1, 0],
               [1, 1, 1],
               [0, 1, 1]])
    """
    flat = np.asarray(last_poses, np.float64).reshape(len(last_poses), -1)
    return np.stack([np.linalg.norm(flat - pose, axis=-1) <= threshold_m for pose in flat])


def mmade(samples: np.ndarray, truth: np.ndarray, similar: np.ndarray) -> np.ndarray:
    """Multi-modal ADE: for each similar window's future the best sample's error, and their mean, ``(windows,)`` metres.

    Args:
        samples: ``(windows, samples, time, joints, 3)`` metres.
        truth: ``(windows, time, joints, 3)``.
        similar: ``(windows, windows)`` bool of :func:`similar_pasts`.

    Example:
        >>> truth = np.array([0.0, 1.0]).reshape(2, 1, 1, 1) * [1, 0, 0]
        >>> mmade(truth[:, None], truth, np.array([[True, True], [False, True]]))
        array([0.5, 0. ])
    """
    flat_samples = np.asarray(samples, np.float64).reshape(*samples.shape[:3], -1)
    flat_truth = np.asarray(truth, np.float64).reshape(*truth.shape[:2], -1)
    means = np.empty(len(samples))
    for window, futures in enumerate(similar):
        # a future at a time: a common pose may have thousands of them
        means[window] = np.mean([
            np.linalg.norm(flat_samples[window] - flat_truth[future], axis=-1).mean(-1).min()
            for future in np.flatnonzero(futures)
        ])  # fmt: skip
    return means


def mmfde(samples: np.ndarray, truth: np.ndarray, similar: np.ndarray) -> np.ndarray:
    """Multi-modal FDE: :func:`mmade` of the last frame.

    Example:
        >>> truth = np.zeros((1, 2, 1, 3))
        >>> mmfde(truth[:, None] + np.array([1.0, 3.0]).reshape(2, 1, 1) * [1, 0, 0], truth, np.array([[True]]))
        array([3.])
    """
    return mmade(samples[:, :, -1:], truth[:, -1:], similar)
