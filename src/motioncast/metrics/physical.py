"""Can a body move like that? Feet that slide, bones that stretch, jerk, and a jump where the forecast begins.

Compare each with its value for real motion, which is not zero.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from motioncast.metrics.masks import seen_mean

CONTACT_M = 0.025
"""A foot this far above the ground no longer touches it."""


def foot_skating(
    motion: np.ndarray, feet: Sequence[int], ground_m: Sequence[float], fps: float, observed: np.ndarray | None = None
) -> np.ndarray:
    """How fast feet slide while they are on the ground, ``(...)`` metres a second.

    Mean over feet and steps of the horizontal speed times ``2 - 2^(h / 2.5 cm)``, clipped to 0..1, with the height h
    above the ground at the end of the step: Zhang et al., Mode-adaptive neural networks (SIGGRAPH 2018).

    Args:
        motion: ``(..., time, joints, 3)`` metres, z up.
        feet: The joints of the feet.
        ground_m: Height of each of them when it stands: an ankle is above the floor.
        fps: Frames a second.
        observed: ``(..., time, joints)``. Default: all.

    Example:
        >>> slide = np.array([0.0, 0.02]).reshape(2, 1, 1) * [1, 0, 0]  # 2 cm in a tenth of a second
        >>> [float(foot_skating(slide, [0], [ground], fps=10).round(6)) for ground in (0.0, -0.025)]
        [0.2, 0.0]
    """
    places = np.asarray(motion, np.float64)[..., list(feet), :]
    speeds = np.linalg.norm(np.diff(places[..., :2], axis=-3), axis=-1) * fps
    heights = places[..., 1:, :, 2] - np.asarray(ground_m)
    contact = np.clip(2 - 2 ** np.minimum(heights / CONTACT_M, 1), 0, 1)
    seen = None if observed is None else _runs(observed[..., list(feet)], 2)
    return seen_mean(speeds * contact, seen, (-2, -1))


def bone_length_drift(
    motion: np.ndarray,
    reference: np.ndarray,
    bones: Sequence[tuple[int, int]],
    observed: np.ndarray | None = None,
) -> np.ndarray:
    """Mean change of bone lengths, ``(..., time)`` metres.

    Args:
        motion: ``(..., time, joints, 3)`` metres.
        reference: ``(..., joints, 3)``: the pose that has the right lengths, such as the last observed one.
        bones: Pairs of joints: :attr:`motioncast.core.skeleton.Skeleton.bones`.
        observed: ``(..., joints)`` of the reference. Default: all.

    Example:
        >>> bone = np.array([[0.0, 0, 0], [0, 0, 0.4]])
        >>> bone_length_drift(np.stack([bone, 1.5 * bone]), bone, [(1, 0)])
        array([0. , 0.2])
    """
    ends, starts = (list(side) for side in zip(*bones, strict=True))
    lengths, right = (
        np.linalg.norm(np.subtract(pose[..., ends, :], pose[..., starts, :], dtype=np.float64), axis=-1)
        for pose in (motion, reference)
    )
    seen = None if observed is None else (observed[..., ends] & observed[..., starts])[..., None, :]
    return seen_mean(np.abs(lengths - right[..., None, :]), seen, -1)


def mean_jerk(motion: np.ndarray, fps: float, observed: np.ndarray | None = None) -> np.ndarray:
    """Mean length of the third derivative of joint positions, ``(...)`` m/s^3.

    Args:
        motion: ``(..., time, joints, 3)`` metres, at least four frames.
        fps: Frames a second.
        observed: ``(..., time, joints)``; four frames in a row must be seen. Default: all.

    Example:
        >>> cubic = (np.arange(6) / 10.0) ** 3  # its third derivative is 6
        >>> float(mean_jerk(cubic.reshape(6, 1, 1) * [1, 0, 0], fps=10).round(6))
        6.0
    """
    jerk = np.linalg.norm(np.diff(np.asarray(motion, np.float64), 3, axis=-3), axis=-1) * fps**3
    return seen_mean(jerk, None if observed is None else _runs(observed, 4), (-2, -1))


def seam_jump(history: np.ndarray, forecast: np.ndarray, fps: float, observed: np.ndarray | None = None) -> np.ndarray:
    """Change of velocity at the seam of history and forecast, mean over joints, ``(...)`` metres a second.

    Args:
        history: ``(..., time, joints, 3)`` metres; the last two frames are read.
        forecast: ``(..., time, joints, 3)``; the first is.
        fps: Frames a second.
        observed: ``(..., time, joints)`` of the history. Default: all.

    Example:
        >>> steady = np.arange(3).reshape(3, 1, 1) * [0.1, 0, 0]
        >>> [float(seam_jump(steady[:2], there, fps=10).round(6)) for there in (steady[2:], steady[1:2])]
        [0.0, 1.0]
    """
    around = np.concatenate([history[..., -2:, :, :], forecast[..., :1, :, :]], -3)
    seen = None if observed is None else np.concatenate([observed[..., -2:, :], observed[..., -1:, :]], -2)
    return velocity_change(around, fps, seen)[..., 0]


def velocity_change(motion: np.ndarray, fps: float, observed: np.ndarray | None = None) -> np.ndarray:
    """Change of velocity from each step to the next, mean over joints, ``(..., time - 2)`` metres a second.

    Of real motion it is what a seam is to be compared with: the mean at the seam over the mean at every moment.

    Args:
        motion: ``(..., time, joints, 3)`` metres.
        fps: Frames a second.
        observed: ``(..., time, joints)``; three frames in a row must be seen. Default: all.

    Example:
        >>> start = np.array([0.0, 0.0, 0.1, 0.2]).reshape(4, 1, 1) * [1, 0, 0]
        >>> velocity_change(start, fps=10).round(6)
        array([1., 0.])
    """
    changes = np.linalg.norm(np.diff(np.asarray(motion, np.float64), 2, axis=-3), axis=-1) * fps
    return seen_mean(changes, None if observed is None else _runs(observed, 3), -1)


def _runs(observed: np.ndarray, length: int) -> np.ndarray:
    """Where ``length`` frames in a row were seen, ``(..., time - length + 1, joints)``."""
    return np.all(np.lib.stride_tricks.sliding_window_view(observed, length, axis=-2), -1)
