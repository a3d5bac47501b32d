"""Where people go in the long run: lengths of paths, and speed over time."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from motioncast.metrics.masks import seen_mean

FASTEST_M_S = 10.0
"""No one runs faster: what is faster in recorded motion is a jump of the tracker."""


def root_path(motion: np.ndarray, root: Sequence[int]) -> np.ndarray:
    """The path over the ground, ``(..., 2)``: x and y of the mean of the root joints.

    Mueller et al. 2024, equation 16 (there the hips).

    Args:
        motion: ``(..., joints, 3)`` metres, z up.
        root: The joints whose mean is the root.

    Example:
        >>> root_path(np.array([[1.0, 2.0, 0.9], [3.0, 2.0, 0.9]]), root=[0, 1])
        array([2., 2.])
    """
    return np.asarray(motion, np.float64)[..., list(root), :2].mean(-2)


def path_length_m(path: np.ndarray) -> np.ndarray:
    """Length of paths in metres, ``(...)``.

    Equation 17 there divides by the number of frames; the paper's table can only hold sums, as here.

    Args:
        path: ``(..., time, 2)`` from the last observed frame on.

    Example:
        >>> float(path_length_m(np.array([[0.0, 0.0], [3.0, 4.0], [3.0, 5.0]])))
        6.0
    """
    return np.linalg.norm(np.diff(path, axis=-2), axis=-1).sum(-1)


def wasserstein_1(one: np.ndarray, other: np.ndarray) -> float:
    """Wasserstein-1 distance of two samples of numbers: the area between their distribution functions.

    Args:
        one: ``(n,)``, such as the lengths of forecast paths.
        other: ``(m,)``, such as those of the true paths.

    Example:
        >>> wasserstein_1(np.array([0.0, 1.0]), np.array([5.0, 6.0]))
        5.0
        >>> wasserstein_1(np.array([0.0]), np.array([0.0, 1.0]))
        0.5
    """
    one, other = np.sort(one), np.sort(other)
    places = np.sort(np.concatenate([one, other]))
    shares = [np.searchsorted(sample, places[:-1], side="right") / len(sample) for sample in (one, other)]
    return float(np.sum(np.abs(shares[0] - shares[1]) * np.diff(places)))


def mean_speed_at(path: np.ndarray, fps: float, observed: np.ndarray | None = None) -> np.ndarray:
    """Mean speed over the ground at each frame, ``(time,)`` metres a second; jumps count as 10 m/s.

    The speed at frame k is that of the step from frame k - 1; frame 0 is the last observed one.

    Args:
        path: ``(windows, 1 + time, people, 2)`` from the last observed frame on.
        fps: Frames a second.
        observed: ``(windows, 1 + time, people)``; a step counts where both its ends were seen. Default: all.

    Example:
        >>> path = np.array([0.0, 0.1, 0.3, 9.0]).reshape(1, 4, 1, 1) * [1, 0]
        >>> mean_speed_at(path, fps=10).round(6)
        array([ 1.,  2., 10.])
    """
    speeds = np.minimum(np.linalg.norm(np.diff(path, axis=1), axis=-1) * fps, FASTEST_M_S)
    return seen_mean(speeds, None if observed is None else observed[:, 1:] & observed[:, :-1], (0, 2))
