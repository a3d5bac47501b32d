"""A model measured in furnished rooms."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import asdict, replace
from pathlib import Path

import numpy as np

from motioncast.benchmarks.protocol import as_asked
from motioncast.benchmarks.result import Result, Row, commit
from motioncast.benchmarks.rooms.scoring import HIPS, Samples, figures_of, over_standing_still
from motioncast.benchmarks.rooms.tally import rows
from motioncast.benchmarks.rooms.windows import PROTOCOL, RoomWindow, checksum, protocol_hash, windows_of_room
from motioncast.core.card import ModelCard
from motioncast.core.forecaster import Forecaster
from motioncast.datasets.rooms import rooms
from motioncast.metrics.ndms import Dictionary, dictionary
from motioncast.metrics.words import motion_words

HORIZON_S = PROTOCOL.horizon / PROTOCOL.fps

ROOMS = 40
"""Rooms that are measured, and as many of training that give real words."""

SEED = 2026
"""Of the first room of each split."""

MADE = "_with_synthetic"
"""After the name of a figure in which people count whom inverse kinematics moves."""

WORDS = 50_000
"""Words of training rooms that a forecast is compared with."""


def room_windows(data: Path, split: str, count: int = ROOMS) -> list[RoomWindow]:
    """The windows of the first rooms of a split.

    Raises:
        InputError: If the folder holds no takes.
    """
    return [window for room in rooms(data, split, count, SEED) for window in windows_of_room(room)]


def real_words(windows: Sequence[RoomWindow]) -> Dictionary:
    """What real people do, from the windows of training rooms; where there are too many words, every n-th."""
    found = [
        motion_words(window.future[:, person], HIPS)
        for window in windows
        for person in np.flatnonzero(window.seen.all(0))
    ]
    words = np.concatenate(found)
    return dictionary(words[:: -(-len(words) // WORDS)].astype(np.float32))


def forecast_rooms(
    model: Forecaster,
    windows: Sequence[RoomWindow],
    alone: bool = False,
    progress: Callable[[float], None] | None = None,
) -> list[np.ndarray]:
    """The futures of each window, ``(samples, time, people, joints, 3)``; only the past is handed over.

    Args:
        model: The model.
        windows: The windows.
        alone: Forecast each person with the others hidden.
        progress: Receives the share that is done.
    """
    answers = []
    for number, window in enumerate(windows):
        scene = window.scene
        groups = [(person,) for person in scene.people] if alone else [scene.people]
        futures = [
            model.forecast(
                scene.select(group), horizon_s=HORIZON_S, samples=PROTOCOL.samples, seed=PROTOCOL.seed + number
            ).samples
            for group in groups
        ]
        answers.append(as_asked(np.concatenate(futures, 2), PROTOCOL.horizon, len(scene.people)))
        if progress is not None:
            progress((number + 1) / len(windows))
    return answers


def evaluate_rooms(
    model: Forecaster,
    data: Path,
    split: str,
    alone: bool = False,
    progress: Callable[[float], None] | None = None,
) -> Result:
    """Measure a model by the rooms benchmark; arguments as of :func:`motioncast.benchmarks.run.evaluate`."""
    windows = room_windows(data, split)
    real = real_words([window.recorded() for window in room_windows(data, "train")])
    samples = forecast_rooms(model, windows, alone, progress)
    return result_of(model.card, windows, samples, real, split, alone)


def result_of(
    card: ModelCard,
    windows: Sequence[RoomWindow],
    samples: Samples,
    real: Dictionary | None,
    split: str = "test",
    alone: bool = False,
) -> Result:
    """The result of a model whose futures are known: every figure, and last the ratio to standing still."""
    told = f"{' --alone' * alone}{'' if split == 'test' else f' --split {split}'}"
    return Result(
        model=f"{card.name} (others hidden)" if alone else card.name,
        benchmark=PROTOCOL.name,
        protocol=protocol_hash(windows),
        data=checksum(windows),
        setting={**asdict(PROTOCOL), "moments_ms": PROTOCOL.moments_ms, "split": split},
        windows=len(windows),
        takes=len({take for window in windows for take in window.takes}),
        independent=f"{len({window.room for window in windows})} rooms",
        weights=card.checksum,
        parameters=card.parameters,
        training=card.training,
        command=f"motioncast evaluate {card.name} {PROTOCOL.name} --data DIR{told}",
        commit=commit(),
        seed=PROTOCOL.seed,
        rows=tuple(score(windows, samples, real)),
    )


def score(windows: Sequence[RoomWindow], samples: Samples, real: Dictionary | None = None) -> list[Row]:
    """Every figure of those who were recorded throughout; with those whom inverse kinematics moves, marked; the ratio.

    Args:
        windows: What happened.
        samples: What was forecast.
        real: Words of real motion. Default: NDMS and UMWR are left out.
    """
    rooms, recorded = [window.room for window in windows], [window.recorded() for window in windows]
    all_people = rows(figures_of(windows, samples), rooms, PROTOCOL.fps)
    return [
        *rows(figures_of(recorded, samples, real), rooms, PROTOCOL.fps),
        *(replace(row, metric=f"{row.metric}{MADE}") for row in all_people),
        *rows([over_standing_still(recorded, samples)], rooms, PROTOCOL.fps),
    ]
