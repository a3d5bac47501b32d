"""Characteristic moments of a motion, found without an annotator: where a movement is most articulated.

A person's *extent* says how far hands, feet and head are from where they usually are. A moment is a peak of it at which
the body pauses: the hand held out farthest, just before it comes back. Characteristic 3D Poses (Diller, Funkhouser and
Dai, CVPR 2022) had such frames marked by hand and names self-supervision as future work; this rule is ours.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from motioncast.core.scene import Scene
from motioncast.core.skeleton import Skeleton

WEIGHTS = {
    "left_wrist": 1.0, "right_wrist": 1.0, "left_ankle": 0.5, "right_ankle": 0.5, "head": 0.25,
}  # fmt: skip
"""How much a place of the body counts in the extent."""

PLACES = Skeleton(
    ("left_hip", "right_hip", *WEIGHTS), (-1,) * (2 + len(WEIGHTS)), ("left_hip", "right_hip", *WEIGHTS), "limbs"
)
"""What the extent looks at: the hips that say where ahead is, and the limbs."""

SMOOTHING_S = 0.25
"""Width of the smoothing Gaussian at half of its height."""

PROMINENCE_M = 0.08
"""How far a peak of the extent must stand out."""

PAUSE_S = 0.2
"""How far from a peak the body's speed must have a minimum."""

APART_S = 0.7
"""Least time between two moments."""


@dataclass(frozen=True, slots=True)
class Found:
    """A characteristic moment.

    Attributes:
        frame: Frame of the motion.
        extent_m: The person's extent there.
    """

    frame: int
    extent_m: float


def moments(scene: Scene, person: int = 0) -> list[Found]:
    """The characteristic moments of one person, in order of time.

    Raises:
        SkeletonError: If hips, wrists, ankles or head are missing.
    """
    extent, pace = extents(scene, person), speeds(scene, person)
    near, apart = round(PAUSE_S * scene.fps), APART_S * scene.fps
    pauses = np.flatnonzero(_dips(pace))
    peaks = [
        peak
        for peak in np.flatnonzero(_dips(-extent)).tolist()
        if prominence(extent, peak) >= PROMINENCE_M and np.any(np.abs(pauses - peak) <= near)
    ]
    kept: list[int] = []
    for peak in sorted(peaks, key=lambda peak: -extent[peak]):
        if scene.observed[peak, person].all() and all(abs(peak - other) >= apart for other in kept):
            kept.append(peak)
    return [Found(frame, float(extent[frame])) for frame in sorted(kept)]


def extents(scene: Scene, person: int = 0) -> np.ndarray:
    """How far hands, feet and head are from their usual places on the body, ``(time,)`` metres.

    Their distances from their medians in the frame of the hips, added with ``WEIGHTS``, smoothed over ``SMOOTHING_S``.

    Raises:
        SkeletonError: If hips, wrists, ankles or head are missing.
    """
    body = facing_ahead(scene, person)
    usual = np.median(body, axis=0)
    away = np.linalg.norm(body - usual, axis=-1) @ np.array(list(WEIGHTS.values()))
    return smooth(away, scene.fps)


def speeds(scene: Scene, person: int = 0) -> np.ndarray:
    """Mean speed of hands, feet and head against the hips, smoothed, ``(time,)`` m/s."""
    moved = np.linalg.norm(np.gradient(facing_ahead(scene, person), axis=0), axis=-1).mean(-1)
    return smooth(moved * scene.fps, scene.fps)


def facing_ahead(scene: Scene, person: int) -> np.ndarray:
    """The places of ``WEIGHTS`` from the middle of the hips, the left hip turned to +y, ``(time, 5, 3)`` metres."""
    left, right, *limbs = (
        scene.positions[:, person, list(group)].astype(np.float64).mean(1) for group in PLACES.map_from(scene.skeleton)
    )
    across = left - right
    yaw = np.arctan2(-across[:, 0], across[:, 1])
    cos, sin = np.cos(yaw)[:, None], np.sin(yaw)[:, None]
    x, y, z = np.moveaxis(np.stack(limbs, 1) - ((left + right) / 2)[:, None], -1, 0)
    return np.stack([cos * x + sin * y, cos * y - sin * x, z], -1)


def smooth(values: np.ndarray, fps: float) -> np.ndarray:
    """Values ``(time,)`` under a Gaussian that is ``SMOOTHING_S`` wide at half of its height; ends are held.

    Example:
        >>> smooth(np.ones(4), fps=30).round(9)
        array([1., 1., 1., 1.])
    """
    sigma = SMOOTHING_S * fps / np.sqrt(8 * np.log(2))
    reach = int(np.ceil(4 * sigma))
    kernel = np.exp(-0.5 * (np.arange(-reach, reach + 1) / sigma) ** 2)
    return np.convolve(np.pad(values, reach, mode="edge"), kernel / kernel.sum(), mode="valid")


def prominence(values: np.ndarray, peak: int) -> float:
    """How far a peak stands above the higher of the two valleys that part it from higher ground.

    Example:
        >>> prominence(np.array([0.0, 3.0, 1.0, 2.0, 0.0]), 3)
        1.0
    """
    higher = np.flatnonzero(values > values[peak])
    before, after = higher[higher < peak], higher[higher > peak]
    start = before[-1] if len(before) else 0
    end = after[0] if len(after) else len(values) - 1
    return float(values[peak] - max(values[start : peak + 1].min(), values[peak : end + 1].min()))


def _dips(values: np.ndarray) -> np.ndarray:
    """Frames that lie below the one before and not above the one after; the ends never do."""
    inside = (values[1:-1] < values[:-2]) & (values[1:-1] <= values[2:])
    return np.concatenate([[False], inside, [False]])
