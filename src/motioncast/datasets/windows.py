"""Windows of takes: a history and the future that followed, cut at a fixed stride."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from motioncast.core.scene import Scene
from motioncast.core.skeleton import Skeleton
from motioncast.errors import InputError

COMPOSED = " + "
"""Between the takes of a composed scene, in the name of what a window comes from."""


@dataclass(frozen=True, slots=True, eq=False)
class Windows:
    """Many windows of the same length.

    Attributes:
        positions: ``(windows, time, people, joints, 3)`` float32, metres, z up.
        observed: ``(windows, time, people, joints)`` bool.
        takes: The take that each window comes from, or the takes of a composed scene joined by ``COMPOSED``;
            takes, not windows, are independent.
        starts: First frames of each window within its takes.
        history: Frames of history; the others are the future.
        seen: Positions and mask of the histories as a tracker saw them. Default: as they were captured.
        places: For composed scenes: where each group of people was set down (``mixer.Arrangement``).
    """

    positions: np.ndarray
    observed: np.ndarray
    takes: tuple[str, ...]
    starts: tuple[tuple[int, ...], ...]
    history: int
    seen: tuple[np.ndarray, np.ndarray] | None = None
    places: tuple[tuple[tuple[float, float, float], ...], ...] = ()

    def __len__(self) -> int:
        return len(self.positions)

    @property
    def past(self) -> tuple[np.ndarray, np.ndarray]:
        """Positions and mask of the histories: all that a model may see."""
        if self.seen is not None:
            return self.seen
        return self.positions[:, : self.history], self.observed[:, : self.history]

    @property
    def future(self) -> tuple[np.ndarray, np.ndarray]:
        """Positions and mask of what really happened."""
        return self.positions[:, self.history :], self.observed[:, self.history :]


def every(scene: Scene, fps: float, skeleton: Skeleton) -> Scene:
    """Every n-th frame of a scene, on another skeleton: exact samples, no frame looks at its neighbours.

    Raises:
        ValueError: If the rates are not whole multiples.
    """
    step = scene.fps / fps
    if step != round(step):
        raise ValueError(f"{scene.fps:g} frames a second are no multiple of {fps:g}; resample the scene")
    reduced = scene[:: round(step)].on(skeleton)
    return Scene(reduced.positions, skeleton, fps, reduced.observed, reduced.people, source=scene.source)


def sampled(scene: Scene, fps: float, skeleton: Skeleton) -> Scene:
    """A scene at another rate and on another skeleton, straight lines between its frames.

    A sample at time t is made of the frames just before and after t: a window whose last frame of history falls on
    a frame of the scene has nothing of the future in its history.
    """
    scene = scene.on(skeleton)
    times = np.arange(int((scene.frames - 1) * fps / scene.fps + 1e-9) + 1) * (scene.fps / fps)
    before = np.minimum((times + 1e-6).astype(int), scene.frames - 1)
    share = np.maximum(times - before, 0).astype(np.float32)[:, None, None, None]
    after = np.where(share[:, 0, 0, 0] > 1e-6, np.minimum(before + 1, scene.frames - 1), before)
    positions = scene.positions[before] * (1 - share) + scene.positions[after] * share
    observed = scene.observed[before] & scene.observed[after]
    return Scene(positions, skeleton, fps, observed, scene.people, source=scene.source)


def cut(scenes: list[Scene], history: int, horizon: int, stride: int = 5, first: int = 0) -> Windows:
    """Windows of scenes of the same number of people, every ``stride`` frames from the frame ``first`` on.

    A window is left out where somebody is not seen at all in its last frame of history.

    Raises:
        InputError: If no take gives a window.

    Example:
        >>> from motioncast.core.skeletons import MRT15
        >>> scene = Scene(np.zeros((71, 1, 15, 3), np.float32), MRT15, 15)
        >>> cut([scene], 15, 45).starts
        ((0,), (5,), (10,))
    """
    length = history + horizon
    pieces, masks, takes, starts = [], [], [], []
    for scene in scenes:
        for start in range(first, scene.frames - length + 1, stride):
            mask = scene.observed[start : start + length]
            if mask[history - 1].any(-1).all():
                pieces.append(scene.positions[start : start + length])
                masks.append(mask)
                takes.append(scene.source)
                starts.append((start,))
    if not pieces:
        raise InputError(
            f"{len(scenes)} takes came and none has {length} frames in which everybody is seen at now; give more takes"
        )
    return Windows(np.stack(pieces), np.stack(masks), tuple(takes), tuple(starts), history)
