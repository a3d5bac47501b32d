"""The tables of Characteristic 3D Poses on open data; writes docs/leaderboard/cmu-goals.md and result files.

    python benchmarks/goals_table.py --data DIR --baselines FOLDER [--models FOLDER …] [--vary] [--cache FOLDER]

Trained baselines are read from their folder, or trained and kept there (minutes each on one core). Every model that
ships and every graph of the folders of runs is asked as a user would ask it; with --vary the former also unrefined,
by temperature and for 50 poses. With a cache, answers that are known are not asked for again.
"""

from __future__ import annotations

import argparse
import hashlib
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from cells import cell

from motioncast.benchmarks.goals.guesses import average_pose, nearest_neighbours, random_voxels, zero_velocity
from motioncast.benchmarks.goals.questions import GOALS, Questions, asked_of, questions
from motioncast.benchmarks.goals.run import GoalModel, answers
from motioncast.benchmarks.goals.scoring import BEST, FIRST, result_of, score
from motioncast.benchmarks.result import Row, save_result, shipped_results
from motioncast.core.card import ModelCard
from motioncast.core.skeletons import H36M17
from motioncast.datasets.cmu_goals import goal_samples, kinds
from motioncast.formats.files import atomic_write
from motioncast.inference.registry import list_models, load
from motioncast.metrics.goals import PARTS
from motioncast.nn.pose_kinds import PoseKinds, fit
from motioncast.training.goal_baselines import BASELINES, answer, baseline

PAGE = Path(__file__).parents[1] / "docs" / "leaderboard" / "cmu-goals.md"

MANY = 50
"""Poses of the row that shows what a larger choice gives."""

Table = dict[str, dict[str, Row]]
"""Model -> metric -> figure."""


class Column(NamedTuple):
    """A column of a table."""

    head: str
    metric: str
    digits: int = 1
    scale: float = 1000.0


OVERALL = [
    Column(f"best of {GOALS}, mm", BEST),
    Column("most likely, mm", FIRST),
    Column("best over standing still", "ratio_to_zero_velocity", 3, 1),
    Column("diversity, mm", "diversity"),
    Column("weighted, mm", "diversity_weighted"),
    Column("inception score", "inception_score", 2, 1),
]
STARTS = [Column(f"{where}, mm", f"{{}}_from_start_{number}")
          for number, where in enumerate(("at the start", "1/3", "1/2", "2/3", "just before"), 1)]  # fmt: skip
BODY = [Column(f"{part}, mm", f"mpjpe_{part.replace(' ', '_')}") for part in PARTS]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--data", type=Path, required=True, help="folder with the open motion data")
    parser.add_argument("--baselines", type=Path, required=True, help="folder of the trained baselines")
    parser.add_argument("--models", type=Path, nargs="*", default=[], help="folders with further graphs and cards")
    parser.add_argument("--vary", action="store_true", help="also ask the models that ship otherwise")
    parser.add_argument("--cache", type=Path, help="folder where answers are kept")
    asked = parser.parse_args()
    asked.baselines.mkdir(parents=True, exist_ok=True)
    samples, coarse = list(goal_samples(asked.data, "train")), kinds(asked.data)
    train, test = asked_of(samples, coarse), questions(asked.data, "test")
    validation = questions(asked.data, "validation")
    judge = fit(train.targets, train.kinds, validation.targets, validation.kinds, H36M17)

    def rows(card: ModelCard, poses: np.ndarray, save: bool = True) -> dict[str, Row]:
        found = score(test, poses, judge.probabilities(poses))
        if save:
            save_result(result_of(card, test, found), shipped_results())
        print(f"{card.name:32} {found[-1].value:.3f}", flush=True)
        return {row.metric: row for row in found}

    overall: Table = {
        name: rows(rule(name), poses)
        for name, poses in {
            "zero-velocity": zero_velocity(test),
            "average-pose": average_pose(test, train),
            "nearest-neighbours": nearest_neighbours(test, train),
            "random-voxels": random_voxels(test),
        }.items()
    }
    told: Table = {}
    for name in BASELINES:
        model = baseline(name, samples, validation, asked.baselines)
        overall[name] = rows(trained(name, model), answer(model, test))
        if hasattr(model, "goals_at"):
            told[f"{name}, told the frame"] = rows(trained(name, model), answer(model, test, told=True), save=False)
    ablations: Table = {}
    for model in [load(card.name) for card in list_models() if card.task == "goals"]:
        overall[model.card.name] = rows(model.card, kept(model, test, GOALS, asked.cache))
        ablations[model.card.name] = overall[model.card.name]
        ablations |= varied(model, test, asked.cache, rows) if asked.vary else {}
    for model in runs(asked.models):
        ablations[model.card.name] = rows(model.card, kept(model, test, GOALS, asked.cache), save=False)
    with atomic_write(PAGE) as temporary:
        temporary.write_text(page(overall, told, ablations, test, train, judge), encoding="utf-8")
    print(PAGE.read_text(encoding="utf-8"))


def rule(name: str) -> ModelCard:
    return ModelCard(name, "rule", "goals", "h36m17", 10, 1, 30.0)


