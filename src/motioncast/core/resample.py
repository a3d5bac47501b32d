"""Another frame rate: Lanczos' windowed sinc, which never looks past the last frame.

The same kernel interpolates upwards and, stretched, filters downwards. Beyond either end the motion is continued
by point reflection, x(end + t) = 2 x(end) - x(end - t): a symmetric kernel then leaves the end pose and its
velocity exactly as they are.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from motioncast.core.rotation import slerp
from motioncast.core.scene import Scene
from motioncast.errors import SceneError

LOBES = 3


def resample(scene: Scene, fps: float) -> Scene:
    """The scene at another frame rate, anchored at its last frame.

    A joint is observed in a new frame where both frames around that moment observed it; gaps are bridged by
    straight lines before filtering and stay masked, and who comes or goes has the same exact ends.

    Args:
        scene: Any scene.
        fps: The new frame rate.

    Raises:
        SceneError: If the rate is not a positive number.

    Example:
        >>> from motioncast.core.skeletons import MRT15
        >>> x = np.linspace(0, 1, 61, dtype=np.float32)
        >>> scene = Scene(np.broadcast_to(x[:, None, None, None], (61, 1, 15, 3)), MRT15, 60)
        >>> slow = resample(scene, 15)
        >>> slow.frames, float(slow.positions[-1, 0, 0, 0])
        (16, 1.0)
    """
    if fps == scene.fps:
        return scene
    if not (np.isfinite(fps) and fps > 0):
        raise SceneError(f"the new frame rate is {fps}; expected a positive number of frames a second")
    step = scene.fps / fps
    count = int((scene.frames - 1) / step + 1e-9) + 1
    times = scene.frames - 1 - step * np.arange(count - 1, -1, -1)
    before = np.floor(times + 1e-9).astype(int)
    after = np.minimum(np.ceil(times - 1e-9).astype(int), scene.frames - 1)
    rotations = scene.rotations
    if rotations is not None:
        rotations = slerp(rotations[before], rotations[after], (times - before)[:, None, None]).astype(np.float32)
    return replace(
        scene,
        positions=sample(_continued(scene), times, step).astype(np.float32),
        observed=scene.observed[before] & scene.observed[after],
        rotations=rotations,
        fps=fps,
    )


def _continued(scene: Scene) -> np.ndarray:
    """Positions whose gaps are bridged, and which go on by point reflection before and after each joint is seen."""
    positions, observed = bridge(scene.positions, scene.observed), scene.observed
    time = np.arange(scene.frames)
    for person, joint in np.argwhere(~observed.all(0) & observed.any(0)):
        first, last = np.flatnonzero(observed[:, person, joint])[[0, -1]]
        end = np.clip(time, first, last)
        mirror = np.clip(2 * end - time, first, last)
        track = positions[:, person, joint]
        positions[:, person, joint] = np.where((time == end)[:, None], track, 2 * track[end] - track[mirror])
    return positions


def sample(values: np.ndarray, times: np.ndarray, step: float = 1.0) -> np.ndarray:
    """Values between frames.

    Args:
        values: ``(frames, ...)``.
        times: Moments in frames, ``(n,)``, within the first and the last frame.
        step: Distance of the moments in frames; above 1 the values are low-pass filtered to what it can carry.

    Returns:
        ``(n, ...)`` float64.

    Example:
        >>> sample(np.array([0.0, 1.0, 2.0, 3.0]), np.array([3.0, 2.0]))
        array([3., 2.])
    """
    frames, stretch = len(values), max(1.0, step)
    reach = int(np.ceil(LOBES * stretch))
    index = np.floor(times + 1e-9).astype(int)[:, None] + np.arange(-reach, reach + 2)
    offset = (index - times[:, None]) / stretch
    weights = np.where(np.abs(offset) < LOBES, np.sinc(offset) * np.sinc(offset / LOBES), 0.0)
    weights /= weights.sum(1, keepdims=True)
    # a windowed sinc bends straight motion a little, a ripple in the velocity; the two frames around take it back
    bend = (weights * (index - times[:, None])).sum(1)
    weights[:, reach] += bend
    weights[:, reach + 1] -= bend
    flat = values.reshape(frames, -1).astype(np.float64)
    result = np.zeros((len(times), flat.shape[1]))
    for tap in range(index.shape[1]):  # a loop over taps keeps long takes within memory
        at, weight = index[:, tap], weights[:, tap, None]
        end = np.clip(at, 0, frames - 1)
        mirror = np.clip(2 * end - at, 0, frames - 1)
        inside = (at == end)[:, None]
        result += weight * np.where(inside, flat[end], 2 * flat[end] - flat[mirror])
    return result.reshape(len(times), *values.shape[1:])


def bridge(positions: np.ndarray, observed: np.ndarray) -> np.ndarray:
    """Positions in which gaps are bridged by straight lines, and ends hold the nearest seen position.

    A joint that is never seen stands in the middle of those that are.

    Args:
        positions: ``(time, people, joints, 3)``.
        observed: ``(time, people, joints)`` bool.
    """
    if observed.all():
        return positions
    filled = positions.astype(np.float64)
    time = np.arange(len(positions))
    ever = np.any(observed, 0)
    for person, joint in np.argwhere(~observed.all(0) & ever):
        seen = observed[:, person, joint]
        for axis in range(3):
            track = filled[:, person, joint, axis]
            filled[:, person, joint, axis] = np.interp(time, time[seen], track[seen])
    middle = (filled * ever[..., None]).sum(2) / np.maximum(ever.sum(1), 1)[:, None]
    return np.where(ever[..., None], filled, middle[:, :, None])
