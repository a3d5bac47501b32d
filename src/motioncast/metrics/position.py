"""Errors of joint positions."""

from __future__ import annotations

import numpy as np


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
        ``(time,)``; each observed joint of each window counts once.

    Example:
        >>> truth = np.zeros((2, 1, 1, 1, 3))
        >>> mpjpe_at(truth + [0.3, 0.0, 0.4], truth)
        array([0.5])
    """
    errors = joint_errors(forecast, truth)
    mask = np.ones(errors.shape, bool) if observed is None else observed
    return (errors * mask).sum((0, 2, 3)) / mask.sum((0, 2, 3))


def mpjpe_until(forecast: np.ndarray, truth: np.ndarray, observed: np.ndarray | None = None) -> np.ndarray:
    """Mean joint error UNTIL each frame: the running mean of :func:`mpjpe_at`, ``(time,)`` metres.

    Example:
        >>> truth = np.zeros((1, 2, 1, 1, 3))
        >>> mpjpe_until(truth + np.array([0.0, 1.0]).reshape(1, 2, 1, 1, 1) * [1.0, 0, 0], truth)
        array([0. , 0.5])
    """
    at = mpjpe_at(forecast, truth, observed)
    return np.cumsum(at) / np.arange(1, len(at) + 1)


def vim_at(forecast: np.ndarray, truth: np.ndarray) -> np.ndarray:
    """VIM at each frame in metres, ``(time,)``: mean over people of the norm of the flattened pose error.

    The norm of ONE person's whole ``3 x joints`` vector; it is not divided by the number of joints. With an
    error e at each of 13 joints it is 3.606 e. SoMoF prints it in centimetres.

    Args:
        forecast: ``(windows, time, people, joints, 3)`` metres.
        truth: The same shape.

    Example:
        >>> truth = np.zeros((1, 1, 1, 4, 3))
        >>> vim_at(truth + [1.0, 0.0, 0.0], truth)
        array([2.])
    """
    squares = np.square(np.asarray(forecast, np.float64) - truth).sum((-1, -2))
    return np.sqrt(squares).mean((0, 2))
