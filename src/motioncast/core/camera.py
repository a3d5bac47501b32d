"""The camera: where the points of a world fall in an image."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from motioncast.core.rotation import conjugate, from_matrix, rotate
from motioncast.errors import InputError

NEAREST_M = 0.05
"""Points that are not so far in front of the camera have no place in its image."""


@dataclass(frozen=True, slots=True, eq=False)
class Camera:
    """A pinhole camera that stands still; it looks along its own -z, y up and x to the right, as OpenGL has it.

    Attributes:
        focal_px: Focal length in pixels.
        centre_px: Where the optical axis meets the image, ``(2,)``, from its upper left corner, y down.
        size_px: Width and height of the image.
        position: Where it stands, ``(3,)`` metres, world.
        rotation: How it is turned, from its own axes to the world's, quaternion wxyz.

    Raises:
        InputError: If a number is not finite, or focal length or size is not positive.
    """

    focal_px: float
    centre_px: np.ndarray
    size_px: np.ndarray
    position: np.ndarray
    rotation: np.ndarray

    def __post_init__(self) -> None:
        for name, count in (("centre_px", 2), ("size_px", 2), ("position", 3), ("rotation", 4)):
            value = np.asarray(getattr(self, name), np.float64)
            if value.shape != (count,) or not np.isfinite(value).all():
                raise InputError(f"{name} of the camera is {value.tolist()}; expected {count} finite numbers")
            object.__setattr__(self, name, value)
        if not (np.isfinite(self.focal_px) and self.focal_px > 0 and (self.size_px > 0).all()):
            raise InputError(
                f"the camera has a focal length of {self.focal_px} and an image of {self.size_px.tolist()} pixels; "
                "expected positive numbers"
            )

    def seen(self, points: np.ndarray) -> np.ndarray:
        """World points ``(..., 3)`` from the camera: metres along its own axes."""
        return rotate(conjugate(self.rotation), points - self.position)

    def to_world(self, points: np.ndarray) -> np.ndarray:
        """Points ``(..., 3)`` along the camera's own axes, in the world."""
        return rotate(self.rotation, points) + self.position

    def project(self, points: np.ndarray) -> np.ndarray:
        """Where world points ``(..., 3)`` fall in the image, ``(..., 2)`` pixels; NaN behind the camera.

        Example:
            >>> camera = look_at(np.array([2.0, 0, 1]), np.array([0.0, 0, 1]))
            >>> camera.project(np.array([[0.0, 0, 1], [0, 0, 1.1], [0, 0.1, 1]])).round(6).tolist()
            [[640.0, 360.0], [640.0, 310.0], [690.0, 360.0]]
        """
        return self.project_seen(self.seen(points))

    def project_seen(self, points: np.ndarray) -> np.ndarray:
        """As :meth:`project`, of points along the camera's own axes (Eq. 4.2 of FutureHuman3D)."""
        depth = np.where(points[..., 2] < -NEAREST_M, -points[..., 2], np.nan)
        aside = points[..., :2] * np.array([1.0, -1.0]) / depth[..., None]
        return self.focal_px * aside + self.centre_px

    def unproject(self, pixels: np.ndarray, depth_m: np.ndarray) -> np.ndarray:
        """Points along the camera's own axes, ``(..., 3)``, of pixels ``(..., 2)`` so far in front, ``(...)`` metres.

        Example:
            >>> camera = look_at(np.array([2.0, 0, 1]), np.array([0.0, 0, 1]))
            >>> camera.unproject(np.array([690.0, 310.0]), np.array(2.0)).round(6).tolist()
            [0.1, 0.1, -2.0]
        """
        aside = (pixels - self.centre_px) * np.array([1.0, -1.0]) / self.focal_px
        return np.concatenate([aside, -np.ones_like(aside[..., :1])], -1) * np.asarray(depth_m)[..., None]


def look_at(
    position: np.ndarray, target: np.ndarray, focal_px: float = 1000.0, size_px: tuple[float, float] = (1280.0, 720.0)
) -> Camera:
    """A camera that looks at a point, upright in a world whose z is up.

    Args:
        position: Where it stands, ``(3,)`` metres.
        target: What falls into the middle of the image, ``(3,)`` metres.
        focal_px: Focal length.
        size_px: Width and height of the image.

    Raises:
        InputError: If the target is straight above or below, or where the camera is.
    """
    back = np.asarray(position, np.float64) - target
    right = np.cross([0.0, 0.0, 1.0], back)
    if np.linalg.norm(right) < 1e-9:
        raise InputError("the camera looks straight up or down and does not know its right; move it or its target")
    right, back = right / np.linalg.norm(right), back / np.linalg.norm(back)
    rotation = from_matrix(np.stack([right, np.cross(back, right), back], -1))
    return Camera(focal_px, 0.5 * np.array(size_px), np.array(size_px), np.asarray(position, np.float64), rotation)
