"""Errors of the pose alone, and of the path alone."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from motioncast.core.skeleton import Skeleton
from motioncast.errors import SkeletonError
from motioncast.metrics.masks import seen_mean
from motioncast.metrics.position import joint_errors, mpjpe_at


def root_joints(skeleton: Skeleton) -> tuple[int, ...]:
    """The joints whose mean is the root: the pelvis, or both hips where there is none. Never "joint 0".

    Raises:
        SkeletonError: If the skeleton has neither.

    Example:
        >>> root_joints(Skeleton(("a", "b", "c"), (-1, 0, 0), ("neck", "left_hip", "right_hip")))
        (1, 2)
    """
    for places in (("pelvis",), ("left_hip", "right_hip")):
        found = tuple(joint for joint in map(skeleton.find, places) if joint is not None)
        if len(found) == len(places):
            return found
    raise SkeletonError(f'skeleton "{skeleton.label}" has neither a pelvis nor two hips; name them with a map')


def root_aligned_mpjpe_at(
    forecast: np.ndarray, truth: np.ndarray, root: Sequence[int], observed: np.ndarray | None = None
) -> np.ndarray:
    """Mean joint error AT each frame after both sides' own root OF THE SAME FRAME is moved to the origin.

    UMPM tables call it APE.

    Args:
        forecast: ``(windows, time, people, joints, 3)`` metres.
        truth: The same shape.
        root: The joints whose mean is the root: :func:`root_joints`.
        observed: ``(windows, time, people, joints)``; a pose counts where its true root was seen.

    Returns:
        ``(time,)`` metres.

    Example:
        >>> truth = np.array([[0.0, 0, 0], [0, 0, 1.0]]).reshape(1, 1, 1, 2, 3)
        >>> forecast = truth + [[5.0, 0, 0], [5.4, 0, 0]]  # 5 m off the path, one joint of two 0.4 m off the pose
        >>> root_aligned_mpjpe_at(forecast, truth, root=[0]).round(6)
        array([0.2])
    """
    if observed is not None:
        observed = observed & observed[..., list(root)].all(-1, keepdims=True)
    return mpjpe_at(forecast - _root(forecast, root), truth - _root(truth, root), observed)


def root_error_at(
    forecast: np.ndarray, truth: np.ndarray, root: Sequence[int], observed: np.ndarray | None = None
) -> np.ndarray:
    """Mean error of the root, that is of the path, AT each frame, ``(time,)`` metres. Arguments as above.

    UMPM tables call it FDE at every frame.

    Example:
        >>> truth = np.zeros((1, 1, 1, 2, 3))
        >>> root_error_at(truth + [[0.0, 0, 0], [0.6, 0, 0]], truth, root=[0, 1])
        array([0.3])
    """
    errors = joint_errors(_root(forecast, root), _root(truth, root))
    seen = None if observed is None else np.all(observed[..., list(root)], -1, keepdims=True)
    return seen_mean(errors, seen, (0, 2, 3))


def _root(positions: np.ndarray, root: Sequence[int]) -> np.ndarray:
    """The root, ``(..., 1, 3)``, of joints ``(..., joints, 3)``."""
    return np.asarray(positions, np.float64)[..., list(root), :].mean(-2, keepdims=True)


def procrustes(forecast: np.ndarray, truth: np.ndarray, observed: np.ndarray | None = None) -> np.ndarray:
    """Poses moved, turned and scaled (never mirrored) onto the truth by least squares over the observed joints.

    Umeyama, PAMI 13 (1991) 376, by singular values of all poses at once.

    Args:
        forecast: ``(..., joints, 3)``.
        truth: The same shape.
        observed: ``(..., joints)``. Default: all.

    Example:
        >>> truth = np.array([[0.0, 0, 0], [1, 0, 0], [0, 2, 0], [0, 0, 3]])
        >>> turned = truth[:, [1, 0, 2]] * [-1, 1, 1]  # a quarter turn about z
        >>> bool(np.allclose(procrustes(2 * turned + [7, 8, 9], truth), truth))
        True
    """
    forecast, truth = np.asarray(forecast, np.float64), np.asarray(truth, np.float64)
    seen = np.ones(forecast.shape[:-1], bool) if observed is None else observed
    centres = [seen_mean(points, seen[..., None], -2)[..., None, :] for points in (forecast, truth)]
    source, target = (
        np.where(seen[..., None], points - centre, 0) for points, centre in zip((forecast, truth), centres, strict=True)
    )
    left, stretch, right = np.linalg.svd(np.swapaxes(target, -1, -2) @ source)
    signs = np.ones_like(stretch)
    signs[..., 2] = np.sign(np.linalg.det(left @ right))  # a turn, not a mirror image
    turn = (left * signs[..., None, :]) @ right
    extent = np.square(source).sum((-2, -1))
    scale = (stretch * signs).sum(-1) / np.where(extent > 0, extent, 1)
    return scale[..., None, None] * ((forecast - centres[0]) @ np.swapaxes(turn, -1, -2)) + centres[1]


def pa_mpjpe_at(forecast: np.ndarray, truth: np.ndarray, observed: np.ndarray | None = None) -> np.ndarray:
    """Mean joint error AT each frame after each pose was laid on the truth by :func:`procrustes`, ``(time,)`` metres.

    Shapes as in :func:`motioncast.metrics.position.mpjpe_at`.

    Example:
        >>> truth = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]).reshape(1, 1, 1, 4, 3)
        >>> bool(pa_mpjpe_at(3 * truth + 1, truth)[0] < 1e-12)
        True
    """
    return mpjpe_at(procrustes(forecast, truth, observed), truth, observed)
