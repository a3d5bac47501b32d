"""A model of steps measured in the kitchen."""

from __future__ import annotations

import hashlib
from dataclasses import asdict, dataclass

import numpy as np

from motioncast.benchmarks.kitchen.guesses import Answer
from motioncast.benchmarks.kitchen.scoring import Judge, figures, rows
from motioncast.benchmarks.result import Result, commit
from motioncast.core.card import ModelCard
from motioncast.datasets import kitchen
from motioncast.datasets.action_windows import ActionWindows, cut_steps
from motioncast.inference.actions import ActionForecaster

SEQUENCES = 300
"""Sequences that are measured."""

STRIDE = 4
"""Steps from one window to the next."""


@dataclass(frozen=True, slots=True)
class KitchenProtocol:
    """What is asked.

    Attributes:
        split: Split of the sequences.
        people: Cooks before the camera.
        moments: Which pose stands for a step.
        history: Past steps.
        steps: Future steps.
    """

    split: str = "test"
    people: int = 1
    moments: str = "characteristic"
    history: int = 10
    steps: int = 10

    @property
    def name(self) -> str:
        """Name of the benchmark."""
        return "kitchen" + "-pair" * (self.people == 2) + f"-{self.moments}" * (self.moments != "characteristic")


def windows_of(protocol: KitchenProtocol, count: int = SEQUENCES) -> ActionWindows:
    """The windows of a protocol."""
    history, steps = protocol.history, protocol.steps
    if protocol.moments == "uncoupled":
        return cut_steps(kitchen.uncoupled(protocol.split, count, history, steps, STRIDE), history, steps)
    found = kitchen.sequences(protocol.split, count, people=protocol.people, moments=protocol.moments)
    return cut_steps(found, history, steps, STRIDE)


def forecast_steps(model: ActionForecaster, windows: ActionWindows, steps: int) -> Answer:
    """The usual answer of a model, without noise; only the past is handed over."""
    past = windows.past(model.card.history)
    quiet = np.ones(len(windows), bool)
    _, scores, poses, pixels = model.roll(past, steps, quiet, np.random.default_rng(0))
    return Answer(scores, pixels, poses)


def result_of(
    name: str, card: ModelCard | None, protocol: KitchenProtocol, windows: ActionWindows, answer: Answer, judge: Judge
) -> Result:
    """The result of an answer; of a rule there is no card."""
    data = hashlib.sha256(windows.pixels.tobytes() + windows.actions.tobytes()).hexdigest()
    return Result(
        model=name,
        benchmark=protocol.name,
        protocol=hashlib.sha256(f"{protocol} {data}".encode()).hexdigest()[:16],
        data=data,
        setting=asdict(protocol),
        windows=len(windows),
        takes=len(set(windows.names)),
        independent=f"{len(set(windows.names))} sequences",
        weights=card.checksum if card else "",
        parameters=card.parameters if card else 0,
        training=card.training if card else {},
        command="python benchmarks/actions_table.py --runs FOLDER",
        commit=commit(),
        seed=0,
        rows=tuple(rows(windows, figures(windows, protocol.history, answer, judge))),
    )
