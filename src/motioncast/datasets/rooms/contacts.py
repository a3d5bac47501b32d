"""Where the floor is, and when a foot stands on it."""

from __future__ import annotations

import numpy as np

from motioncast.core.skeletons import CMU31

FPS = 25.0

FEET = tuple(CMU31.index(name) for name in ("lfoot", "ltoes", "rfoot", "rtoes"))
"""Ball and tip of the left foot, then of the right."""

HEIGHT_M, SPEED_M_S, LEAST = 0.05, 0.3, 4
"""A foot in contact is lower and slower than this for at least so many frames."""


def speed(points: np.ndarray) -> np.ndarray:
    """Speed of points ``(..., time, points, 2 or 3)``, ``(..., time, points)`` metres a second."""
    return np.linalg.norm(np.gradient(points, axis=-3), axis=-1) * FPS


def smoothed(values: np.ndarray, deviation: float) -> np.ndarray:
    """Values ``(time, ...)`` averaged over time with a Gaussian of that many frames; the ends are held."""
    reach = int(np.ceil(3 * deviation))
    weights = np.exp(-0.5 * (np.arange(-reach, reach + 1) / deviation) ** 2)
    held = np.concatenate([values[:1].repeat(reach, 0), values, values[-1:].repeat(reach, 0)])
    windows = np.lib.stride_tricks.sliding_window_view(held, len(weights), axis=0)
    return windows @ (weights / weights.sum())


def floor_height(positions: np.ndarray) -> float:
    """Height of the floor under one person ``(time, 31, 3)``: low feet among those that hardly move, metres.

    The fifth percentile, so that a few frames below the floor do not pull it down.
    """
    feet = positions[:, FEET]
    slow = feet[..., 2][speed(feet) < SPEED_M_S]
    return float(np.percentile(slow if len(slow) else feet[..., 2], 5))


def foot_contact(positions: np.ndarray, floor_m: float = 0.0) -> np.ndarray:
    """Which of the two feet stand, ``(time, 2)`` bool, left and right.

    Args:
        positions: One person, ``(time, 31, 3)``.
        floor_m: Height of the floor, or of what is stood on.
    """
    feet = positions[:, FEET]
    low, slow = feet[..., 2] - floor_m < HEIGHT_M, speed(feet) < SPEED_M_S
    standing = np.any(low.reshape(-1, 2, 2), -1) & np.any(slow.reshape(-1, 2, 2), -1)
    return np.stack([lasting(side, LEAST) for side in standing.T], -1)


def sliding(feet: np.ndarray) -> np.ndarray:
    """Mean horizontal speed of the middle of feet in contact, ``(...)`` metres a second.

    The middle between ball and tip: a foot that turns on its spot does not slide.

    Args:
        feet: The joints ``FEET`` of one person, ``(..., time, 4, 3)``.
    """
    sides = feet.reshape(*feet.shape[:-2], 2, 2, 3)
    pace = speed(sides[..., :2].mean(-2))
    standing = (sides[..., 2].min(-1) < HEIGHT_M) & (pace < 2 * SPEED_M_S)
    return (pace * standing).sum((-2, -1)) / np.maximum(standing.sum((-2, -1)), 1)


def runs(mask: np.ndarray) -> list[tuple[int, int]]:
    """First frames and ends (exclusive) of the runs of True in ``(time,)``.

    Example:
        >>> runs(np.array([True, True, False, True]))
        [(0, 2), (3, 4)]
    """
    edges = np.flatnonzero(np.diff(np.concatenate([[0], mask.astype(np.int8), [0]])))
    return [(int(first), int(end)) for first, end in zip(edges[::2], edges[1::2], strict=True)]


def lasting(mask: np.ndarray, least: int) -> np.ndarray:
    """The same mask ``(time,)`` without the runs of True that are shorter than ``least`` frames."""
    kept = np.zeros_like(mask)
    for first, end in runs(mask):
        kept[first:end] = end - first >= least
    return kept


def pivot(positions: np.ndarray) -> np.ndarray:
    """Where a person ``(time, 31, 3)`` stands, ``(time, 2)``: between the feet, nearer to the one at rest."""
    points = positions[:, FEET].reshape(len(positions), 2, 2, 3).mean(2)
    rest = np.exp(-((speed(points) / 0.4) ** 2) - (points[..., 2] / 0.06) ** 2) + 1e-3
    weight = smoothed(rest / rest.sum(-1, keepdims=True), 2)
    return (points[..., :2] * weight[..., None]).sum(1)
