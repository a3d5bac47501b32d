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
from motioncast.datasets.windows import COMPOSED, Windows
from motioncast.errors import InputError
from motioncast.inference.registry import load
from motioncast.metrics.position import joint_errors

SIMPLE_GUESSES = ("zero-velocity", "constant-velocity", "neck-velocity", "root-velocity-damped")
RESAMPLES = 1000
FEWEST_TAKES = 10
"""With fewer takes no interval is stated."""


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
    name, told = forecaster.card.name, "" if split == "test" else f" --split {split}"
    return Result(
        name,
        benchmark,
        protocol.hash(windows),
        f"{protocol.windows} ({split})",
        len(windows),
        len(set(windows.takes)),
        f"motioncast evaluate {name} {benchmark} --data DIR{' --alone' * alone}{told}",
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
    """The figures of forecasts: each moment, then the mean of the summary's moments over that of standing still."""
    truth, observed = windows.future
    still = np.broadcast_to(windows.past[0][:, -1:], truth.shape)
    names = sorted(set(windows.takes))
    takes = np.array([names.index(take) for take in windows.takes])
    # errors are sums over counts, so a take is two numbers a moment and resampling takes is cheap
    totals = [_by_take(protocol, guess, truth, observed, takes, len(names)) for guess in (forecasts, still)]

    def figures(times_drawn: np.ndarray) -> np.ndarray:
        model, zero = ((times_drawn @ total) / (times_drawn @ count) for total, count in totals)
        summary = [protocol.moments.index(moment) for moment in protocol.summary]
        return np.append(model, model[summary].mean() / zero[summary].mean())

    values = figures(np.ones(len(names)))
    low: list[float | None] = [None] * len(values)
    high: list[float | None] = [None] * len(values)
    composed = any(COMPOSED in name for name in names)  # such scenes share takes and are not independent
    if len(names) >= FEWEST_TAKES and not composed:
        random = np.random.default_rng(0)
        draws = random.multinomial(len(names), np.full(len(names), 1 / len(names)), RESAMPLES)
        spread = np.array([figures(drawn) for drawn in draws])
        low, high = (np.percentile(spread, percent, axis=0).tolist() for percent in (2.5, 97.5))
    unit = "mm" if protocol.metric == "mpjpe" else "cm"
    rows = [
        Row(f"{protocol.metric}_at", moment / protocol.fps, float(values[i]), unit, len(windows), low[i], high[i])
        for i, moment in enumerate(protocol.moments)
    ]
    last = protocol.summary[-1] / protocol.fps
    return [*rows, Row("ratio_to_zero_velocity", last, float(values[-1]), "1", len(windows), low[-1], high[-1])]


def _by_take(
    protocol: Protocol, forecast: np.ndarray, truth: np.ndarray, observed: np.ndarray, takes: np.ndarray, count: int
) -> tuple[np.ndarray, np.ndarray]:
    """Sum of errors and number of them, each ``(takes, moments)``, in the unit that is printed."""
    frames = [moment - 1 for moment in protocol.moments]
    forecast, truth, observed = forecast[:, frames], truth[:, frames], observed[:, frames]
    if protocol.metric == "vim":  # a person counts where all joints are seen
        seen = observed.all(-1)
        errors = np.sqrt(np.square(joint_errors(forecast, truth)).sum(-1)) * 100
        sums, counts = (errors * seen).sum(2), seen.sum(2)
    else:
        sums, counts = (joint_errors(forecast, truth) * observed).sum((2, 3)) * 1000, observed.sum((2, 3))
    member = np.eye(count)[takes]
    return member.T @ sums, member.T @ counts
