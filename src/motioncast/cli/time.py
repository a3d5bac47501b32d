"""``motioncast time``: how long a model takes."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from time import perf_counter

import numpy as np

from motioncast.cli.say import emit, table
from motioncast.core.forecaster import Forecaster
from motioncast.core.scene import Scene
from motioncast.core.skeletons import MRT15, SKELETONS

PEOPLE = (1, 2, 3, 4, 8, 16)
DEFAULT_PEOPLE = 3


@dataclass(frozen=True)
class Timing:
    """Quartiles of the time of one pass."""

    people: int
    q1_ms: float
    median_ms: float
    q3_ms: float


def time(
    model: str = "somoformer-fast",
    /,
    *,
    people: int | None = None,
    threads: int = 1,
    rounds: int = 100,
    json: bool = False,
) -> None:
    """Measure one pass of a model's graph, or of a simple guess, on this machine.

    Args:
        model: Name of a model, or an ONNX file.
        people: Number of people. Default: several, to show the growth; 3 with --json.
        threads: Threads of ONNX Runtime.
        rounds: Passes that are measured, after a tenth as many to warm up.
        json: Print one JSON object.
    """
    counts = (people,) if people else (DEFAULT_PEOPLE,) if json else PEOPLE
    timings = [measure(one_pass(model, count, threads), count, rounds) for count in counts]
    if json:
        (timing,) = timings
        emit(
            {
                "schema": "motioncast.time/1",
                "median_ms": timing.median_ms,
                "q1_ms": timing.q1_ms,
                "q3_ms": timing.q3_ms,
                "threads": threads,
                "people": timing.people,
                "objects": 0,
                "peak_memory_mb": peak_memory_mb(),
            }
        )
        return
    rows = [
        (timing.people, f"{timing.median_ms:.2f}", f"{timing.q1_ms:.2f}", f"{timing.q3_ms:.2f}") for timing in timings
    ]
    table(("people", "median ms", "1st quartile", "3rd quartile"), rows)
    memory = peak_memory_mb()
    print(f"\n{model}, {threads} thread(s), {rounds} passes each" + (f"; at most {memory:.0f} MB" if memory else ""))


def one_pass(model: str, people: int, threads: int) -> Callable[[], object]:
    """What is measured: the graph alone where there is one, else the whole answer."""
    from motioncast.inference.registry import load
    from motioncast.inference.session import GraphForecaster

    forecaster: Forecaster = load(model)
    card = forecaster.card
    skeleton = SKELETONS.get(card.skeleton, MRT15)
    shape = (card.history, people, len(skeleton), 3)
    positions = np.random.default_rng(0).normal(0, 0.5, shape).astype(np.float32)
    if isinstance(forecaster, GraphForecaster):
        graph = forecaster.with_threads(threads)
        history, observed = positions[None], np.ones((1, *shape[:-1]), bool)
        return lambda: graph.run(history, observed)
    scene = Scene(positions, skeleton, card.fps)
    return lambda: forecaster.forecast(scene)


def measure(run: Callable[[], object], people: int, rounds: int) -> Timing:
    """Quartiles of the time of a call, in milliseconds."""
    for _ in range(max(1, rounds // 10)):
        run()
    times = []
    for _ in range(rounds):
        begin = perf_counter()
        run()
        times.append((perf_counter() - begin) * 1000)
    q1, median, q3 = np.percentile(times, (25, 50, 75))
    return Timing(people, float(q1), float(median), float(q3))


def peak_memory_mb() -> float | None:
    """Most memory that this process has held; None on Windows, which does not tell it simply."""
    try:
        import resource
    except ImportError:
        return None
    import sys

    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return peak / (1e6 if sys.platform == "darwin" else 1e3)  # bytes there, kilobytes elsewhere
