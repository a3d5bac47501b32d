"""Figures of steps: actions that are right, poses that are near in the image and in space, poses that can be."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from motioncast.benchmarks.kitchen.guesses import Answer
from motioncast.benchmarks.result import Row
from motioncast.datasets.action_windows import ActionWindows
from motioncast.metrics.actions import asymmetry, looks_real, pixel_errors, pose_errors, scaled_pose_errors, top_k
from motioncast.metrics.bootstrap import draws

Judge = Sequence[tuple[np.ndarray, np.ndarray]]
"""Weights of the classifier of poses (``metrics.actions.looks_real``)."""


def figures(windows: ActionWindows, history: int, answer: Answer, judge: Judge | None = None) -> dict[str, np.ndarray]:
    """Every metric of an answer, ``(windows, steps, people)``."""
    actions, pixels, seen = (values[:, history:] for values in (windows.actions, windows.pixels, windows.seen))
    found: dict[str, np.ndarray] = {}
    if answer.scores is not None:
        found["top_1"], found["top_3"] = (top_k(answer.scores, actions, k) for k in (1, 3))
    if answer.pixels is not None:
        found["pixel_error"] = pixel_errors(answer.pixels, pixels, seen)
    if answer.poses is not None:
        truth = windows.truth[:, history:]
        found["pose_error"] = 1000 * pose_errors(answer.poses, truth)
        found["scaled_pose_error"] = 1000 * scaled_pose_errors(answer.poses, truth)
        found["asymmetry"] = 1000 * asymmetry(answer.poses)
        if judge is not None:
            found["quality"] = looks_real(answer.poses, judge)
    return found


RESAMPLES = 400

UNITS = {"pixel_error": "px", "pose_error": "mm", "scaled_pose_error": "mm", "asymmetry": "mm"}


def rows(windows: ActionWindows, found: dict[str, np.ndarray]) -> list[Row]:
    """Each metric at each step (``_at``, the step in the place of seconds) and over all of them (``_until`` the last).

    Intervals are those of a bootstrap over sequences.
    """
    drawn = draws(np.unique(windows.names, return_inverse=True)[1][:, None].tolist(), RESAMPLES)
    listed = []
    for metric, values in found.items():
        whole = np.nanmean(values, -1)
        for step in range(whole.shape[1]):
            listed.append(_row(f"{metric}_at", step + 1, whole[:, step], drawn))
        listed.append(_row(f"{metric}_until", whole.shape[1], np.nanmean(whole, 1), drawn))
    return listed


def _row(metric: str, step: int, values: np.ndarray, drawn: np.ndarray) -> Row:
    """A mean over windows, with its interval."""
    seen = np.isfinite(values)
    again = drawn @ np.where(seen, values, 0) / np.maximum(drawn @ seen, 1)
    low, high = np.percentile(again, [2.5, 97.5])
    unit = UNITS.get(metric.rpartition("_")[0], "1")
    return Row(metric, float(step), float(np.nanmean(values)), unit, int(seen.sum()), float(low), float(high))
