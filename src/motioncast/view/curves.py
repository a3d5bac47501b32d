"""The curves beside the scene: errors where the truth is known, else the error radii."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from motioncast.core.forecast import Forecast
from motioncast.core.scene import Scene

Curves = Mapping[str, tuple[np.ndarray, np.ndarray]]
"""Name -> times in seconds after now, mean joint errors in metres."""


def drawn_curves(
    forecast: Forecast, truth: Scene | None, others: Curves, ahead: slice
) -> tuple[list[dict[str, Any]], str]:
    """What is drawn beside the scene: errors where the truth is known, else the error radii."""

    def curve(name: str, kind: str, times: np.ndarray, errors: np.ndarray) -> dict[str, Any]:
        known = np.isfinite(errors)
        return {
            "name": name, "kind": kind,
            "times": np.round(np.asarray(times)[known], 4).tolist(),
            "errors": np.round(np.asarray(errors)[known], 4).tolist(),
        }  # fmt: skip

    name = forecast.card.name
    drawn = []
    if name in others or truth is not None:
        times, errors = others[name] if name in others else joint_errors(forecast, truth)  # pyright: ignore[reportArgumentType]
        drawn.append(curve(name, "model", np.asarray(times)[ahead], np.asarray(errors)[ahead]))
    drawn += [
        curve(other, "baseline", np.asarray(times), np.asarray(errors))
        for other, (times, errors) in others.items()
        if other != name
    ]
    if drawn:
        return [entry for entry in drawn if entry["times"]], "Mean joint error"
    radii = [
        curve(
            f"{100 * float(level):.0f} % of joints within",
            "radius",
            forecast.times_s[ahead],
            radius.mean(1)[ahead],
        )
        for level, radius in forecast.radius_m.items()
    ]
    return radii, "Expected joint error"


def joint_errors(forecast: Forecast, truth: Scene) -> tuple[np.ndarray, np.ndarray]:
    """Times in seconds and the mean error in metres of the most probable sample at each.

    The mean runs over people and joints that the truth shows, joints that were only carried along left out;
    it is NaN where there are none.
    """
    frames = min(truth.frames, forecast.samples.shape[1])
    people = [person for person in forecast.people if person in truth.people]
    if not people:
        return forecast.times_s[:0], forecast.times_s[:0]
    rows = [forecast.people.index(person) for person in people]
    shown = truth[:frames].select(people)
    away = np.linalg.norm(forecast.best[:frames, rows] - shown.positions, axis=-1)
    counted = shown.observed & ~forecast.carried
    count = counted.sum((1, 2))
    total = np.where(counted, away, 0).sum((1, 2))
    return forecast.times_s[:frames], np.where(count > 0, total / np.maximum(count, 1), np.nan)
