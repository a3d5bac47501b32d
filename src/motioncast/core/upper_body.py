"""The upper body in an image: where it is seen from, and how far away it must be."""

from __future__ import annotations

import numpy as np

from motioncast.core.skeletons import UPPER9
from motioncast.errors import SceneError

NECK, PELVIS = UPPER9.index("neck"), UPPER9.index("pelvis")

TRUNK_M = 0.52
"""From hip to neck of most people: what tells how far away somebody is who is seen by one camera only."""


def from_neck(poses: np.ndarray) -> np.ndarray:
    """Poses ``(..., 9, 2 or 3)`` from the neck."""
    return poses - poses[..., NECK : NECK + 1, :]


def depth_m(pixels: np.ndarray, focal_px: float) -> np.ndarray:
    """How far from the camera people stand, by the size of their trunks.

    The longest trunk of the past counts: who bends towards the camera looks short, and nobody looks long. No forecast
    pose is looked at.

    Args:
        pixels: Past poses, ``(past, people, 9, 2)``; NaN where not seen.
        focal_px: Focal length of the camera.

    Returns:
        ``(people,)`` metres.

    Raises:
        SceneError: If somebody's neck and hip are never seen together.

    Example:
        >>> pose = np.zeros((1, 1, 9, 2))
        >>> pose[..., PELVIS, 1] = 130
        >>> depth_m(pose, 1000.0)
        array([4.])
    """
    trunk = np.linalg.norm(pixels[..., NECK, :] - pixels[..., PELVIS, :], axis=-1)
    longest = np.where(np.isnan(trunk), 0, trunk).max(0)
    if (longest <= 0).any():
        raise SceneError(
            f"neck and hip of person {int(np.argmin(longest)) + 1} are never seen together, so nobody knows how far "
            "away that is; give steps in which both are seen"
        )
    return focal_px * TRUNK_M / longest


def most_articulated(pixels: np.ndarray, first: int, end: int) -> int:
    """The frame of a step in which the hands are farthest from where they usually are in the whole video.

    Args:
        pixels: One person's poses, ``(frames, 9, 2)``; NaN where not seen.
        first: First frame of the step.
        end: The frame after its last.

    Raises:
        SceneError: If none of its frames shows a hand and the neck.

    Example:
        >>> poses = np.zeros((5, 9, 2))
        >>> poses[3, UPPER9.index("left_wrist")] = 40, 30
        >>> most_articulated(poses, 1, 5)
        3
    """
    hands = from_neck(pixels)[:, [UPPER9.index("right_wrist"), UPPER9.index("left_wrist")]]
    seen: np.ndarray = ~np.isnan(hands[..., 0])
    if not seen[first:end].any():
        raise SceneError(
            f"frames {first} to {end - 1} show no hand together with the neck; leave that step out, or name its "
            "characteristic frame"
        )
    far = np.zeros(seen.shape)
    for hand, there in enumerate(seen.T):
        usual = np.median(hands[there, hand], 0)
        far[there, hand] = np.linalg.norm(hands[there, hand] - usual, axis=-1)
    return first + int(far[first:end].sum(1).argmax())
