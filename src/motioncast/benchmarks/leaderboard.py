"""The leaderboard of a benchmark, made from result files."""

from __future__ import annotations

import csv
import io
import json
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from motioncast.benchmarks.result import Result, comparable, load_result, shipped_results
from motioncast.errors import InputError, MissingExtra
from motioncast.formats.files import atomic_write

SPEED = "speed.json"
"""File of the results' folder with the time of a pass of every model, measured side by side."""


@dataclass(frozen=True, slots=True)
class Place:
    """A line of a board.

    Attributes:
        model: Name of the model.
        best: Its result; of several seeds the first.
        seeds: Ratio to standing still of each seed.
        median_ms: One pass, three people; None where it was not measured.
    """

    model: str
    best: Result
    seeds: tuple[float, ...]
    median_ms: float | None

    @property
    def variant(self) -> bool:
        """Whether this is a model under another condition, such as one that sees nobody else."""
        return "(" in self.model

    @property
    def value(self) -> float:
        """The ratio to standing still, the mean of the seeds."""
        return sum(self.seeds) / len(self.seeds)


@dataclass(frozen=True, slots=True)
class Leaderboard:
    """A benchmark's models, the most accurate first.

    Attributes:
        benchmark: Name of the benchmark.
        places: The lines.
        runtime: What the times were measured with, in words.
    """

    benchmark: str
    places: tuple[Place, ...]
    runtime: str

    @property
    def setting(self) -> dict[str, Any]:
        """The protocol in full."""
        return dict(self.places[0].best.setting)


def leaderboard(benchmark: str, folders: Sequence[Path] = ()) -> Leaderboard:
    """The board of a benchmark.

    Args:
        benchmark: Name of the benchmark.
        folders: Folders of results beside those that come with the package; a result of a model that is in several
            counts from the last of them.

    Raises:
        InputError: If there is no result, or the results do not compare.
    """
    files: dict[str, Path] = {}
    speed: dict[str, Any] = {}
    for folder in (shipped_results(), *folders):
        files |= {path.name: path for path in sorted(folder.glob(f"{benchmark}.*.json"))}
        if (folder / SPEED).is_file():
            speed = json.loads((folder / SPEED).read_text(encoding="utf-8"))
    if not files:
        raise InputError(
            f"there is no result of {benchmark} yet; motioncast evaluate MODEL {benchmark} --data DIR --out FOLDER "
            "writes one, then name the folder by --results"
        )
    models: dict[str, list[Result]] = {}
    for result in comparable([load_result(path) for path in files.values()]):
        models.setdefault(result.model, []).append(result)
    places = []
    for model, results in models.items():
        results.sort(key=lambda result: result.training.get("seed", 0))
        ratios = tuple(result.ratio.value for result in results)
        places.append(Place(model, results[0], ratios, speed.get("median_ms", {}).get(model)))
    places.sort(key=lambda place: place.value)
    return Leaderboard(benchmark, tuple(places), speed.get("runtime", ""))


def heads(board: Leaderboard) -> tuple[str, ...]:
    """Heads of the table's columns."""
    rows = _moments(board.places[0].best)
    moments = (f"{row.horizon_s * 1000:.0f} ms" for row in rows)
    return ("model", *moments, "over standing still", "95 %", "seeds", "parameters", "ms a pass", "scenes", "minutes")


def cells(place: Place) -> tuple[str, ...]:
    """One line of the table."""
    ratio, training = place.best.ratio, place.best.training
    interval = "-" if ratio.low is None else f"{ratio.low:.3f} to {ratio.high:.3f}"
    several = len(place.seeds) > 1
    return (
        place.model,
        *(f"{row.value:.1f}" if row.unit == "cm" else f"{row.value:.0f}" for row in _moments(place.best)),
        f"{place.value:.3f}",
        interval,
        f"{min(place.seeds):.3f} to {max(place.seeds):.3f} ({len(place.seeds)})" if several else "1",
        f"{place.best.parameters:,}" if place.best.parameters else "-",
        "-" if place.median_ms is None else f"{place.median_ms:.1f}",
        f"{training['scenes']:,}" if "scenes" in training else "-",
        f"{training['minutes']:.0f}" if "minutes" in training else "-",
    )


