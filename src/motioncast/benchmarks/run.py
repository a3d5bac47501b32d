"""A model measured by a benchmark: every window forecast as a user would, scored against what happened."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import asdict
from pathlib import Path

import numpy as np

from motioncast.benchmarks.hik import PROTOCOL as HIK
from motioncast.benchmarks.hik import evaluate_hik
from motioncast.benchmarks.protocol import Protocol, as_asked, checksum
from motioncast.benchmarks.protocols import windows_of
from motioncast.benchmarks.result import Result, commit
from motioncast.benchmarks.rooms.run import evaluate_rooms
from motioncast.benchmarks.rooms.windows import PROTOCOL as ROOMS
from motioncast.benchmarks.scoring import independent, score
from motioncast.benchmarks.spread import Spread, serially
from motioncast.core.card import ModelCard
from motioncast.core.forecaster import Forecaster
from motioncast.core.scene import Scene
from motioncast.core.skeletons import SKELETONS
from motioncast.datasets.windows import COMPOSED, Windows
from motioncast.errors import InputError
from motioncast.inference.registry import load_forecaster


def evaluate(
    model: str | Forecaster,
    benchmark: str,
    data: str | Path,
    *,
    split: str = "test",
    alone: bool = False,
    spread: Spread = serially,
    progress: Callable[[float], None] | None = None,
) -> Result:
    """Measure a model by a benchmark.

    Args:
        model: Name or path of a model, or a forecaster.
        benchmark: Name of a benchmark (``protocols.BENCHMARKS``).
        data: Folder with the benchmark's data.
        split: ``test``, or ``validation`` while something is still being chosen.
        alone: Forecast each person with the others hidden: what do they tell the model?
        spread: Where the windows are forecast (``benchmarks.spread``).
        progress: Receives the share that is done.

    Raises:
        InputError: If the data is missing, or the model is of another skeleton.
    """
    forecaster = load_forecaster(model) if isinstance(model, str) else model
    card = forecaster.card
    if benchmark in (ROOMS.name, HIK.name) and spread is not serially:
        raise InputError(f"{benchmark} is forecast one room after the other; leave --workers and --ray out")
    if benchmark == HIK.name:  # models of other joints may be asked: theirs are taken from the 29, the others carried
        if split != "test":
            raise InputError(f"{benchmark} is its owners' test list; choose on rooms")
        return evaluate_hik(forecaster, Path(data), alone, progress)
    if benchmark == ROOMS.name:
        _same_skeleton(card, ROOMS)
        return evaluate_rooms(forecaster, Path(data), split, alone, progress)
    protocol, windows = windows_of(benchmark, Path(data), split)
    _same_skeleton(card, protocol)
    forecasts = forecast_windows(model, protocol, windows, alone, spread, progress)
    told = f"{' --alone' * alone}{'' if split == 'test' else f' --split {split}'}"
    return Result(
        model=f"{card.name} (others hidden)" if alone else card.name,
        benchmark=benchmark,
        protocol=protocol.hash(windows),
        data=checksum(windows),
        setting={**asdict(protocol), "moments_ms": protocol.moments_ms, "split": split},
        windows=len(windows),
        takes=len({take for names in windows.takes for take in names.split(COMPOSED)}),
        independent=independent(protocol, windows),
        weights=card.checksum,
        parameters=card.parameters,
        training=card.training,
        command=f"motioncast evaluate {card.name} {benchmark} --data DIR{told}",
        commit=commit(),
        seed=protocol.seed,
        rows=tuple(score(protocol, windows, forecasts)),
    )


def _same_skeleton(card: ModelCard, protocol: Protocol) -> None:
    if card.skeleton not in ("any", protocol.skeleton):
        raise InputError(
            f'model "{card.name}" has the skeleton {card.skeleton}; {protocol.name} is scored on {protocol.skeleton}; '
            f"choose a model of its setting"
        )


def forecast_windows(
    model: str | Forecaster,
    protocol: Protocol,
    windows: Windows,
    alone: bool = False,
    spread: Spread = serially,
    progress: Callable[[float], None] | None = None,
) -> np.ndarray:
    """The forecast of each window, ``(windows, time, people, joints, 3)``; only the past is handed over."""
    skeleton, horizon_s = SKELETONS[protocol.skeleton], protocol.horizon / protocol.fps
    positions, observed = windows.past
    scenes = [Scene(positions[index], skeleton, protocol.fps, observed[index]) for index in range(len(windows))]
    answers = spread(model, scenes, horizon_s, alone, progress or (lambda share: None))
    return np.stack([as_asked(answer, protocol.horizon, positions.shape[2]) for answer in answers])
