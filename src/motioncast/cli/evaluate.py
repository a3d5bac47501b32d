"""``motioncast evaluate``: a model measured by a benchmark."""

from __future__ import annotations

from pathlib import Path
from typing import Literal

from motioncast.cli import say
from motioncast.errors import InputError


def evaluate(
    model: str,
    benchmark: str,
    /,
    *,
    data: Path,
    split: Literal["test", "validation"] = "test",
    alone: bool = False,
    workers: int = 1,
    ray: str | None = None,
    out: Path | None = None,
    json: bool = False,
) -> None:
    """Measure a model by a benchmark.

    Args:
        model: Name of a model, or an ONNX file.
        benchmark: Name of a benchmark.
        data: Folder that holds the data sets.
        split: The validation split serves while something is still being chosen.
        alone: Forecast each person with the others hidden: what do they tell the model?
        workers: Processes of this machine that share the windows.
        ray: Address of a Ray cluster that shares the windows, or "local".
        out: Folder to write the result to, for "leaderboard --results".
        json: Print the result as one JSON object.
    """
    from motioncast.benchmarks.result import save_result, to_json
    from motioncast.benchmarks.run import evaluate as measure
    from motioncast.benchmarks.spread import over_processes, over_ray, serially

    if workers < 1:
        raise InputError(f"--workers {workers} came; give 1 or more")
    spread = over_ray(ray) if ray else over_processes(workers) if workers > 1 else serially
    if out is not None:
        out.mkdir(parents=True, exist_ok=True)
    with say.progress(f"{model} on {benchmark}") as progress:
        result = measure(model, benchmark, data, split=split, alone=alone, spread=spread, progress=progress)
    if out is not None:
        say.note([f"written: {save_result(result, out)}"])
    if json:
        say.emit(to_json(result))
        return
    print(f"{result.model} on {result.benchmark}\n")
    say.table(
        ("metric", "after", "value", "95 %"),
        [
            (
                row.metric,
                f"{row.horizon_s:.2f} s",
                _printed(row.value, row.unit),
                "-" if row.low is None or row.high is None else f"{row.low:.4g} to {row.high:.4g}",
            )
            for row in result.rows
        ],
    )
    print(
        f"\n{result.windows} windows of {result.takes} takes: {result.setting['windows']} ({split}); "
        f"intervals over {result.independent}; protocol {result.protocol}"
    )


def _printed(value: float, unit: str) -> str:
    return f"{value:.1f} {unit}" if unit in ("mm", "cm") else f"{value:.3f} {unit}".removesuffix(" 1")