def _moments(result: Result) -> list:
    return [row for row in result.rows if row.metric.endswith("_at") and row.metric.startswith(("mpjpe", "vim"))]


def to_csv(board: Leaderboard) -> str:
    """Every row of every result, a line each."""
    out = io.StringIO()
    table = csv.writer(out, lineterminator="\n")
    columns = (
        "model",
        "seed",
        "metric",
        "horizon_s",
        "value",
        "unit",
        "low",
        "high",
        "n",
        "protocol",
        "data",
        "commit",
    )
    table.writerow(columns)
    for place in board.places:
        result = place.best
        for row in result.rows:
            table.writerow([
                place.model, result.training.get("seed", ""), row.metric, round(row.horizon_s, 4), row.value, row.unit,
                row.low, row.high, row.n, result.protocol, result.data, result.commit,
            ])  # fmt: skip
    return out.getvalue()


def to_latex(board: Leaderboard) -> str:
    """A table for a paper (booktabs); the best value of each column is bold."""
    moments = _moments(board.places[0].best)
    columns = [[row.value for row in _moments(place.best)] + [place.value] for place in board.places]
    best = [min(values) for values in zip(*columns, strict=True)]
    formats = ["{:.1f}" if row.unit == "cm" else "{:.0f}" for row in moments] + ["{:.3f}"]
    lines = [
        f"% {board.benchmark}, protocol {board.places[0].best.protocol}; motioncast leaderboard {board.benchmark}",
        rf"\begin{{tabular}}{{l{'r' * len(best)}}}",
        r"\toprule",
        " & ".join(["model", *(rf"{row.horizon_s * 1000:.0f}\,ms" for row in moments), "ratio"]) + r" \\",
        r"\midrule",
    ]
    for place, values in zip(board.places, columns, strict=True):
        printed = [form.format(value) for form, value in zip(formats, values, strict=True)]
        bold = [rf"\textbf{{{text}}}" if value == least else text
                for text, value, least in zip(printed, values, best, strict=True)]  # fmt: skip
        lines.append(" & ".join([place.model.replace("_", r"\_"), *bold]) + r" \\")
    return "\n".join([*lines, r"\bottomrule", r"\end{tabular}", ""])


def to_markdown(board: Leaderboard) -> str:
    """The table as Markdown."""
    names = heads(board)
    lines = [f"| {' | '.join(names)} |", "|---|" + "---:|" * (len(names) - 1)]
    for place in board.places:
        name, *others = cells(place)
        lines.append(f"| `{name}` | {' | '.join(others)} |")
    return "\n".join([*lines, ""])


def picture(board: Leaderboard, path: Path) -> None:
    """Error over horizon, one line a model; the suffix of the path tells the format.

    Raises:
        MissingExtra: If matplotlib is not installed.
    """
    try:
        import matplotlib
        from matplotlib.figure import Figure
    except ModuleNotFoundError:
        raise MissingExtra("the picture of a leaderboard", "plot") from None
    figure = Figure(figsize=(8, 4.5), layout="constrained")
    axes = figure.subplots()
    colours = matplotlib.colormaps["tab20"]
    shown = [place for place in board.places if not place.variant]
    top = 1.15 * max(row.value for place in shown for row in _moments(place.best) if place.value <= 1.0)
    for number, place in enumerate(shown):
        rows = _moments(place.best)
        rule = not place.best.parameters
        axes.plot(
            [row.horizon_s for row in rows], [row.value for row in rows], marker="o", markersize=3,
            linestyle="--" if rule else "-", color="0.6" if rule else colours(number % 20), label=place.model,
        )  # fmt: skip
    unit = _moments(board.places[0].best)[0].unit
    axes.set(xlabel="seconds ahead", ylabel=f"error ({unit})", ylim=(0, top), title=board.benchmark)
    axes.spines[["top", "right"]].set_visible(False)
    figure.legend(loc="outside right upper", frameon=False, fontsize=8)
    with atomic_write(path) as temporary, matplotlib.rc_context({"svg.hashsalt": "motioncast"}):
        figure.savefig(temporary, dpi=150, metadata={"Date": None} if path.suffix == ".svg" else None)
