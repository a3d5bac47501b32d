"""The ladder of SoMoFormer's Table 3 on open data: what embeddings, augmentation and the grid are worth.

    python benchmarks/ladder.py --data DIR [--out FOLDER] [--seeds 2]

Trains the rungs one after the other, each for the same steps from the same seed; a run that was killed goes on. Prints
parameters, minutes, the validation score that chose each run's weights, and the ratio to standing still on the test
takes of the couple and of composed scenes, which chooses nothing. Set OMP_NUM_THREADS=1 for one core.

A quarter of the paper's width and half of its layers, with its 32 channels a head and its learning rate; no dropout,
since the paper names none. Its baseline divides recordings into fixed windows; here it is 512 scenes that are drawn
once. The recipe's tracker's faults (people and joints that are not seen, noise) are on every rung: they are what the
mask is for.
"""

from __future__ import annotations

import argparse
import json
from dataclasses import replace
from pathlib import Path
from typing import Any

from motioncast.benchmarks.result import Result, load_result, save_result
from motioncast.benchmarks.run import evaluate
from motioncast.inference.registry import load
from motioncast.training.loop import train
from motioncast.training.recipe import Recipe, read_recipe
from motioncast.training.ship import ship

SIZES = {"width": 64, "layers": 3, "heads": 2, "feed_forward": 256, "dropout": 0.0}
BUDGET = {"steps": 1200, "batch": 32, "learning_rate": 1e-3, "warmup": 100, "validate_every": 150}
PLAIN = {"scenes": 512, "yaw": False, "reverse": 0.0, "mirror": 0.0, "speed": (1.0, 1.0), "scale": (1.0, 1.0)}

RUNGS: dict[str, tuple[dict[str, Any], dict[str, Any]]] = {
    "baseline": (PLAIN, {"embeddings": False, "grid_width": 0}),
    "+ learned embeddings": (PLAIN, {"permuted": False, "grid_width": 0}),
    "+ augmentation": ({}, {"grid_width": 0}),
    "+ grid": ({}, {}),
    "all as released": ({}, {"preset": "release", "cells": 3}),
}
"""For each rung what differs from the recipe, and from the sizes."""

BENCHMARKS = ("cmu-duet", "cmu-crowd")


def rung(number: int, seed: int) -> Recipe:
    """The recipe of a rung, counted from 0."""
    recipe = read_recipe("somoformer")
    changes, sizes = list(RUNGS.values())[number]
    entries = {**BUDGET, **changes, "sizes": {**recipe.sizes, **SIZES, **sizes}, "seed": seed}
    return replace(recipe, name=f"ladder-{number}", **entries)


def measured(run: Path, data: Path) -> dict[str, Result]:
    """The test results of a run; each is measured once."""
    results = {}
    for benchmark in BENCHMARKS:
        found = list(run.glob(f"{benchmark}.*.json"))
        if not found:
            name = ship(run).name
            found = [save_result(evaluate(load(run / f"{name}.onnx"), benchmark, data), run)]
        results[benchmark] = load_result(found[0])
    return results


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--data", type=Path, required=True, help="folder with the open motion data")
    parser.add_argument("--out", type=Path, default=Path("runs/ladder"), help="where the runs go")
    parser.add_argument("--seeds", type=int, default=1, help="train every rung by so many seeds")
    asked = parser.parse_args()
    runs = {
        (number, seed): asked.out / f"{number}-{seed}" for seed in range(asked.seeds) for number in range(len(RUNGS))
    }
    for (number, seed), run in runs.items():
        train(rung(number, seed), asked.data, run)
    print("| rung | seed | parameters | minutes | validation couple | crowd | test couple | crowd |")
    print("|---|---|---:|---:|---:|---:|---:|---:|")
    for (number, seed), run in sorted(runs.items()):
        results = measured(run, asked.data)
        lines = (run / "metrics.jsonl").read_text(encoding="utf-8").splitlines()
        best = min(map(json.loads, lines), key=lambda entry: entry["score"])
        minutes = json.loads(lines[-1])["seconds"] / 60
        scores = [*best["validation"].values(), *(result.ratio.value for result in results.values())]
        cells = " | ".join(f"{score:.3f}" for score in scores)
        parameters = results[BENCHMARKS[0]].parameters
        print(f"| {list(RUNGS)[number]} | {seed} | {parameters:,} | {minutes:.0f} | {cells} |")


if __name__ == "__main__":
    main()
