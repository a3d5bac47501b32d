"""``motioncast time``: how long a model takes."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from time import perf_counter

import numpy as np

from motioncast.cli.sampling import AS_THE_CARD_SAYS, Sampling, load_sampling
from motioncast.cli.say import emit, table
from motioncast.core.forecaster import Forecaster
from motioncast.core.scene import Scene
from motioncast.core.scene_object import SceneObject
from motioncast.core.skeletons import MRT15, SKELETONS

PEOPLE = (1, 2, 3, 4, 8, 16)
DEFAULT_PEOPLE = 3

PASSES, FORECASTS = 100, 5
"""Rounds by default: of single passes, and of whole forecasts by a model that denoises."""

TABLE_M = np.array([1.2, 0.8, 0.7])


@dataclass(frozen=True)
class Timing:
    """Quartiles of the time of one round."""

    people: int
    q1_ms: float
    median_ms: float
    q3_ms: float


def time(
    model: str = "somoformer-fast",
    /,
    *,
    people: int | None = None,
    objects: int = 0,
    seconds: float | None = None,
    paper_size: bool = False,
    sampling: Sampling = AS_THE_CARD_SAYS,
    threads: int = 1,
    rounds: int | None = None,
    json: bool = False,
) -> None:
    """Measure one pass of a model's graph, or a whole forecast, on this machine.

    A whole forecast is measured of models that denoise, of simple guesses, and of all with --seconds.

    Args:
        model: Name of a model, or an ONNX file.
        people: Number of people. Default: several, to show the growth; 3 with --json.
        objects: Number of objects around them.
        seconds: Length of the forecast. Default: the model's horizon.
        paper_size: Measure the model at the size of its paper, with made-up weights.
        sampling: How a model that denoises draws its futures.
        threads: Threads of ONNX Runtime.
        rounds: Rounds that are measured, after a tenth as many to warm up. Default: 100; 5 of models that denoise.
        json: Print one JSON object.
    """
    from motioncast.inference.registry import at_paper_size

    forecaster = load_sampling(at_paper_size(model) if paper_size else model, sampling)
    rounds = rounds or (FORECASTS if forecaster.card.diffusion else PASSES)
    counts = (people,) if people else (DEFAULT_PEOPLE,) if json else PEOPLE
    timings = [measure(one_round(forecaster, count, objects, seconds, threads), count, rounds) for count in counts]
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
                "objects": objects,
                "peak_memory_mb": peak_memory_mb(),
            }
        )
        return
    rows = [
        (timing.people, f"{timing.median_ms:.2f}", f"{timing.q1_ms:.2f}", f"{timing.q3_ms:.2f}") for timing in timings
    ]
    table(("people", "median ms", "1st quartile", "3rd quartile"), rows)
    memory = peak_memory_mb()
    print(f"\n{model}, {threads} thread(s), {rounds} rounds each" + (f"; at most {memory:.0f} MB" if memory else ""))


def one_round(
    forecaster: Forecaster, people: int, objects: int, seconds: float | None, threads: int
) -> Callable[[], object]:
    """What is measured: the graph alone where one pass of it is the answer, else the whole forecast."""
    from motioncast.inference.session import GraphForecaster
    from motioncast.inference.shipped import ShippedForecaster

    if isinstance(forecaster, ShippedForecaster):
        forecaster = forecaster.with_threads(threads)
    card, random = forecaster.card, np.random.default_rng(0)
    skeleton = SKELETONS.get(card.skeleton, MRT15)
    shape = (card.history, people, len(skeleton), 3)
    positions = random.normal(0, 0.5, shape).astype(np.float32)
    if isinstance(forecaster, GraphForecaster) and seconds is None:
        graph, history, observed = forecaster, positions[None], np.ones((1, *shape[:-1]), bool)
        return lambda: graph.run(history, observed)
    places = np.append(random.uniform(-4, 4, (objects, 2)), np.full((objects, 1), 0.35), 1)
    tables = [SceneObject(f"table {number}", "table", "box", TABLE_M, place) for number, place in enumerate(places)]
    scene = Scene(positions, skeleton, card.fps, objects=tuple(tables))
    return lambda: forecaster.forecast(scene, horizon_s=seconds)


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
