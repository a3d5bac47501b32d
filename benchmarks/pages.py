"""Write the leaderboards into the documentation, from the result files of the package.

    python benchmarks/evaluate_all.py --data DIR
    python benchmarks/pages.py

A page and a picture a benchmark in docs/leaderboard, and the two main tables between the marks of README.md.
"""

from __future__ import annotations

import re
from pathlib import Path

from motioncast.benchmarks.leaderboard import Leaderboard, leaderboard, picture, to_markdown
from motioncast.benchmarks.protocols import BENCHMARKS
from motioncast.benchmarks.result import shipped_results

ROOT = Path(__file__).parents[1]
FOLDER = ROOT / "docs" / "leaderboard"
MARKS = re.compile(r"(<!-- figures: begin [^\n]*-->\n).*?(<!-- figures: end -->)", re.DOTALL)
IN_README = ("cmu-duet", "cmu-crowd")
ELSEWHERE = {
    "rooms": ("ten seconds among furniture", "rooms_table.py"),
    "cmu-goals": ("ten characteristic poses, without a time", "goals_table.py"),
    "kitchen": ("actions and poses of synthetic cooks, step by step", "actions_table.py"),
    "cmu-actions": ("actions and poses of labelled exercises, a demonstration", "cmu_actions_table.py"),
}
"""Boards that other programs write: what they are of, and which."""


def main() -> None:
    FOLDER.mkdir(exist_ok=True)
    names = [name for name in BENCHMARKS if any(shipped_results().glob(f"{name}.*.json"))]
    boards = [leaderboard(name) for name in names]
    for board in boards:
        (FOLDER / f"{board.benchmark}.md").write_text(page(board), encoding="utf-8")
        picture(board, FOLDER / f"{board.benchmark}.svg")
    (FOLDER / "index.md").write_text(index(boards), encoding="utf-8")
    readme = ROOT / "README.md"
    tables = "\n".join(short(board) for board in boards if board.benchmark in IN_README)
    text = readme.read_text(encoding="utf-8")
    readme.write_text(MARKS.sub(lambda marks: f"{marks[1]}{tables}\n{marks[2]}", text), encoding="utf-8")


def page(board: Leaderboard) -> str:
    """One board."""
    setting, first = board.setting, board.places[0].best
    unit = "mm" if setting["metric"] == "mpjpe" else "cm (norm of a person's whole pose error)"
    condition = "" if setting["condition"] == "clean" else f"Condition: {setting['condition']}. "
    return f"""<!-- written by benchmarks/pages.py from result files; do not edit by hand -->
# {board.benchmark}

{setting["windows"].capitalize()} ({setting["split"]}). {condition}{setting["history"]} frames in, {setting["horizon"]}
out, {setting["fps"]:g} a second, joints of `{setting["skeleton"]}`; error *at* the true times, in {unit}.

![error over the horizon]({board.benchmark}.svg)

{to_markdown(board)}
{first.windows} windows of {first.takes} takes; 95 % intervals over {first.independent}; protocol `{first.protocol}`,
data `{first.data[:16]}`. {f"Times: {board.runtime}." if board.runtime else ""}
Dashed lines are rules without training. Each row's file names its command, commit and weights; again:
`motioncast leaderboard {board.benchmark} --check MODEL --data DIR`.
"""


def index(boards: list[Leaderboard]) -> str:
    """The list of boards with the best model of each."""
    lines = [
        "<!-- written by benchmarks/pages.py from result files; do not edit by hand -->",
        "# Leaderboards",
        "",
        "| benchmark | windows | best | over standing still | 95 % |",
        "|---|---|---|---:|---|",
    ]
    for board in boards:
        best = next(place for place in board.places if not place.variant)
        ratio = best.best.ratio
        interval = "" if ratio.low is None else f"{ratio.low:.3f} to {ratio.high:.3f}"
        lines.append(
            f"| [{board.benchmark}]({board.benchmark}.md) | {board.setting['windows']} | `{best.model}` | "
            f"{best.value:.3f} | {interval} |"
        )
    for name, (what, script) in ELSEWHERE.items():
        if (FOLDER / f"{name}.md").is_file():
            lines += ["", f"[{name}]({name}.md): {what}, written by benchmarks/{script}."]
    return "\n".join([*lines, ""])


def short(board: Leaderboard) -> str:
    """A table for the README: moments and ratio only."""
    rows = [row for row in board.places[0].best.rows if row.metric.endswith(("mpjpe_at", "vim_at"))]
    rows = [row for row in rows if not row.metric.startswith("root")]
    lines = [
        f"`{board.benchmark}` ({board.setting['windows']}): error in {rows[0].unit} after",
        "",
        f"| model | {' | '.join(f'{row.horizon_s:g} s' for row in rows)} | over standing still |",
        "|---|" + "---:|" * (len(rows) + 1),
    ]
    for place in board.places:
        values = [row.value for row in place.best.rows[: len(rows)]]
        lines.append(f"| `{place.model}` | {' | '.join(f'{value:.0f}' for value in values)} | {place.value:.3f} |")
    return "\n".join([*lines, ""])


if __name__ == "__main__":
    main()
