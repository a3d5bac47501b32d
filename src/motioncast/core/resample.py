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

BLOCK = 32
"""Moments that one matrix product answers: fast, and long takes stay within memory."""


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
        objects=tuple(thing[np.round(times).astype(int)] for thing in scene.objects),
    )


def _continued(scene: Scene) -> np.ndarray:
    """Positions whose gaps are bridged, and which go on by point reflection before and after each joint is seen."""
    positions, observed = bridge(scene.positions, scene.observed), scene.observed
    parted = ~observed.all(0) & observed.any(0)
    seen, tracks, time = observed[:, parted], positions[:, parted], np.arange(scene.frames)[:, None]
    first, last = seen.argmax(0), scene.frames - 1 - seen[::-1].argmax(0)
    end = np.clip(time, first, last)
    mirror = np.clip(2 * end - time, first, last)[..., None]
    reflected = 2 * np.take_along_axis(tracks, end[..., None], 0) - np.take_along_axis(tracks, mirror, 0)
    positions[:, parted] = np.where((time == end)[..., None], tracks, reflected)
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
    earlier = np.minimum(np.arange(reach, 0, -1), frames - 1)
    later = np.maximum(frames - 2 - np.arange(reach + 1), 0)
    longer = np.concatenate([2 * flat[0] - flat[earlier], flat, 2 * flat[-1] - flat[later]])
    result = np.empty((len(times), flat.shape[1]))
    for start in range(0, len(times), BLOCK):
        block = slice(start, start + BLOCK)
        first = index[block].min()
        matrix = np.zeros((len(index[block]), index[block].max() + 1 - first))
        np.put_along_axis(matrix, index[block] - first, weights[block], 1)
        result[block] = matrix @ longer[first + reach : first + reach + matrix.shape[1]]
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
    ever = np.any(observed, 0)
    parted = ever & ~observed.all(0)
    filled[:, parted] = _straight(filled[:, parted], observed[:, parted])
    middle = (filled * ever[..., None]).sum(2) / np.maximum(ever.sum(1), 1)[:, None]
    return np.where(ever[..., None], filled, middle[:, :, None])


def _straight(tracks: np.ndarray, seen: np.ndarray) -> np.ndarray:
    """Tracks ``(time, n, 3)``, each seen ``(time, n)`` at least once, straight from sighting to sighting."""
    frames, time = len(seen), np.arange(len(seen))[:, None]
    before = np.maximum.accumulate(np.where(seen, time, -1))
    after = np.minimum.accumulate(np.where(seen, time, frames)[::-1])[::-1]
    before, after = np.where(before < 0, after, before), np.where(after == frames, before, after)
    start, end = (np.take_along_axis(tracks, index[..., None], 0) for index in (before, after))
    slope = (end - start) / np.maximum(after - before, 1)[..., None]
    return slope * (time - before)[..., None] + start
