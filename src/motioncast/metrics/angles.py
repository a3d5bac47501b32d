"""Errors of joint rotations, where they are known."""

from __future__ import annotations

import numpy as np

from motioncast.metrics.masks import seen_mean


def angle_errors(forecast: np.ndarray, truth: np.ndarray) -> np.ndarray:
    """Angle of the turn from each forecast rotation to the true one, 0 to pi radians, ``(..., joints)``.

    A quaternion and its negative are the same rotation.

    Args:
        forecast: Unit quaternions wxyz, ``(..., joints, 4)``.
        truth: The same shape.

    Example:
        >>> quarter = np.array([[np.sqrt(0.5), 0.0, 0.0, np.sqrt(0.5)]])
        >>> np.degrees(angle_errors(quarter, -np.array([[1.0, 0.0, 0.0, 0.0]]))).round(6)
        array([90.])
    """
    forecast, truth = np.asarray(forecast, np.float64), np.asarray(truth, np.float64)
    # |p - q| and |p + q| are 2 sin and 2 cos of a quarter of the angle: exact for small angles, unlike the arc cosine
    near, far = np.linalg.norm(forecast - truth, axis=-1), np.linalg.norm(forecast + truth, axis=-1)
    return 4 * np.arctan2(np.minimum(near, far), np.maximum(near, far))


def joint_angle_error_at(forecast: np.ndarray, truth: np.ndarray, observed: np.ndarray | None = None) -> np.ndarray:
    """Mean joint angle error AT each frame, ``(time,)`` radians.

    Args:
        forecast: Local rotations, unit quaternions wxyz, ``(windows, time, people, joints, 4)``.
        truth: The same shape.
        observed: ``(windows, time, people, joints)``: which true joints count. Default: all.

    Example:
        >>> still, half = [1.0, 0, 0, 0], [0, 1.0, 0, 0]
        >>> truth = np.array([still, still]).reshape(1, 1, 1, 2, 4)
        >>> joint_angle_error_at(np.array([still, half]).reshape(1, 1, 1, 2, 4), truth).round(4)
        array([1.5708])
    """
    return seen_mean(angle_errors(forecast, truth), observed, (0, 2, 3))
