"""``motioncast evaluate``: a model measured by a benchmark."""

from __future__ import annotations

from dataclasses import asdict
from pathlib import Path

from motioncast.cli.say import emit, table


def evaluate(model: str, benchmark: str, /, *, data: Path, json: bool = False) -> None:
    """Measure a model by a benchmark.

    Args:
        model: Name of a model, or an ONNX file.
        benchmark: Name of a benchmark.
        data: Folder that holds the data sets.
        json: Print the result as one JSON object.
    """
    from motioncast.benchmarks.run import evaluate as measure

    result = measure(model, benchmark, data)
    if json:
        emit(asdict(result))
