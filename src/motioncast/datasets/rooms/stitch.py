"""Joining two pieces of motion: where they look alike, blended over 0.4 s, and not where feet would slide.

Motion graphs (Kovar, Gleicher, Pighin, SIGGRAPH 2002): distance of pose and velocity in the body's own frame.
"""

from __future__ import annotations

import numpy as np

from motioncast.datasets.rooms.bodies import facing, turned, with_lengths
from motioncast.datasets.rooms.contacts import pivot, sliding

BLEND = 10
"""Frames of a blend: 0.4 s."""

MIDDLE = BLEND // 2
FARTHEST_M = 0.15
"""Pose and velocity may differ by this much, root mean square over joints."""

MORE_SLIDING_M_S = 0.03
"""Feet may slide this much more in a blend."""

WAYS = 8
"""Continuations that are known for each frame."""


def placed(positions: np.ndarray, angle: np.ndarray | float, shift: np.ndarray) -> np.ndarray:
    """Positions ``(..., 3)`` turned about the vertical, then shifted in the plane."""
    there = turned(positions, angle)
    there[..., :2] += shift
    return there


def onto(still: np.ndarray, moving: np.ndarray, middle: int) -> tuple[float, np.ndarray]:
    """The turn (radians) and shift ``(2,)`` that lay one motion onto another in one frame.

    They face the same way, and the standing foot of one stands where that of the other does.

    Args:
        still: ``(time, 31, 3)``.
        moving: Likewise.
        middle: The frame of both.
    """
    angle = float(facing(still[middle]) - facing(moving[middle]))
    return angle, pivot(still)[middle] - turned(pivot(moving)[middle], angle)


def blended(tail: np.ndarray, head: np.ndarray, lengths: np.ndarray) -> np.ndarray:
    """From one motion to another, both ``(BLEND, 31, 3)`` in one world, with bones of constant length."""
    share = (np.arange(BLEND) + 1) / (BLEND + 1)
    share = (share**2 * (3 - 2 * share))[:, None, None]
    return with_lengths((1 - share) * tail + share * head, lengths)


def slides(mixed: np.ndarray, usual: float) -> bool:
    """Whether feet slide in a blend clearly more than they do in nine of ten pieces of the walk it is made of."""
    return sliding(mixed) > usual + MORE_SLIDING_M_S


def usual_sliding(gait_positions: np.ndarray) -> float:
    """What feet slide in a piece of a blend's length: not exceeded by nine of ten, metres a second."""
    pieces = range(0, len(gait_positions) - BLEND, BLEND // 2)
    return float(np.percentile([sliding(gait_positions[first : first + BLEND]) for first in pieces], 90))


def continuations(features: np.ndarray, firsts: np.ndarray, ends: np.ndarray, least: int) -> np.ndarray:
    """Frames that look most like each frame of a walk and can take its place in the middle of a blend.

    Args:
        features: ``(frames, features)``, see ``gait.features``.
        firsts: First frame of the stretch that each frame belongs to.
        ends: End of that stretch.
        least: Frames of its stretch that must follow a continuation.

    Returns:
        ``(frames, WAYS)`` indices, best first; -1 where there is none within ``FARTHEST_M``.
    """
    index = np.arange(len(features))
    fits = (ends - index >= least) & (index - firsts >= MIDDLE)
    square = (features**2).sum(-1)
    distance = np.sqrt(np.maximum(square[:, None] + square - 2 * features @ features.T, 0))
    distance[:, ~fits] = np.inf
    distance[np.abs(index[:, None] - index) <= BLEND] = np.inf
    found = np.full((len(features), WAYS), -1)
    for way in range(WAYS):
        best = distance.argmin(1)
        near = distance[index, best] < FARTHEST_M
        found[near, way] = best[near]
        # the next one is another moment, not its neighbour
        for beside in range(-2, 3):
            distance[index, np.clip(best + beside, 0, len(features) - 1)] = np.inf
    return found
