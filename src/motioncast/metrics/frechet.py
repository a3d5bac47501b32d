"""Fréchet distance of forecast and real motion in a feature space that has a name.

Heusel et al. (NeurIPS 2017) after Dowson and Landau (1982). Figures of different spaces cannot be compared, so the
space is part of the answer's name.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np

from motioncast.metrics.words import motion_words


def word_features(motion: np.ndarray, hips: tuple[int, int]) -> np.ndarray:
    """Every 8-frame word of motions ``(..., time, joints, 3)``, flattened, ``(words, 24 joints)``."""
    words = motion_words(motion, hips)
    return words.reshape(-1, int(np.prod(words.shape[-3:])))


def pose_features(motion: np.ndarray, hips: tuple[int, int]) -> np.ndarray:
    """Every pose of motions ``(..., time, joints, 3)`` in its own frame, flattened, ``(poses, 3 joints)``."""
    poses = motion_words(motion, hips, length=1)
    return poses.reshape(-1, int(np.prod(poses.shape[-2:])))


SPACES: Mapping[str, Callable[[np.ndarray, tuple[int, int]], np.ndarray]] = {
    "word8": word_features,
    "pose": pose_features,
}
"""Feature spaces by name: of motions ``(..., time, joints, 3)`` and the two hips, to ``(items, features)``."""


def frechet_in(space: str, forecast: np.ndarray, real: np.ndarray, hips: tuple[int, int]) -> dict[str, float]:
    """Fréchet distance of two sets of motions, named after its space: ``frechet_SPACE``.

    Args:
        space: A name of :data:`SPACES`.
        forecast: ``(..., time, joints, 3)`` metres.
        real: ``(..., time, joints, 3)`` of the same joints; any number.
        hips: Left and right hip.

    Example:
        >>> motion = np.random.default_rng(0).normal(size=(20, 2, 3))
        >>> {name: round(value, 6) for name, value in frechet_in("pose", motion, motion, hips=(0, 1)).items()}
        {'frechet_pose': 0.0}
    """
    return {f"frechet_{space}": frechet(SPACES[space](forecast, hips), SPACES[space](real, hips))}


def frechet(one: np.ndarray, other: np.ndarray) -> float:
    """Squared Fréchet distance of the normal distributions fitted to two sets of features, as FID prints it.

    ``|m - n|^2 + trace(A + B - 2 (A B)^(1/2))`` of means m, n and covariances A, B. With few items it is too large:
    compare only sets of equal size.

    Args:
        one: ``(items, features)``, at least two items.
        other: ``(items, features)``.

    Example:
        >>> features = np.array([[-1.0], [1.0]])  # variance 2
        >>> round(frechet(features, features + 3.0), 6), round(frechet(features, 2 * features), 6)
        (9.0, 2.0)
    """
    means = [np.mean(features, 0, dtype=np.float64) for features in (one, other)]
    covariances = [np.atleast_2d(np.cov(features, rowvar=False, dtype=np.float64)) for features in (one, other)]
    root = matrix_root(covariances[0])
    # A B is not symmetric, but has the eigenvalues of A^(1/2) B A^(1/2), which is
    shared = np.linalg.eigvalsh(root @ covariances[1] @ root)
    spread = np.trace(covariances[0]) + np.trace(covariances[1]) - 2 * np.sqrt(np.maximum(shared, 0)).sum()
    return float(np.square(means[0] - means[1]).sum() + max(spread, 0.0))


def matrix_root(matrix: np.ndarray) -> np.ndarray:
    """The symmetric square root of a symmetric matrix without negative eigenvalues, ``(n, n)``.

    Example:
        >>> matrix_root(np.array([[4.0, 0.0], [0.0, 9.0]]))
        array([[2., 0.],
               [0., 3.]])
    """
    values, vectors = np.linalg.eigh(matrix)
    return (vectors * np.sqrt(np.maximum(values, 0))) @ vectors.T
