"""How fast the models and the readers are: medians, interleaved in one process, one thread.

python benchmarks/speed.py                      # graphs; with the train extra also torch
python benchmarks/speed.py --data DIR           # readers too
"""

from __future__ import annotations

import argparse
from collections.abc import Callable
from pathlib import Path
from time import perf_counter

import numpy as np

from motioncast.inference.registry import list_models, load
from motioncast.inference.session import GraphForecaster
from motioncast.testing import walkers

PEOPLE = (1, 2, 3, 5, 8, 16)


def interleaved(runs: dict[str, Callable[[], object]], rounds: int) -> dict[str, float]:
    """Median milliseconds of each call; each round calls every one once, so that a slow moment hits all."""
    times: dict[str, list[float]] = {name: [] for name in runs}
    for turn in range(rounds + rounds // 10 + 1):
        for name, run in runs.items():
            begin = perf_counter()
            run()
            if turn > rounds // 10:
                times[name].append((perf_counter() - begin) * 1000)
    return {name: float(np.median(series)) for name, series in times.items()}


def graphs(people: int) -> dict[str, Callable[[], object]]:
    """A pass of each shipped model: its graph, and where torch is installed the same sizes in torch."""
    runs: dict[str, Callable[[], object]] = {}
    for card in list_models():
        if not card.parameters:
            continue
        forecaster = load(card.name)
        assert isinstance(forecaster, GraphForecaster)
        shape = (1, card.history, people, len(card.joints))
        history = np.random.default_rng(0).normal(0, 0.5, (*shape, 3)).astype(np.float32)
        observed = np.ones(shape, bool)
        runs[f"{card.name} onnx"] = lambda f=forecaster, h=history, o=observed: f.run(h, o)
        torch_run = in_torch(card.recipe, history, observed)
        if torch_run is not None:
            runs[f"{card.name} torch"] = torch_run
    return runs


def in_torch(recipe: str, history: np.ndarray, observed: np.ndarray) -> Callable[[], object] | None:
    """The same pass in torch; None where torch is not installed."""
    try:
        import torch
    except ModuleNotFoundError:
        return None
    from motioncast.models import build
    from motioncast.training.recipe import read_recipe

    torch.set_num_threads(1)
    plan = read_recipe(recipe)
    model = build(plan.model, plan.sizes).eval()
    inputs = torch.from_numpy(history), torch.from_numpy(observed)

    def run() -> object:
        with torch.inference_mode():
            return model(*inputs)

    return run


def stream(people: int = 16, fps: float = 30.0) -> float:
    """Median milliseconds of a push of so many people."""
    model = load("somoformer-fast")
    assert isinstance(model, GraphForecaster)
    live, scene = model.stream(fps), walkers(people=people, frames=150, fps=fps)
    times = []
    for frame in range(scene.frames):
        begin = perf_counter()
        live.push({person: scene.positions[frame, column] for column, person in enumerate(scene.people)})
        times.append((perf_counter() - begin) * 1000)
    return float(np.median(times[60:]))


def readers(data: Path) -> dict[str, float]:
    """Frames a second of the AMC reader, text only and with positions."""
    from motioncast.datasets import cmu
    from motioncast.formats.asf_amc import bone_ends, parse_amc

    take = next(take for take in cmu.takes(data) if take.name == "60_08")
    skeleton, values = cmu.acclaim(take)
    frames = len(values["root"])
    lines = []
    for frame in range(frames):
        lines.append(str(frame + 1))
        lines += [f"{name} " + " ".join(f"{x:.6g}" for x in table[frame]) for name, table in values.items()]
    text = "\n".join(lines) + "\n"

    def parse() -> None:
        parse_amc(text, skeleton, "60_08.amc")

    def positions() -> None:
        bone_ends(skeleton, parse_amc(text, skeleton, "60_08.amc"))

    medians = interleaved({"AMC text": parse, "AMC text to positions": positions}, 10)
    return {name: frames / median * 1000 for name, median in medians.items()}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--data", type=Path, help="folder with CMU's takes")
    parser.add_argument("--rounds", type=int, default=50)
    options = parser.parse_args()
    table = {people: interleaved(graphs(people), options.rounds) for people in PEOPLE}
    print("| ms a pass, one thread | " + " | ".join(f"{people} people" for people in PEOPLE) + " |")
    print("|---|" + "---|" * len(PEOPLE))
    for name in table[1]:
        print(f"| {name} | " + " | ".join(f"{table[people][name]:.1f}" for people in PEOPLE) + " |")
    print(f"\nstream, 16 people at 30 a second: {stream():.1f} ms a push")
    if options.data:
        for name, rate in readers(options.data).items():
            print(f"{name}: {rate:,.0f} frames a second")


if __name__ == "__main__":
    main()
