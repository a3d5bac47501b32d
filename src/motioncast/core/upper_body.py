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
