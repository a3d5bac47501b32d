"""Where the time of a ten-second forecast by SAST goes: medians of its parts, in milliseconds of one processor.

    OMP_NUM_THREADS=1 python benchmarks/sast_profile.py [--model sast] [--paper-size] [--rounds 5]

One future of made-up people among tables, as ``motioncast time`` asks for it, by one thread; the parts are timed within
whole forecasts. These people stand in one another and in tables: to keep them clear takes longer than in a room.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable
from contextlib import ExitStack
from statistics import median
from time import process_time
from typing import Any
from unittest.mock import patch

from motioncast.cli.time import one_round
from motioncast.inference import denoiser
from motioncast.inference.denoiser import DiffusionForecaster
from motioncast.inference.question import Question
from motioncast.inference.registry import at_paper_size, load

SIZES = ((3, 30), (16, 50))
"""People and objects."""

PARTS = (
    "codes of objects", "graph of the scene", "graph that denoises", "sampler", "seam", "kept clear of things",
    "to the model's joints and back", "the rest", "all",
)  # fmt: skip


class Clock:
    """Adds up the time of calls by part."""

    def __init__(self) -> None:
        self.spent = dict.fromkeys(PARTS, 0.0)

    def watched(self, part: str, function: Callable[..., Any]) -> Callable[..., Any]:
        """The same function, timed."""

        def run(*arguments: Any, **named: Any) -> Any:
            begin = process_time()
            answer = function(*arguments, **named)
            self.spent[part] += 1000 * (process_time() - begin)
            return answer

        return run


class WatchedGraph:
    """A graph that is timed."""

    def __init__(self, clock: Clock, part: str, session: Any) -> None:
        self.run = clock.watched(part, session.run)


def profile(model: DiffusionForecaster, people: int, objects: int) -> dict[str, float]:
    """Milliseconds of each part of one forecast."""
    clock = Clock()
    graphs = [WatchedGraph(clock, part, session) for part, session in zip(PARTS[1:3], model.sessions(), strict=True)]
    ask = one_round(model, people, objects, 10.0, threads=1)
    with ExitStack() as stack:
        stack.enter_context(patch.object(DiffusionForecaster, "sessions", lambda self: graphs))
        for part, name in (("codes of objects", "codes"), ("seam", "eased"), ("kept clear of things", "kept_clear")):
            stack.enter_context(patch.object(denoiser, name, clock.watched(part, getattr(denoiser, name))))
        stack.enter_context(patch.dict(denoiser.SAMPLERS, {
            name: clock.watched("sampler", sampler) for name, sampler in denoiser.SAMPLERS.items()
        }))  # fmt: skip
        for name in ("of", "forecast"):
            timed = clock.watched(PARTS[6], getattr(Question, name))
            stack.enter_context(patch.object(Question, name, timed))
        clock.watched("all", ask)()
    spent = clock.spent
    spent["sampler"] -= spent["graph that denoises"]  # it calls the graph
    spent["the rest"] = spent["all"] - sum(spent[part] for part in PARTS[:-2])
    return spent


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--model", default="sast")
    parser.add_argument("--paper-size", action="store_true")
    parser.add_argument("--rounds", type=int, default=5)
    asked = parser.parse_args()
    model = load(at_paper_size(asked.model) if asked.paper_size else asked.model)
    assert isinstance(model, DiffusionForecaster)
    columns = []
    for people, objects in SIZES:
        rounds = [profile(model, people, objects) for _ in range(asked.rounds + 1)][1:]
        columns.append({part: median(spent[part] for spent in rounds) for part in PARTS})
    heads = " | ".join(f"{people} people, {objects} objects" for people, objects in SIZES)
    print(f"| ms, {model.steps} passes | {heads} |\n|---|" + "---:|" * len(SIZES))
    for part in PARTS:
        print(f"| {part} | " + " | ".join(f"{column[part]:.1f}" for column in columns) + " |")


if __name__ == "__main__":
    main()
