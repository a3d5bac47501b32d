"""``motioncast evaluate``: a model measured by a benchmark."""

from __future__ import annotations

import subprocess
from dataclasses import asdict
from pathlib import Path
from typing import Literal

from motioncast.cli import say


def evaluate(
    model: str,
    benchmark: str,
    /,
    *,
    data: Path,
    split: Literal["test", "validation"] = "test",
    alone: bool = False,
    json: bool = False,
) -> None:
    """Measure a model by a benchmark.

    Args:
        model: Name of a model, or an ONNX file.
        benchmark: Name of a benchmark.
        data: Folder that holds the data sets.
        split: The validation split serves while something is still being chosen.
        alone: Forecast each person with the others hidden: what do they tell the model?
        json: Print the result as one JSON object.
    """
    from motioncast.benchmarks.run import evaluate as measure

    with say.progress(f"{model} on {benchmark}") as progress:
        result = measure(model, benchmark, data, split=split, alone=alone, progress=progress)
    if json:
        answer = {name: value for name, value in asdict(result).items() if name not in ("windows", "takes")}
        say.emit({**answer, "commit": commit()})
        return
    print(f"{result.model} on {result.benchmark}\n")
    say.table(
        ("metric", "after", "value", "95 % of takes"),
        [
            (
                row.metric,
                f"{row.horizon_s:.2f} s",
                f"{row.value:.3f}" if row.unit == "1" else f"{row.value:.1f} {row.unit}",
                "-" if row.low is None or row.high is None else f"{row.low:.4g} to {row.high:.4g}",
            )
            for row in result.rows
        ],
    )
    print(f"\n{result.windows} windows of {result.takes} takes: {result.data}; protocol {result.protocol}")


def commit() -> str:
    """Commit of the checkout that this package is run from, or its version."""
    root = Path(__file__).parents[3]
    if (root / ".git").exists():
        done = subprocess.run(["git", "-C", str(root), "rev-parse", "HEAD"], capture_output=True, text=True)
        if done.returncode == 0:
            return done.stdout.strip()
    from motioncast import __version__

    return __version__
