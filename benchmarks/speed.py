"""How fast the models and the readers are: medians, interleaved in one process, one thread.

python benchmarks/speed.py                      # graphs; with the train extra also torch
python benchmarks/speed.py --data DIR           # readers too
python benchmarks/speed.py --board FOLDER …     # three people, also the graphs of folders: for the leaderboards
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Callable
from pathlib import Path
from time import perf_counter, process_time

import numpy as np

from motioncast.benchmarks.leaderboard import SPEED
from motioncast.benchmarks.result import shipped_results
from motioncast.core.scene import Scene
from motioncast.core.skeleton import Skeleton
from motioncast.core.skeletons import CMU31, MRT15
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
    for card in list_models("forecast"):
        if not card.parameters or card.diffusion:  # a diffusion is timed as a whole: motioncast time
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


def tracked(skeleton: Skeleton, people: int, fps: float) -> Scene:
    """Made-up walkers on a tracker's fuller skeleton: what it has beyond theirs hangs on its parent."""
    scene = walkers(people=people, frames=150, fps=fps)
    positions = np.zeros((scene.frames, people, len(skeleton), 3), np.float32)
    for joint, (landmark, parent) in enumerate(zip(skeleton.landmarks, skeleton.parents, strict=True)):
        known = scene.skeleton.find(landmark)
        hanging = positions[:, :, parent] + np.float32(0.05)
        positions[:, :, joint] = hanging if known is None else scene.positions[:, :, known]
    return Scene(positions, skeleton, fps)


def stream(skeleton: Skeleton, people: int = 16, fps: float = 30.0) -> tuple[float, float]:
    """Median milliseconds of a push of so many people: as the clock has it, and of the processor."""
    model = load("somoformer-fast")
    assert isinstance(model, GraphForecaster)
    scene = tracked(skeleton, people, fps)
    live, times = model.stream(fps, skeleton), []
    for pose in scene.positions:
        begin = perf_counter(), process_time()
        live.push(dict(zip(scene.people, pose, strict=True)))
        times.append((perf_counter() - begin[0], process_time() - begin[1]))
    clock, processor = np.median(times[60:], axis=0) * 1000
    return float(clock), float(processor)


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


def board(folders: list[Path], rounds: int) -> None:
    """Writes the file that the leaderboards take their times from."""
    import onnxruntime

    people, runs = 3, {}
    models = [load(card.name) for card in list_models("forecast") if card.parameters and not card.diffusion]
    models += [load(path) for folder in folders for path in sorted(folder.glob("*.onnx"))]
    for model in models:
        assert isinstance(model, GraphForecaster)
        shape = (1, model.card.history, people, len(model.card.joints))
        history = np.random.default_rng(0).normal(0, 0.5, (*shape, 3)).astype(np.float32)
        observed = np.ones(shape, bool)
        runs[model.card.name] = lambda f=model, h=history, o=observed: f.run(h, o)
    medians = {name: round(median, 2) for name, median in interleaved(runs, rounds).items()}
    runtime = f"three people, ONNX Runtime {onnxruntime.__version__}, one thread, all models interleaved in one process"
    path = shipped_results() / SPEED
    path.write_text(json.dumps({"runtime": runtime, "median_ms": medians}, indent=1) + "\n", encoding="utf-8")
    print(f"written: {path}")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--data", type=Path, help="folder with CMU's takes")
    parser.add_argument("--rounds", type=int, default=50)
    parser.add_argument("--board", type=Path, nargs="*", help="folders with graphs beside those that ship")
    options = parser.parse_args()
    if options.board is not None:
        board(options.board, options.rounds)
        return
    table = {people: interleaved(graphs(people), options.rounds) for people in PEOPLE}
    print("| ms a pass, one thread | " + " | ".join(f"{people} people" for people in PEOPLE) + " |")
    print("|---|" + "---|" * len(PEOPLE))
    for name in table[1]:
        print(f"| {name} | " + " | ".join(f"{table[people][name]:.1f}" for people in PEOPLE) + " |")
    print("\n| stream, 16 people at 30 a second | ms a push | of the processor |\n|---|---|---|")
    for skeleton in (MRT15, CMU31):
        clock, processor = stream(skeleton)
        print(f"| {len(skeleton)} joints | {clock:.1f} | {processor:.1f} |")
    if options.data:
        for name, rate in readers(options.data).items():
            print(f"{name}: {rate:,.0f} frames a second")


if __name__ == "__main__":
    main()
