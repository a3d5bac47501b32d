"""``motioncast leaderboard``: the models of a benchmark, the most accurate first."""

from __future__ import annotations

from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING

from motioncast.cli import say
from motioncast.errors import InputError

if TYPE_CHECKING:  # loaded when the command is called
    from motioncast.benchmarks.leaderboard import Leaderboard


def leaderboard(
    benchmark: str,
    /,
    *,
    results: tuple[Path, ...] = (),
    csv: Path | None = None,
    latex: Path | None = None,
    picture: Path | None = None,
    check: str | None = None,
    data: Path | None = None,
    json: bool = False,
) -> None:
    """Show the models of a benchmark, the most accurate first, from their result files.

    Args:
        benchmark: Name of a benchmark.
        results: Folder of further results, as "evaluate --out" writes them; may be given several times.
        csv: Write every figure as a CSV table.
        latex: Write the table for a paper.
        picture: Write the errors over the horizon, a line each; the suffix tells the format.
        check: Measure this model again and compare with its line; needs --data.
        data: Folder that holds the data sets.
        json: Print the board as one JSON object.
    """
    from motioncast.benchmarks import leaderboard as boards
    from motioncast.formats.files import atomic_write

    board = boards.leaderboard(benchmark, results)
    if check is not None:
        _check(board, check, data)
        return
    for path, text in ((csv, boards.to_csv), (latex, boards.to_latex)):
        if path is not None:
            with atomic_write(path) as temporary:
                temporary.write_text(text(board), encoding="utf-8")
            say.note([f"written: {path}"])
    if picture is not None:
        boards.picture(board, picture)
        say.note([f"written: {picture}"])
    if json:
        places = [
            {"model": place.model, "ratio": place.value, "seeds": place.seeds, "median_ms": place.median_ms,
             "result": asdict(place.best)}
            for place in board.places
        ]  # fmt: skip
        say.emit({"schema": "motioncast.leaderboard/1", "benchmark": benchmark, "places": places})
        return
    setting = board.setting
    unit = "mm" if setting["metric"] == "mpjpe" else "cm"
    first = board.places[0].best
    print(f"{benchmark}: {setting['windows']} ({setting['split']}), error in {unit}\n")
    say.table(boards.heads(board), [boards.cells(place) for place in board.places])
    print(
        f"\n{first.windows} windows of {first.takes} takes; intervals over {first.independent}; "
        f"protocol {first.protocol}" + (f"; times: {board.runtime}" if board.runtime else "")
    )


def _check(board: Leaderboard, model: str, data: Path | None) -> None:
    """Measures a model again; its line stands if every figure does."""
    from motioncast.benchmarks.run import evaluate

    place = next((place for place in board.places if place.model == model), None)
    if place is None or data is None:
        names = ", ".join(place.model for place in board.places)
        raise InputError(f"--check {model} needs --data DIR and a model of the board ({names})")
    with say.progress(f"{model} on {board.benchmark}") as progress:
        again = evaluate(model, board.benchmark, data, progress=progress)
    if again.data != place.best.data:
        raise InputError(f"the windows built from {data} are not those of the board; check the copy of the data")
    rows = [
        (old.metric, f"{old.horizon_s:.2f} s", f"{old.value:.4g}", f"{new.value:.4g}")
        for old, new in zip(place.best.rows, again.rows, strict=True)
    ]
    say.table(("metric", "after", "board", "here"), rows)
    worst = max(abs(new.value / old.value - 1) for old, new in zip(place.best.rows, again.rows, strict=True))
    print(f"\nfigures agree within {worst:.2%}")
