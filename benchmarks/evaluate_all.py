"""Measure every model and every simple guess by the benchmarks of its setting; results as JSON files.

    python benchmarks/evaluate_all.py --data DIR && python benchmarks/readme_figures.py

Each file is what ``motioncast evaluate MODEL BENCHMARK --data DIR --json`` prints.
"""

from __future__ import annotations

import argparse
import json
from dataclasses import asdict, replace
from pathlib import Path

from motioncast.benchmarks.protocols import BENCHMARKS
from motioncast.benchmarks.run import SIMPLE_GUESSES, Result, evaluate
from motioncast.cli.evaluate import commit
from motioncast.inference.registry import list_models, load
from motioncast.inference.session import GraphForecaster

RESULTS = Path(__file__).parent / "results"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--data", type=Path, required=True, help="folder with the open motion data")
    data = parser.parse_args().data
    RESULTS.mkdir(exist_ok=True)
    for benchmark, (protocol, _) in BENCHMARKS.items():
        if benchmark == "somof":  # its data is not open
            continue
        for card in list_models():
            fits = (card.skeleton, card.history, card.horizon) == (
                protocol.skeleton, protocol.history, protocol.horizon,
            )  # fmt: skip
            if card.name not in SIMPLE_GUESSES and not fits:
                continue
            model = load(card.name)
            save(evaluate(model, benchmark, data), "")
            if isinstance(model, GraphForecaster) and benchmark in ("cmu-duet", "cmu-crowd"):
                graph = replace(model, rigid=False, card=replace(card, name=f"{card.name} (limbs may stretch)"))
                save(evaluate(graph, benchmark, data), ".stretching")
                if benchmark == "cmu-duet":
                    alone = replace(model, card=replace(card, name=f"{card.name} (partner hidden)"))
                    save(evaluate(alone, benchmark, data, alone=True), ".alone")


def save(result: Result, suffix: str) -> None:
    """Write one result and say its last row."""
    name = result.model.partition(" ")[0]
    entry = {key: value for key, value in asdict(result).items() if key not in ("windows", "takes")}
    path = RESULTS / f"{result.benchmark}.{name}{suffix}.json"
    path.write_text(json.dumps({**entry, "commit": commit()}, indent=1) + "\n", encoding="utf-8")
    values = " ".join(f"{row.value:.3f}" if row.unit == "1" else f"{row.value:.1f}" for row in result.rows)
    print(f"{result.benchmark:16} {result.model:45} {values}", flush=True)


if __name__ == "__main__":
    main()
