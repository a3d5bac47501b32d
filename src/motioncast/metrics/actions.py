"""What forecasts of actions and of poses seen by one camera are measured by.

Poses have the nine joints of ``core.skeletons.UPPER9`` and are compared from the neck: where somebody stands is not
forecast. Arrays have any leading axes.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from motioncast.core.skeletons import UPPER9
from motioncast.core.upper_body import from_neck

LIMBS = (("neck", "shoulder"), ("shoulder", "elbow"), ("elbow", "wrist"))
"""Bones that people have on both sides."""


def pixel_errors(forecast: np.ndarray, truth: np.ndarray, seen: np.ndarray | None = None) -> np.ndarray:
    """Mean distance of joints in the image, from the neck, ``(...)`` pixels (Sec. 4.5.1 of FutureHuman3D).

    Args:
        forecast: ``(..., 9, 2)`` pixels.
        truth: The same shape.
        seen: Which true joints count, ``(..., 9)``. Default: all.

    Returns:
        NaN where nothing counts.

    Example:
        >>> forecast = np.zeros((9, 2))
        >>> forecast[4] = 27, 36
        >>> float(pixel_errors(forecast, np.zeros((9, 2))))
        5.0
    """
    return _mean_distance(from_neck(forecast) - from_neck(truth), seen)


def pose_errors(forecast: np.ndarray, truth: np.ndarray) -> np.ndarray:
    """Mean distance of joints in space, from the neck, ``(...)`` in the unit of the poses ``(..., 9, 3)``."""
    return _mean_distance(from_neck(forecast) - from_neck(truth), None)


def scaled_pose_errors(forecast: np.ndarray, truth: np.ndarray) -> np.ndarray:
    """As :func:`pose_errors`, of a forecast made larger or smaller as fits best: one camera does not tell size.

    Example:
        >>> pose = np.random.default_rng(0).normal(size=(9, 3))
        >>> float(scaled_pose_errors(1.3 * pose, pose).round(12)), bool(pose_errors(1.3 * pose, pose) > 0.1)
        (0.0, True)
    """
    made, real = (from_neck(np.asarray(poses, np.float64)) for poses in (forecast, truth))
    factor = (made * real).sum((-1, -2)) / np.maximum((made**2).sum((-1, -2)), 1e-12)
    return _mean_distance(factor[..., None, None] * made - real, None)


def asymmetry(poses: np.ndarray) -> np.ndarray:
    """How much bones differ between left and right, mean over three pairs, ``(...)`` in the unit of the poses.

    Example:
        >>> float(asymmetry(np.zeros((9, 3))))
        0.0
    """
    apart = []
    for start, end in LIMBS:
        lengths = []
        for side in ("right", "left"):
            names = (name if name == "neck" else f"{side}_{name}" for name in (start, end))
            a, b = map(UPPER9.index, names)
            lengths.append(np.linalg.norm(poses[..., a, :] - poses[..., b, :], axis=-1))
        apart.append(np.abs(lengths[0] - lengths[1]))
    return np.mean(apart, 0)


def top_k(scores: np.ndarray, truth: np.ndarray, k: int = 1) -> np.ndarray:
    """Whether the true action is among the k of the highest scores, ``(...)`` bool.

    Args:
        scores: Of each action, ``(..., labels)``; of equal ones the first counts.
        truth: ``(...)`` indices.
        k: How many may be named.

    Example:
        >>> top_k(np.array([[0.1, 0.7, 0.2], [0.5, 0.4, 0.1]]), np.array([2, 0]), k=2)
        array([ True,  True])
    """
    best = np.argsort(-scores, axis=-1, kind="stable")[..., :k]
    return (best == truth[..., None]).any(-1)


def looks_real(poses: np.ndarray, weights: Sequence[tuple[np.ndarray, np.ndarray]]) -> np.ndarray:
    """Whether a classifier takes poses for real, ``(...)`` bool; the share of them is the quality of FutureHuman3D.

    Args:
        poses: ``(..., 9, 3)``.
        weights: Matrix ``(in, out)`` and bias of each layer, with ReLUs between; the last gives one score, above 0 for
            real.
    """
    features = in_shoulder_widths(poses)
    for number, (matrix, bias) in enumerate(weights):
        features = (np.maximum(features, 0) if number else features) @ matrix + bias
    return features[..., 0] > 0


def in_shoulder_widths(poses: np.ndarray) -> np.ndarray:
    """What the classifier sees of poses ``(..., 9, 3)``: joints from the neck in shoulder widths, ``(..., 27)``."""
    centred = from_neck(np.asarray(poses, np.float64))
    across = centred[..., UPPER9.index("left_shoulder"), :] - centred[..., UPPER9.index("right_shoulder"), :]
    wide = np.maximum(np.linalg.norm(across, axis=-1), 1e-3)[..., None, None]
    return (centred / wide).reshape(*poses.shape[:-2], -1)


def _mean_distance(apart: np.ndarray, seen: np.ndarray | None) -> np.ndarray:
    far = np.linalg.norm(apart, axis=-1)
    if seen is None:
        return far.mean(-1)
    count = seen.sum(-1)
    total = np.where(seen, far, 0).sum(-1)
    return np.divide(total, count, out=np.full(np.shape(total), np.nan), where=count > 0)
