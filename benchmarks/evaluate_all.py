"""Measure every model by every open benchmark of its setting; results as files of the package.

    python benchmarks/evaluate_all.py --data DIR [--models FOLDER …] && python benchmarks/pages.py

Each file is what ``motioncast evaluate MODEL BENCHMARK --data DIR --out FOLDER`` writes. Models that do not ship are
read from folders of runs.
"""

from __future__ import annotations

import argparse
from dataclasses import replace
from fnmatch import fnmatch
from pathlib import Path

from motioncast.benchmarks.protocol import Protocol
from motioncast.benchmarks.protocols import BENCHMARKS
from motioncast.benchmarks.result import save_result, shipped_results
from motioncast.benchmarks.run import evaluate
from motioncast.core.card import ModelCard
from motioncast.core.forecaster import Forecaster
from motioncast.inference.baselines import RULES
from motioncast.inference.registry import list_models, load
from motioncast.inference.session import GraphForecaster


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--data", type=Path, required=True, help="folder with the open motion data")
    parser.add_argument("--models", type=Path, nargs="*", default=[], help="folders with further graphs and cards")
    parser.add_argument("--only", default="*", help="pattern of model names")
    parser.add_argument("--benchmarks", default="*", help="pattern of benchmark names")
    asked = parser.parse_args()
    shipped = [load(card.name) for card in list_models("forecast")]
    models = shipped + [load(path) for folder in asked.models for path in sorted(folder.glob("*.onnx"))]
    for benchmark, (protocol, _) in BENCHMARKS.items():
        if benchmark == "somof" or not fnmatch(benchmark, asked.benchmarks):  # SoMoF's data is not open
            continue
        for model in models:
            if fnmatch(model.card.name, asked.only) and fits(model.card, protocol):
                save(model, benchmark, asked.data)
                if model in shipped and isinstance(model, GraphForecaster) and benchmark in ("cmu-duet", "cmu-crowd"):
                    variants(model, benchmark, asked.data)


def fits(card: ModelCard, protocol: Protocol) -> bool:
    """Whether a model is of the benchmark's setting; models of a second answer four by going on."""
    if card.name in RULES:
        return True
    same = (card.skeleton, card.fps, card.history) == (protocol.skeleton, protocol.fps, protocol.history)
    return same and (card.horizon == protocol.horizon or protocol.name == "cmu-solo-4s")


def variants(model: GraphForecaster, benchmark: str, data: Path) -> None:
    """What rigid limbs and the other people are worth to a model that ships."""
    free = replace(model.card, name=f"{model.card.name} (limbs may stretch)")
    save(replace(model, rigid=False, card=free), benchmark, data)
    save(model, benchmark, data, alone=True)


def save(model: Forecaster, benchmark: str, data: Path, *, alone: bool = False) -> None:
    result = evaluate(model, benchmark, data, alone=alone)
    save_result(result, shipped_results())
    values = " ".join(f"{row.value:.3f}" if row.unit == "1" else f"{row.value:.1f}" for row in result.rows[:5])
    print(f"{benchmark:18} {result.model:45} {values}  {result.ratio.value:.3f}", flush=True)


if __name__ == "__main__":
    main()
