"""``motioncast coverage``: how much of the truth the error radii hold."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from motioncast.cli import say


def coverage(model: str, benchmark: str, /, *, data: Path, json: bool = False) -> None:
    """Print how much of what really happened lies within a model's error radii, take by take.

    Args:
        model: Name of a model, or an ONNX file.
        benchmark: Name of a benchmark.
        data: Folder that holds the data sets.
        json: Print the shares as one JSON object.
    """
    from motioncast.benchmarks.calibration import coverage as measure

    shares = measure(model, benchmark, data)
    if json:
        say.emit({"schema": "motioncast.coverage/1", "model": model, "benchmark": benchmark, "takes": shares})
        return
    levels = list(next(iter(shares.values())))
    rows = [(take, *(f"{100 * share[level]:.0f} %" for level in levels)) for take, share in shares.items()]
    mean = [f"{100 * np.mean([share[level] for share in shares.values()]):.0f} %" for level in levels]
    say.table(
        ("take", *(f"meant {100 * float(level):.0f} %" for level in levels)),
        [*rows, ("mean of takes", *mean)],
    )
