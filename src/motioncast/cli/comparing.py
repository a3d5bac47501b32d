"""Tables of what is forecast, and of its errors against what really happened."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from motioncast.cli.say import table
from motioncast.core.forecast import Forecast
from motioncast.core.scene import Scene
from motioncast.metrics.curve import error_at, error_curve

MOMENTS_S = (0.2, 0.4, 1.0, 2.0, 3.0)

STANDING_STILL = "zero-velocity"
"""The guess that every forecast is compared with."""


def moments(frames: int, fps: float) -> tuple[float, ...]:
    """Seconds that a table tells about: some moments on the way, and the end.

    Example:
        >>> moments(18, fps=15), moments(3, fps=30)
        ((0.2, 0.4, 1.0, 1.2), (0.1,))
    """
    return (*(seconds for seconds in MOMENTS_S if 1 <= round(seconds * fps) < frames), frames / fps)


def error_curves(forecast: Forecast, truth: Scene) -> dict[str, np.ndarray]:
    """Error of a forecast at each frame, in metres, and of people who stand still, over the same joints."""
    from motioncast.inference.registry import load

    still = load(STANDING_STILL).forecast(forecast.history, horizon_s=forecast.horizon_s)
    answers = {forecast.card.name: forecast, STANDING_STILL: replace(still, carried=forecast.carried)}
    return {name: error_curve(answer, truth) for name, answer in answers.items()}


def error_table(curves: Mapping[str, np.ndarray], fps: float) -> None:
    """Prints the mean joint error of each forecast at some moments, in millimetres.

    Args:
        curves: Name of the forecaster -> error in metres at each frame.
        fps: Frames a second.
    """
    longest = max(map(len, curves.values()))
    told = moments(longest, fps)
    rows = [
        (name, *(_millimetres(error_at(curve, seconds, fps)) for seconds in told)) for name, curve in curves.items()
    ]
    table(("error in mm after", *map(_seconds, told)), rows)


def _seconds(moment: float) -> str:
    return f"{round(moment, 2):g} s"


def _millimetres(error: float | None) -> str:
    return "-" if error is None else f"{error * 1000:.0f}"


def summary(forecast: Forecast) -> None:
    """Prints how far each person is foretold to go, and the error radius, at some moments."""
    told = moments(len(forecast.best), forecast.fps)
    frames = [round(seconds * forecast.fps) - 1 for seconds in told]
    now = forecast.history.select(forecast.people)
    seen = now.observed[-1]  # (people, joints)
    rows = []
    for person, name in enumerate(forecast.people):
        joints = seen[person]
        start = now.positions[-1, person, joints].mean(0)
        goes = [np.linalg.norm(forecast.best[frame, person, joints].mean(0) - start) for frame in frames]
        rows.append((f"{name} goes", *(f"{distance:.2f} m" for distance in goes)))
    for level, radius in forecast.radius_m.items():
        means = [radius[frame, ~forecast.carried].mean() for frame in frames]
        rows.append((f"{float(level):.0%} of joints within", *(f"{mean:.2f} m" for mean in means)))
    table(("after", *map(_seconds, told)), rows)
