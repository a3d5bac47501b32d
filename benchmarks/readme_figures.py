"""Write the measured figures into README.md and docs/benchmarks.md, between their marks.

python benchmarks/evaluate_all.py --data DIR
python benchmarks/readme_figures.py
"""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

ROOT = Path(__file__).parents[1]
RESULTS = ROOT / "benchmarks" / "results"
MARKS = re.compile(r"(<!-- figures: begin [^\n]*-->\n).*?(<!-- figures: end -->)", re.DOTALL)


def results() -> dict[str, list[dict[str, Any]]]:
    """All results by benchmark, which must agree in their protocol; the best one comes first."""
    found: dict[str, list[dict[str, Any]]] = {}
    for path in sorted(RESULTS.glob("*.json")):
        result = json.loads(path.read_text(encoding="utf-8"))
        if result.get("schema") == "motioncast.result/1":
            found.setdefault(result["benchmark"], []).append(result)
    for benchmark, entries in found.items():
        if len({entry["protocol"] for entry in entries}) > 1:
            raise SystemExit(f"results of {benchmark} follow different protocols; evaluate them again")
        entries.sort(key=lambda entry: entry["rows"][-1]["value"])
    return found


def table(benchmark: str, entries: list[dict[str, Any]]) -> str:
    """One benchmark as a Markdown table: a row a model, a column a moment, the ratio last."""
    moments = [row for row in entries[0]["rows"] if row["unit"] != "1"]
    heads = [f"{row['horizon_s']:.2f} s" for row in moments]
    lines = [
        f"`{benchmark}`: error in {moments[0]['unit']} after so long. {moments[0]['n']} windows: {entries[0]['data']}.",
        "",
        f"| model | {' | '.join(heads)} | over standing still |",
        "|---|" + "---:|" * (len(heads) + 1),
    ]
    for entry in entries:
        cells = [f"{row['value']:.3f}" if row["unit"] == "1" else f"{row['value']:.0f}" for row in entry["rows"]]
        lines.append(f"| `{entry['model']}` | {' | '.join(cells)} |")
    return "\n".join([*lines, ""])


IN_README = ("cmu-duet", "cmu-crowd")
"""Benchmarks that the README shows; docs/benchmarks.md shows all."""

FOOT = "All: `python benchmarks/evaluate_all.py --data DIR`; one: `motioncast evaluate MODEL BENCHMARK --data DIR`.\n"


def main() -> None:
    found = results()
    for path, shown in ((ROOT / "README.md", IN_README), (ROOT / "docs" / "benchmarks.md", tuple(found))):
        text = "\n".join([*(table(benchmark, found[benchmark]) for benchmark in shown), FOOT])
        page = path.read_text(encoding="utf-8")
        path.write_text(MARKS.sub(lambda marks, text=text: f"{marks[1]}{text}{marks[2]}", page), encoding="utf-8")
        print(f"written: {path.relative_to(ROOT)}")


if __name__ == "__main__":
    main()
