"""The one index convention of all metrics: frame k of a forecast, counted from 1, is at k / fps seconds.

Frame 0 is the last observed one. The true time of a moment is what is printed: frame 2 at 15 fps is at 133 ms,
whatever a paper's table calls it.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np


def frame_at(seconds: float, fps: float) -> int:
    """The frame, counted from 1, that is nearest to a moment.

    Example:
        >>> frame_at(0.133, fps=15), frame_at(1.0, fps=25)
        (2, 25)
    """
    return round(seconds * fps)


def seconds_at(frame: int, fps: float) -> float:
    """The time of a frame, counted from 1, in seconds after the last observed frame.

    Example:
        >>> round(seconds_at(2, fps=15), 3)
        0.133
    """
    return frame / fps


def at_frames(curve: np.ndarray, frames: Sequence[int]) -> np.ndarray:
    """The values ``(frames, ...)`` of a curve ``(time, ...)`` at frames counted from 1.

    Raises:
        IndexError: If the curve does not reach a frame.

    Example:
        >>> at_frames(np.array([0.1, 0.2, 0.3]), [1, 3])
        array([0.1, 0.3])
    """
    if min(frames) < 1:
        raise IndexError(f"the frames {list(frames)} were asked for; they are counted from 1")
    return curve[np.asarray(frames) - 1]
