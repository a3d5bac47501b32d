"""Windows of past and future steps, cut from videos, as arrays that a model learns from."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from motioncast.core.action_sequence import ActionSequence
from motioncast.core.upper_body import NECK, depth_m, from_neck
from motioncast.errors import SceneError


@dataclass(frozen=True, slots=True, eq=False)
class ActionWindows:
    """Windows of equal length: H past steps, then what came.

    Attributes:
        pixels: ``(windows, steps, people, 9, 2)``; 0 where not seen.
        seen: Which joints were seen together with the neck, ``(windows, steps, people, 9)``.
        actions: ``(windows, steps, people)``; -1 before the first step.
        objects: ``(windows, objects)`` float32.
        camera: Focal length and centre of the image, ``(windows, 3)`` pixels.
        depth: Of each person as the past tells it, ``(windows, people)`` metres.
        truth: ``(windows, steps, people, 9, 3)`` metres along the camera's axes from the neck; empty where unknown.
        names: The sequence of each window.
    """

    pixels: np.ndarray
    seen: np.ndarray
    actions: np.ndarray
    objects: np.ndarray
    camera: np.ndarray
    depth: np.ndarray
    truth: np.ndarray
    names: tuple[str, ...]

    def __len__(self) -> int:
        return len(self.actions)

    def past(self, history: int, rows: np.ndarray | slice = slice(None)) -> tuple[np.ndarray, ...]:
        """What a model is told of some windows: pixels, seen, actions, objects, camera, depth."""
        before = (values[rows, :history] for values in (self.pixels, self.seen, self.actions))
        return (*before, self.objects[rows], self.camera[rows], self.depth[rows])


def window_of(sequence: ActionSequence, history: int) -> ActionWindows:
    """A window that ends with a whole sequence; where it is shorter, steps before its first are missing.

    Raises:
        SceneError: If somebody's neck and hip are never seen together.
    """
    given = sequence.pixels[-history:]
    lacking = ((max(0, history - len(given)), 0), (0, 0))
    return _windows(
        [sequence.name],
        np.pad(given, (*lacking, (0, 0), (0, 0)), constant_values=np.nan)[None],
        np.pad(sequence.actions[-history:], lacking, constant_values=-1)[None],
        [sequence],
        history,
    )


def cut_steps(sequences: Iterable[ActionSequence], history: int, steps: int, stride: int = 1) -> ActionWindows:
    """All windows of ``history + steps`` steps.

    Args:
        sequences: The sequences; shorter ones have none.
        history: Past steps H.
        steps: Future steps.
        stride: Steps from one window to the next.

    Raises:
        SceneError: If no sequence is long enough.
    """
    length = history + steps
    found = [
        (sequence, slice(start, start + length))
        for sequence in sequences
        for start in range(0, len(sequence) - length + 1, stride)
    ]
    if not found:
        raise SceneError(f"no sequence has {length} steps; give longer ones, or ask for fewer steps")
    owners = [sequence for sequence, _ in found]
    pixels = np.stack([sequence.pixels[steps] for sequence, steps in found])
    actions = np.stack([sequence.actions[steps] for sequence, steps in found])
    truth = [
        sequence.camera.seen(sequence.positions[steps]) for sequence, steps in found if sequence.positions is not None
    ]
    return _windows([sequence.name for sequence in owners], pixels, actions, owners, history, truth)


def _windows(
    names: list[str],
    pixels: np.ndarray,
    actions: np.ndarray,
    owners: list[ActionSequence],
    history: int,
    truth: Iterable[np.ndarray] = (),
) -> ActionWindows:
    """Windows of pixels ``(windows, steps, people, 9, 2)``, NaN where not seen."""
    finite = np.all(np.isfinite(pixels), -1)
    seen = finite & finite[..., NECK : NECK + 1]
    cameras = [owner.camera for owner in owners]
    depth = [depth_m(past, camera.focal_px) for past, camera in zip(pixels[:, :history], cameras, strict=True)]
    exact = np.array([from_neck(poses) for poses in truth], np.float32)
    return ActionWindows(
        pixels=np.where(seen[..., None], pixels, 0).astype(np.float32),
        seen=seen,
        actions=actions.astype(np.int64),
        objects=np.stack([owner.objects for owner in owners]).astype(np.float32),
        camera=np.array([(camera.focal_px, *camera.centre_px) for camera in cameras], np.float32),
        depth=np.array(depth, np.float32),
        truth=exact,
        names=tuple(names),
    )
