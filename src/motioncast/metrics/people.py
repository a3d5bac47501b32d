"""Do people keep clear of one another? Bodies are capsules: every bone is a rod with a radius."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations

import numpy as np

RADIUS_M = 0.05
"""Radius of a bone's capsule where no other is given: about that of a limb, less than that of a trunk."""


def gaps(
    motion: np.ndarray,
    bones: Sequence[tuple[int, int]],
    radius_m: float | np.ndarray = RADIUS_M,
    observed: np.ndarray | None = None,
) -> np.ndarray:
    """Smallest distance between the surfaces of each two people, ``(..., pairs)`` metres; negative where they overlap.

    The distance between the nearest points of all their bones less both radii. It cannot be less than minus the sum
    of the radii: rods that cross overlap by no more.

    Args:
        motion: ``(..., people, joints, 3)`` metres.
        bones: Pairs of joints: :attr:`motioncast.core.skeleton.Skeleton.bones`.
        radius_m: Radius of all bones, or ``(bones,)``.
        observed: ``(..., people, joints)``; a bone counts where both its ends were seen. Default: all.

    Returns:
        Pairs in the order (0, 1), (0, 2), ..., (1, 2), ...; infinite where one of the two has no bone that was seen.

    Example:
        >>> upright = np.array([[0.0, 0, 0], [0, 0, 1]])
        >>> gaps(np.stack([upright, upright + [0.3, 0, 0.5]]), [(1, 0)], radius_m=0.1).round(6)
        array([0.1])
    """
    motion = np.asarray(motion, np.float64)
    ends, starts = (list(side) for side in zip(*bones, strict=True))
    rods = np.stack([motion[..., starts, :], motion[..., ends, :]], -2)  # (..., people, bones, 2, 3)
    seen = None if observed is None else observed[..., starts] & observed[..., ends]
    radii = np.broadcast_to(radius_m, len(ends))
    pairs = []
    for one, other in combinations(range(motion.shape[-3]), 2):
        between = rod_distance(rods[..., one, :, None, :, :], rods[..., other, None, :, :, :])
        between -= radii[:, None] + radii
        if seen is not None:
            between[~(seen[..., one, :, None] & seen[..., other, None, :])] = np.inf
        pairs.append(between.min((-2, -1)))
    return np.stack(pairs, -1) if pairs else np.zeros((*motion.shape[:-3], 0))


def rod_distance(one: np.ndarray, other: np.ndarray) -> np.ndarray:
    """Distance between the nearest points of two rods (line segments), ``(...)``.

    Args:
        one: Its two ends, ``(..., 2, 3)``.
        other: Likewise.

    Example:
        >>> along_x, along_y = np.array([[0.0, 0, 0], [2, 0, 0]]), np.array([[1.0, -1, 3], [1, 1, 3]])
        >>> float(rod_distance(along_x, along_y))  # they cross, 3 m apart
        3.0
    """
    one, other = np.broadcast_arrays(one, other)
    (a, b), (c, d) = np.moveaxis(one, -2, 0), np.moveaxis(other, -2, 0)
    # the nearest points are an end of one of the rods, or lie inside both where the lines come nearest
    distances = [
        _to_rod(a, c, d), _to_rod(b, c, d), _to_rod(c, a, b), _to_rod(d, a, b)
    ]  # fmt: skip
    u, v, w = b - a, d - c, a - c
    uu, uv, vv, uw, vw = _dot(u, u), _dot(u, v), _dot(v, v), _dot(u, w), _dot(v, w)
    area = uu * vv - uv * uv
    crossing = area > 1e-12 * uu * vv  # parallel rods are nearest at an end, too
    divisor = np.where(crossing, area, 1)
    s, t = (uv * vw - vv * uw) / divisor, (uu * vw - uv * uw) / divisor
    inside = crossing & (s >= 0) & (s <= 1) & (t >= 0) & (t <= 1)
    across = np.linalg.norm(w + s[..., None] * u - t[..., None] * v, axis=-1)
    return np.minimum(np.min(distances, 0), np.where(inside, across, np.inf))


def _to_rod(point: np.ndarray, start: np.ndarray, end: np.ndarray) -> np.ndarray:
    along, apart = end - start, point - start
    square = _dot(along, along)
    share = np.clip(_dot(apart, along) / np.where(square > 0, square, 1), 0, 1)
    rest = apart - share[..., None] * along
    return np.sqrt(_dot(rest, rest))


def _dot(one: np.ndarray, other: np.ndarray) -> np.ndarray:
    return np.einsum("...i,...i", one, other)


def minimum_distance(gap: np.ndarray) -> np.ndarray:
    """How near any two people come, ``(...)`` metres between surfaces; negative where they overlap.

    Infinite for a person alone.

    Args:
        gap: ``(..., time, pairs)`` of :func:`gaps`.

    Example:
        >>> float(minimum_distance(np.array([[0.5, 0.2], [0.4, 0.3]])))
        0.2
    """
    return gap.min((-2, -1), initial=np.inf)


def nearest_approach(path: np.ndarray, observed: np.ndarray | None = None) -> np.ndarray:
    """How near each two people come over the ground, ``(pairs,)`` metres.

    Args:
        path: ``(time, people, 2)`` metres (:func:`motioncast.metrics.paths.root_path`).
        observed: ``(time, people)``; a pair counts in the frames in which both are seen. Default: all.

    Returns:
        Pairs in the order (0, 1), (0, 2), ..., (1, 2), ...; NaN of pairs that are never seen together.

    Example:
        >>> to_and_fro = np.array([[[0.0, 0.0], [3.0, 4.0]], [[0.0, 0.0], [0.6, 0.8]], [[0.0, 0.0], [3.0, 4.0]]])
        >>> nearest_approach(to_and_fro).round(6)
        array([1.])
    """
    one, other = np.triu_indices(path.shape[1], 1)
    distance = np.linalg.norm(np.subtract(path[:, one], path[:, other], dtype=np.float64), axis=-1)
    if observed is not None:
        distance = np.where(observed[:, one] & observed[:, other], distance, np.inf)
    nearest = distance.min(0, initial=np.inf)
    return np.where(np.isfinite(nearest), nearest, np.nan)


def penetration(gap: np.ndarray, tolerance_m: float = 0.0) -> tuple[float, float]:
    """How often and how deep people are in one another.

    Args:
        gap: ``(..., pairs)`` of :func:`gaps`.
        tolerance_m: Depth that is still touching.

    Returns:
        Share of pairs and frames, of those where both were seen, that are deeper than the tolerance, and the mean
        depth of these in metres (0 where there are none).

    Example:
        >>> penetration(np.array([0.3, -0.02, -0.04, np.inf, 0.1]))
        (0.5, 0.03)
    """
    seen = gap[np.isfinite(gap)]
    deep = seen[seen < -tolerance_m]
    return len(deep) / max(len(seen), 1), float(-deep.mean()) if len(deep) else 0.0
