"""How long ten characteristic poses of one person take, with and without refinement.

    python benchmarks/goals_speed.py --model FILE.onnx [--threads 2] [--rounds 20]

Whole calls of ``forecast``, from the scene to the answer; medians and quartiles.
"""

from __future__ import annotations

import argparse
from dataclasses import replace
from time import perf_counter

import numpy as np

from motioncast.inference.registry import load
from motioncast.testing import walkers


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument("--rounds", type=int, default=20)
    parser.add_argument("--model", required=True, help="name of a model of goals, or an ONNX file")
    asked = parser.parse_args()
    scene = walkers(people=1, frames=30, fps=30)
    model = load(asked.model).with_threads(asked.threads)
    print(f"{model.card.name}: 10 goals of one person, {asked.threads} threads, {asked.rounds} rounds\n")
    for refine in (False, True):
        forecaster = replace(model, refine=refine)
        times = []
        for _ in range(asked.rounds + 2):
            began = perf_counter()
            forecaster.forecast(scene)
            times.append(1000 * (perf_counter() - began))
        low, middle, high = np.percentile(times[2:], (25, 50, 75))
        print(f"{'refined' if refine else 'as sampled':<12} {middle:6.0f} ms   (quartiles {low:.0f} to {high:.0f})")


if __name__ == "__main__":
    main()