def trained(name: str, model: Any) -> ModelCard:
    numbers = sum(parameter.numel() for parameter in model.parameters())
    return replace(rule(name), system=name, parameters=numbers, training={"seed": 0, "steps": BASELINES[name][2]})


def runs(folders: Sequence[Path]) -> list[Any]:
    """The graphs of goals in folders of runs."""
    paths = [
        path for folder in folders for path in sorted(folder.glob("*.onnx")) if path.with_suffix(".json").is_file()
    ]
    return [model for model in map(load, paths) if model.card.task == "goals"]


def varied(
    model: Any, test: Questions, cache: Path | None, rows: Callable[[ModelCard, np.ndarray, bool], dict[str, Row]]
) -> Table:
    """The same model asked otherwise: not refined, hands by chance, and for more poses."""
    name = model.card.name
    others = {
        f"{name}, not refined": (replace(model, refine=False), GOALS),
        f"{name}, hands by temperature": (replace(model, sampling="temperature"), GOALS),
        f"{name}, best of {MANY}": (model, MANY),
    }
    found: Table = {}
    for told, (other, goals) in others.items():
        card = replace(model.card, name=told)
        poses = kept(other, test, goals, cache, told)
        found[told] = rows(card, poses, False)
    return found


def kept(model: GoalModel, asked: Questions, goals: int, cache: Path | None, name: str = "") -> np.ndarray:
    """A model's answers, from the cache where it has them."""
    if cache is None:
        return answers(model, asked, goals)
    cache.mkdir(parents=True, exist_ok=True)
    told = f"{name or model.card.name} {model.card.checksum} {asked.checksum()} {goals}"
    path = cache / f"{hashlib.sha256(told.encode()).hexdigest()[:16]}.npy"
    if not path.is_file():
        poses = answers(model, asked, goals)
        with atomic_write(path) as temporary, temporary.open("wb") as file:
            np.save(file, poses.astype(np.float32))
    return np.load(path).astype(np.float64)


def markdown(table: Table, columns: Sequence[Column]) -> str:
    """A table; a column whose metric has a gap is filled with the best of all goals where there are several."""
    lines = [f"| model | {' | '.join(column.head for column in columns)} |", "|---|" + "---:|" * len(columns)]
    for name, figures in table.items():
        first = BEST if BEST in figures else FIRST
        cells = (cell(figures.get(column.metric.format(first)), column.digits, column.scale) for column in columns)
        lines.append(f"| `{name}` | {' | '.join(cells)} |")
    return "\n".join([*lines, ""])


def page(overall: Table, told: Table, ablations: Table, test: Questions, train: Questions, judge: PoseKinds) -> str:
    pairs = int(np.isfinite(test.partners[:, 0, 0, 0, 0]).sum())
    common = max(map(test.kinds.count, set(test.kinds))) / len(test)
    changed = f"""## What each part is worth

The model that ships asked otherwise, and graphs of further runs (Tables 3.3 to 3.5).

{markdown(ablations, OVERALL)}""" if ablations else ""  # fmt: skip
    return f"""<!-- written by benchmarks/goals_table.py; do not edit by hand -->
# cmu-goals

Ten frames in (a third of a second), {GOALS} characteristic poses out: what somebody is about to do as the pose in which
it culminates, without a time. {len(test):,} poses of {len(set(test.takes))} test takes, {pairs} of them of one of the
couple, each asked from five starting points; {len(train):,} poses of training takes. Joints of `h36m17` at 30 frames a
second, every pose around its own hip. ± is half of the 95 % interval of a bootstrap over takes.

The moments were found by a rule and corrected by eye in a sample of 100 (`motioncast annotate`; how often the two
agree: `python benchmarks/goals_agreement.py`). **They are not the marks of annotators**, and the figures do not compare
with the paper's, which are of other people and other actions.

## All models

The error of the best of {GOALS} is what the paper prints: the truth chooses. That of the most likely pose chooses
nothing. A model with one pose has the same error in both senses and no diversity. `nearest-neighbours` answers with the
poses that the ten most similar training histories led to. Diversity is the mean distance of two of the ten poses;
weighted, elbows and wrists count twice, as most likely in the paper.

The inception score is conditional: over the ten poses of one question. Its classifier tells the coarse kinds of takes
({", ".join(judge.kinds)}) from one pose, right in {100 * judge.accuracy(test.targets, test.kinds):.0f} %
of the true test poses, where always the most frequent kind would be right in {100 * common:.0f} %. Random voxels show
what it is worth: poses that nobody can take score, too.

{markdown(overall, OVERALL)}
The trajectory models answer with the pose in the frame that a head picks out of 100; told the true frame instead (Table
3.2):

{markdown(told, OVERALL)}
## From where one asks

Error from each starting point, of the best of {GOALS} where there are ten. Just before the pose standing still is hard
to beat.

{markdown(overall, STARTS)}
## Parts of the body

In the pose whose whole body is nearest (Table 3.9).

{markdown(overall, BODY)}
{changed}
Protocol `{test.protocol_hash()}`, data `{test.checksum()[:16]}`; again:
`python benchmarks/goals_table.py --data DIR --baselines FOLDER`.
"""


if __name__ == "__main__":
    main()
