"""Error radii: how far from a forecast joint the truth lies, in half and in nine of ten cases.

Cross-conformal: the radii of a shipped model come from errors of models of the same recipe on takes that those
models were not trained on. Takes count equally, however long they are, since windows of one take are alike; and
the wanted share is raised by 1 / n for n takes, as conformal prediction does for its finite sample.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from motioncast.benchmarks.protocol import Protocol
from motioncast.benchmarks.protocols import windows_of
from motioncast.benchmarks.run import forecast_windows
from motioncast.core.forecaster import Forecaster
from motioncast.datasets.windows import Windows
from motioncast.errors import InputError
from motioncast.inference.registry import load_forecaster
from motioncast.metrics.position import joint_errors

LEVELS = ("0.5", "0.9")


def radii(errors: Sequence[np.ndarray]) -> dict[str, list[list[float]]]:
    """Radii from the errors of each take.

    Args:
        errors: For each take ``(cases, time, joints)`` metres, NaN where the truth was not seen.

    Returns:
        Level -> ``[time][joint]`` metres, never shrinking with time.

    Example:
        >>> take = np.linspace(0, 1, 11).reshape(11, 1, 1)
        >>> radii([take, take])["0.5"]
        [[0.8]]
    """
    weights = np.concatenate([np.full(len(take), 1 / len(take)) for take in errors])
    cases = np.concatenate(errors)
    order = np.argsort(cases, axis=0)  # NaN comes last
    ranked = np.take_along_axis(cases, order, 0)
    share = np.where(np.isnan(ranked), 0, weights[order]).cumsum(0)
    share /= share[-1]
    tables = {}
    for level in LEVELS:
        wanted = min(1.0, float(level) * (1 + 1 / len(errors)))
        first = (share >= wanted - 1e-9).argmax(0)
        quantile = np.take_along_axis(ranked, first[None], 0)[0]
        tables[level] = np.round(np.maximum.accumulate(quantile), 4).tolist()
    return tables


def errors_by_take(forecaster: Forecaster, protocol: Protocol, windows: Windows) -> dict[str, np.ndarray]:
    """Errors of each take, ``(windows * people, time, joints)`` metres, NaN where the truth was not seen."""
    truth, observed = windows.future
    errors = np.where(observed, joint_errors(forecast_windows(forecaster, protocol, windows), truth), np.nan)
    takes = np.array(windows.takes)
    return {
        take: np.moveaxis(errors[takes == take], 2, 1).reshape(-1, truth.shape[1], truth.shape[3])
        for take in dict.fromkeys(windows.takes)
    }


def held(errors: np.ndarray, table: Sequence[Sequence[float]]) -> np.ndarray:
    """Share of errors within the radius at each frame, ``(time,)``."""
    inside = errors <= np.asarray(table)
    seen = ~np.isnan(errors)
    return (inside & seen).sum((0, 2)) / seen.sum((0, 2))


def coverage(model: str, benchmark: str, data: Path) -> dict[str, dict[str, float]]:
    """How much of the truth a model's radii really hold, take by take.

    Args:
        model: Name or path of a model.
        benchmark: Name of a benchmark.
        data: Folder with the benchmark's data.

    Returns:
        Take -> level ("0.5", "0.9") -> share held, over people, joints and time.

    Raises:
        InputError: If the model states no radii, or its setting is not the benchmark's.
    """
    forecaster = load_forecaster(model)
    protocol, windows = windows_of(benchmark, data)
    levels = forecaster.card.radius.get("levels")
    if not levels:
        raise InputError(f'model "{model}" states no error radii; choose one that does (motioncast models)')
    if (forecaster.card.skeleton, forecaster.card.fps) != (protocol.skeleton, protocol.fps):
        raise InputError(f'model "{model}" is of another setting than {benchmark}; choose one of its setting')
    by_take = errors_by_take(forecaster, protocol, windows)
    return {
        take: {level: float(held(errors, table[: protocol.horizon]).mean()) for level, table in levels.items()}
        for take, errors in by_take.items()
    }
