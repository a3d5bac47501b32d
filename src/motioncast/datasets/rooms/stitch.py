"""Joining two pieces of motion: where they look alike, blended over 0.4 s, and not where feet would slide.

Motion graphs (Kovar, Gleicher, Pighin, SIGGRAPH 2002): distance of pose and velocity in the body's own frame.
"""

from __future__ import annotations

import numpy as np

from motioncast.datasets.rooms.bodies import turned, with_lengths
from motioncast.datasets.rooms.contacts import FEET, sliding

BLEND = 10
"""Frames of a blend: 0.4 s."""

MIDDLE = BLEND // 2
FARTHEST_M = 0.15
"""Pose and velocity may differ by this much, root mean square over joints."""

MORE_SLIDING_M_S = 0.03
"""Feet may slide this much more in a blend than in nine of ten pieces of the walk it is made of."""

WAYS, LOOKED_AT = 8, 24
"""Continuations that are kept for each frame, and how many are looked at."""


def placed(positions: np.ndarray, angle: np.ndarray | float, shift: np.ndarray) -> np.ndarray:
    """Positions ``(..., 3)`` turned about the vertical, then shifted in the plane."""
    there = turned(positions, angle)
    there[..., :2] += shift
    return there


def shares() -> np.ndarray:
    """How much of the motion that goes on is in each frame of a blend, ``(BLEND,)``."""
    share = (np.arange(BLEND) + 1) / (BLEND + 1)
    return share**2 * (3 - 2 * share)


def blended(tail: np.ndarray, head: np.ndarray, lengths: np.ndarray) -> np.ndarray:
    """From one motion to another, both ``(BLEND, 31, 3)`` in one world, with bones of constant length."""
    share = shares()[:, None, None]
    return with_lengths((1 - share) * tail + share * head, lengths)


def continuations(
    positions: np.ndarray,
    features: np.ndarray,
    looks: np.ndarray,
    pivots: np.ndarray,
    firsts: np.ndarray,
    ends: np.ndarray,
    least: int,
) -> np.ndarray:
    """Frames that can take the place of each frame of a walk in the middle of a blend, best first.

    They look alike, and feet slide no more in the blend than they do in the walk.

    Args:
        positions: The walk, ``(frames, 31, 3)``.
        features: ``(frames, features)``, see ``gait.features``.
        looks: Where the person faces, ``(frames,)`` radians.
        pivots: Where the person stands, ``(frames, 2)``.
        firsts: First frame of the stretch that each frame belongs to.
        ends: End of that stretch.
        least: Frames of its stretch that must follow a continuation.

    Returns:
        ``(frames, WAYS)`` indices; -1 where there are no more.
    """
    frames = len(features)
    index = np.arange(frames)
    inside = (index - firsts >= MIDDLE) & (ends - index >= BLEND - MIDDLE)
    square = (features**2).sum(-1)
    distance = np.sqrt(np.maximum(square[:, None] + square - 2 * features @ features.T, 0))
    distance[:, ~inside | (ends - index < least)] = np.inf
    distance[np.abs(index[:, None] - index) <= BLEND] = np.inf
    nearest = np.full((frames, LOOKED_AT), -1)
    for way in range(min(LOOKED_AT, frames)):
        best = distance.argmin(1)
        near = inside & (distance[index, best] < FARTHEST_M)
        nearest[near, way] = best[near]
        for beside in (-1, 0, 1):  # the next one is another moment
            distance[index, np.clip(best + beside, 0, frames - 1)] = np.inf
    last, way = np.nonzero(nearest >= 0)
    there = nearest[last, way]
    span = np.arange(BLEND) - MIDDLE
    tail, head = (positions[middle[:, None] + span][:, :, FEET].astype(np.float64) for middle in (last, there))
    angle = looks[last] - looks[there]
    shift = pivots[last] - turned(pivots[there], angle)
    share = shares()[:, None, None]
    mixed = (1 - share) * tail + share * placed(head, angle[:, None, None], shift[:, None, None])
    usual = np.percentile(sliding(positions[index[inside][:, None] + span][:, :, FEET]), 90)
    good = sliding(mixed) <= usual + MORE_SLIDING_M_S
    found = np.full((frames, WAYS), -1)
    counts = np.zeros(frames, int)
    for one, other in zip(last[good], there[good], strict=True):
        if counts[one] < WAYS:
            found[one, counts[one]] = other
            counts[one] += 1
    return found
