"""Tables of errors against what really happened."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from motioncast.cli.say import table
from motioncast.metrics.curve import error_at

MOMENTS_S = (0.2, 0.4, 1.0, 2.0, 3.0)


def error_table(curves: Mapping[str, np.ndarray], fps: float) -> None:
    """Prints the mean joint error of each forecast at some moments, in millimetres.

    Args:
        curves: Name of the forecaster -> error in metres at each frame.
        fps: Frames a second.
    """
    told = [seconds for seconds in MOMENTS_S if any(error_at(curve, seconds, fps) for curve in curves.values())]
    rows = [(name, *(_millimetres(error_at(curve, seconds, fps)) for seconds in told)) for name, curve in curves.items()]
    table(("error in mm after", *(f"{seconds:g} s" for seconds in told)), rows)


def _millimetres(error: float | None) -> str:
    return "-" if error is None else f"{error * 1000:.0f}"
