"""A model measured by a benchmark: every window forecast as a user would, scored against what happened."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from motioncast.benchmarks.protocols import Protocol, windows_of
from motioncast.core.forecaster import Forecaster
from motioncast.core.scene import Scene
from motioncast.core.skeletons import SKELETONS
from motioncast.datasets.windows import Windows
from motioncast.errors import InputError
from motioncast.inference.registry import load
from motioncast.metrics.position import mpjpe_at, vim_at

SIMPLE_GUESSES = ("zero-velocity", "constant-velocity", "neck-velocity", "root-velocity-damped")
RESAMPLES = 1000


@dataclass(frozen=True, slots=True)
class Row:
    """One figure: a metric at a moment, with the 95 % interval of a bootstrap over takes (none below ten takes)."""

    metric: str
    horizon_s: float
    value: float
    unit: str
    n: int
    low: float | None = None
    high: float | None = None


@dataclass(frozen=True, slots=True)
class Result:
    """What a model reaches on a benchmark (``motioncast.result/1``).

    Attributes:
        model: Name of the model.
        benchmark: Name of the benchmark.
        protocol: Hash of the protocol and its windows; results of different hashes are not comparable.
        data: What the windows are.
        windows: Number of windows.
        takes: Number of takes that they come from.
        command: What prints this result.
        seed: Seed of the samples.
        rows: The figures. ``ratio`` rows are over standing still.
        schema: Version of this layout.
    """

    model: str
    benchmark: str
    protocol: str
    data: str
    windows: int
    takes: int
    command: str
    seed: int
    rows: tuple[Row, ...]
    schema: str = "motioncast.result/1"


def evaluate(
    model: str | Forecaster,
    benchmark: str,
    data: str | Path,
    *,
    split: str = "test",
    alone: bool = False,
    progress: Callable[[float], None] | None = None,
) -> Result:
    """Measure a model by a benchmark.

    Args:
        model: Name or path of a model, or a forecaster.
        benchmark: Name of a benchmark (``protocols.BENCHMARKS``).
        data: Folder with the benchmark's data.
        split: ``test``, or ``validation`` while something is still being chosen.
        alone: Forecast each person with the others hidden: what do they tell the model?
        progress: Receives the share that is done.

    Raises:
        InputError: If the data is missing, or the model answers another horizon or skeleton.
    """
    forecaster = load(model) if isinstance(model, str) else model
    protocol, windows = windows_of(benchmark, Path(data), split)
    if forecaster.card.horizon < protocol.horizon and forecaster.card.parameters:
        raise InputError(
            f'model "{forecaster.card.name}" answers {forecaster.card.horizon} frames at {forecaster.card.fps:g} a '
            f"second; {benchmark} scores {protocol.horizon} at {protocol.fps:g}; choose a model of its setting"
        )
    forecasts = forecast_windows(forecaster, protocol, windows, alone, progress)
    name = forecaster.card.name
    return Result(
        name,
        benchmark,
        protocol.hash(windows),
        f"{protocol.windows} ({split})",
        len(windows),
        len(set(windows.takes)),
        f"motioncast evaluate {name} {benchmark} --data DIR{' --alone' * alone}",
        0,
        tuple(score(protocol, windows, forecasts)),
    )


def forecast_windows(
    forecaster: Forecaster,
    protocol: Protocol,
    windows: Windows,
    alone: bool = False,
    progress: Callable[[float], None] | None = None,
) -> np.ndarray:
    """The forecast of each window, ``(windows, time, people, joints, 3)``; only the past is handed over."""
    skeleton, horizon_s = SKELETONS[protocol.skeleton], protocol.horizon / protocol.fps
    positions, observed = windows.past
    answers = np.empty_like(windows.future[0])
    for index in range(len(windows)):
        scene = Scene(positions[index], skeleton, protocol.fps, observed[index])
        groups = [(person,) for person in scene.people] if alone else [scene.people]
        for group in groups:
            rows = [scene.people.index(person) for person in group]
            answers[index][:, rows] = forecaster.forecast(scene.select(group), horizon_s=horizon_s).best
        if progress is not None:
            progress((index + 1) / len(windows))
    return answers


def score(protocol: Protocol, windows: Windows, forecasts: np.ndarray) -> list[Row]:
    """The figures of forecasts, each moment and the summary ratio."""
    truth, observed = windows.future
    still = np.broadcast_to(windows.past[0][:, -1:], truth.shape)
    takes = np.array(windows.takes)
    names = sorted(set(windows.takes))

    def figures(chosen: np.ndarray) -> np.ndarray:
        """Error at each moment, then the ratio."""
        curves = [_curve(protocol, guess[chosen], truth[chosen], observed[chosen]) for guess in (forecasts, still)]
        summary = [np.mean([curve[moment - 1] for moment in protocol.summary]) for curve in curves]
        return np.array([*(curves[0][moment - 1] for moment in protocol.moments), summary[0] / summary[1]])

    values = figures(np.arange(len(windows)))
    low: list[float | None] = [None] * len(values)
    high: list[float | None] = [None] * len(values)
    if len(names) >= 10:
        members = [np.flatnonzero(takes == name) for name in names]
        random = np.random.default_rng(0)
        draws = np.array([
            figures(np.concatenate([members[pick] for pick in random.integers(len(names), size=len(names))]))
            for _ in range(RESAMPLES if len(windows) < 500 else RESAMPLES // 10)
        ])  # fmt: skip
        low, high = (list(np.percentile(draws, percent, axis=0)) for percent in (2.5, 97.5))
    unit = "mm" if protocol.metric == "mpjpe" else "cm"
    rows = [
        Row(f"{protocol.metric}_at", moment / protocol.fps, float(value), unit, len(windows), low[i], high[i])
        for i, (moment, value) in enumerate(zip(protocol.moments, values, strict=False))
    ]
    last = protocol.summary[-1] / protocol.fps
    return [*rows, Row("ratio_to_zero_velocity", last, float(values[-1]), "1", len(windows), low[-1], high[-1])]


def _curve(protocol: Protocol, forecast: np.ndarray, truth: np.ndarray, observed: np.ndarray) -> np.ndarray:
    if protocol.metric == "vim":
        return vim_at(forecast, truth) * 100
    return mpjpe_at(forecast, truth, observed) * 1000
