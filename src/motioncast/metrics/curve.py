"""The error of a forecast over time, against what really happened."""

from __future__ import annotations

import numpy as np

from motioncast.core.forecast import Forecast
from motioncast.core.scene import Scene
from motioncast.metrics.moments import frame_at
from motioncast.metrics.position import mpjpe_at


def error_curve(forecast: Forecast, truth: Scene) -> np.ndarray:
    """Mean error of the most probable sample at each frame that the truth covers, ``(time,)`` metres.

    Joints that the model does not know are left out; a frame in which nobody was seen has NaN.

    Args:
        forecast: The forecast.
        truth: What really happened, from the first frame after the forecast's history on.

    Raises:
        SceneError: If the truth lacks a person that is forecast.
    """
    happened = truth.select(forecast.people)
    frames = min(len(forecast.best), happened.frames)
    known = ~forecast.carried
    return mpjpe_at(
        forecast.best[None, :frames, :, known],
        happened.positions[None, :frames, :, known],
        happened.observed[None, :frames, :, known],
    )


def error_at(curve: np.ndarray, seconds: float, fps: float) -> float | None:
    """The error at a moment of an error curve, in metres; None where the curve does not tell.

    Example:
        >>> error_at(np.array([0.1, 0.2, 0.3]), 0.2, fps=10), error_at(np.array([0.1]), 0.2, fps=10)
        (0.2, None)
    """
    frame = frame_at(seconds, fps)
    if not 1 <= frame <= len(curve) or np.isnan(curve[frame - 1]):
        return None
    return float(curve[frame - 1])
