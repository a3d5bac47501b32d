"""Tables of what is forecast, and of its errors against what really happened."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from motioncast.cli.say import table
from motioncast.core.forecast import Forecast
from motioncast.metrics.curve import error_at

MOMENTS_S = (0.2, 0.4, 1.0, 2.0, 3.0)


def error_table(curves: Mapping[str, np.ndarray], fps: float) -> None:
    """Prints the mean joint error of each forecast at some moments, in millimetres.

    Args:
        curves: Name of the forecaster -> error in metres at each frame.
        fps: Frames a second.
    """
    told = [seconds for seconds in MOMENTS_S if any(error_at(curve, seconds, fps) for curve in curves.values())]
    rows = [
        (name, *(_millimetres(error_at(curve, seconds, fps)) for seconds in told)) for name, curve in curves.items()
    ]
    table(("error in mm after", *(f"{seconds:g} s" for seconds in told)), rows)


def _millimetres(error: float | None) -> str:
    return "-" if error is None else f"{error * 1000:.0f}"


def summary(forecast: Forecast) -> None:
    """Prints how far each person is foretold to go, and the error radius, at some moments."""
    frames = {seconds: round(seconds * forecast.fps) - 1 for seconds in MOMENTS_S}
    told = {seconds: frame for seconds, frame in frames.items() if 0 <= frame < len(forecast.best)}
    now = forecast.history.select(forecast.people)
    seen = now.observed[-1]  # (people, joints)
    rows = []
    for person, name in enumerate(forecast.people):
        joints = seen[person]
        start = now.positions[-1, person, joints].mean(0)
        goes = [np.linalg.norm(forecast.best[frame, person, joints].mean(0) - start) for frame in told.values()]
        rows.append((f"{name} goes", *(f"{distance:.2f} m" for distance in goes)))
    for level, radius in forecast.radius_m.items():
        means = [radius[frame, ~forecast.carried].mean() for frame in told.values()]
        rows.append((f"{float(level):.0%} of joints within", *(f"{mean:.2f} m" for mean in means)))
    table(("after", *(f"{seconds:g} s" for seconds in told)), rows)
