"""Errors of joint positions in the world."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from motioncast.metrics.masks import seen_mean
from motioncast.metrics.moments import at_frames


def joint_errors(forecast: np.ndarray, truth: np.ndarray) -> np.ndarray:
    """Distance of each joint from the truth in metres, ``(..., joints)``.

    Example:
        >>> joint_errors(np.zeros((1, 3)), np.array([[3.0, 4.0, 0.0]]))
        array([5.])
    """
    return np.linalg.norm(np.asarray(forecast, np.float64) - truth, axis=-1)


def mpjpe_at(forecast: np.ndarray, truth: np.ndarray, observed: np.ndarray | None = None) -> np.ndarray:
    """Mean joint error AT each frame, in metres.

    Args:
        forecast: ``(windows, time, people, joints, 3)`` metres.
        truth: The same shape.
        observed: ``(windows, time, people, joints)``: which true joints count. Default: all.

    Returns:
        ``(time,)``; each observed joint of each window counts once. NaN where nobody was seen.

    Example:
        >>> truth = np.zeros((2, 1, 1, 1, 3))
        >>> mpjpe_at(truth + [0.3, 0.0, 0.4], truth)
        array([0.5])
    """
    return seen_mean(joint_errors(forecast, truth), observed, (0, 2, 3))


def mpjpe_until(forecast: np.ndarray, truth: np.ndarray, observed: np.ndarray | None = None) -> np.ndarray:
    """Mean joint error UNTIL each frame, ``(time,)`` metres: each observed joint of each frame counts once.

    Without gaps it is the running mean of :func:`mpjpe_at`. It is smaller than the error at the same frame by a
    factor of 1.3 to 1.7; the two never stand in one column.

    Example:
        >>> truth = np.zeros((1, 2, 1, 1, 3))
        >>> mpjpe_until(truth + np.array([0.0, 1.0]).reshape(1, 2, 1, 1, 1) * [1.0, 0, 0], truth)
        array([0. , 0.5])
    """
    errors = joint_errors(forecast, truth)
    seen = np.ones(errors.shape, bool) if observed is None else observed
    sums = np.cumsum(np.where(seen, errors, 0).sum((0, 2, 3)))
    counts = np.cumsum(seen.sum((0, 2, 3)))
    return np.divide(sums, counts, out=np.full(len(sums), np.nan), where=counts > 0)


def pck_at(
    forecast: np.ndarray, truth: np.ndarray, threshold_m: float, observed: np.ndarray | None = None
) -> np.ndarray:
    """Share of correct keypoints AT each frame, ``(time,)``: joints no farther than a threshold from the truth.

    Shapes as in :func:`mpjpe_at`.

    Example:
        >>> truth = np.zeros((1, 1, 1, 2, 3))
        >>> pck_at(truth + np.array([[0.1], [0.2]]) * [1.0, 0, 0], truth, threshold_m=0.15)
        array([0.5])
    """
    return seen_mean(joint_errors(forecast, truth) <= threshold_m, observed, (0, 2, 3))


def vim_at(forecast: np.ndarray, truth: np.ndarray, observed: np.ndarray | None = None) -> np.ndarray:
    """VIM at each frame in metres, ``(time,)``: mean over people of the norm of the flattened pose error.

    The norm of ONE person's whole ``3 x joints`` vector; it is not divided by the number of joints. With an
    error e at each of 13 joints it is 3.606 e. SoMoF prints it in centimetres: :func:`vim_at_cm`.

    Args:
        forecast: ``(windows, time, people, joints, 3)`` metres.
        truth: The same shape.
        observed: ``(windows, time, people, joints)``; a person counts in a frame where all joints were seen.

    Example:
        >>> truth = np.zeros((1, 1, 1, 4, 3))
        >>> vim_at(truth + [1.0, 0.0, 0.0], truth)
        array([2.])
    """
    norms = np.linalg.norm(joint_errors(forecast, truth), axis=-1)
    return seen_mean(norms, None if observed is None else np.all(observed, -1), (0, 2))


def vim_at_cm(forecast: np.ndarray, truth: np.ndarray, observed: np.ndarray | None = None) -> np.ndarray:
    """VIM at each frame in centimetres, as SoMoF prints it; else :func:`vim_at`.

    Example:
        >>> truth = np.zeros((1, 1, 1, 4, 3))
        >>> vim_at_cm(truth + [0.1, 0.0, 0.0], truth)
        array([20.])
    """
    return 100 * vim_at(forecast, truth, observed)


def vim_mean_of_frames(vim: np.ndarray) -> float:
    """Mean of VIM over ALL frames of the horizon: what SoMoFormer's release logs.

    Example:
        >>> vim_mean_of_frames(np.array([10.0, 20.0, 60.0]))
        30.0
    """
    return float(np.mean(vim))


def vim_mean_of_moments(vim: np.ndarray, frames: Sequence[int]) -> float:
    """Mean of VIM over a table's moments: what the papers call overall.

    Args:
        vim: ``(time,)``.
        frames: The moments as frames counted from 1. SoMoF's are 2, 4, 8, 10, 14 at 15 fps: 133, 267, 533, 667
            and 933 ms, printed there as 100, 240, 500, 640 and 900.

    Example:
        >>> vim_mean_of_moments(np.array([10.0, 20.0, 60.0]), frames=[1, 3])
        35.0
    """
    return float(np.mean(at_frames(vim, frames)))
