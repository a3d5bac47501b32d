"""The tables of SAST's paper, and what it leaves unmeasured, on furnished rooms; writes docs/leaderboard/rooms.md.

    python benchmarks/rooms_table.py --data DIR [--models FOLDER …] [--cache FOLDER]

Every model that ships and every graph of the folders of runs is asked as a user would ask it. Its result file goes into
the package, where ``motioncast leaderboard rooms`` finds it. With a cache, forecasts that are known are not made again.
"""

from __future__ import annotations

import argparse
import hashlib
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np
from cells import cell

from motioncast.benchmarks.result import Row, save_result, shipped_results
from motioncast.benchmarks.rooms.run import MADE, ROOMS, forecast_rooms, real_words, result_of, room_windows, score
from motioncast.benchmarks.rooms.scoring import HIPS, ahead
from motioncast.benchmarks.rooms.tally import rows
from motioncast.benchmarks.rooms.windows import PROTOCOL, RoomWindow, checksum, manifest, protocol_hash
from motioncast.core.forecaster import Forecaster
from motioncast.formats.files import atomic_write
from motioncast.inference.registry import list_models, load
from motioncast.training.judge import judge, realism, stayed

ROOT = Path(__file__).parents[1]
PAGE = ROOT / "docs" / "leaderboard" / "rooms.md"
MANIFEST = ROOT / "src" / "motioncast" / "benchmarks" / "manifests" / "rooms.csv"
GUESSES = ("zero-velocity", "root-velocity-damped", "replay")

FEWEST = 20
"""Events below which nothing is said about where people go."""

Table = dict[str, dict[tuple[str, float], Row]]
"""Model -> metric and moment -> figure."""


class Column(NamedTuple):
    """A column of a table."""

    head: str
    metric: str
    moment_s: float = 10.0
    digits: int = 2
    scale: float = 1.0


REALISM = [
    *(Column(f"realism × 100 until {s} s", "realism_until", s, 1, 100) for s in (2, 4, 6, 8, 10)),
    *(Column(f"by judges who never saw it, {s} s", "realism_unseen_until", s, 1, 100) for s in (2, 6, 10)),
]
LOCAL = [
    Column("NDMS", "ndms", digits=3),
    *(Column(f"UMWR {s} s", "umwr_of_second", s) for s in (2, 4, 6, 8, 10)),
    Column("UMWR, whole", "umwr"),
    Column("jump at the seam over real", "seam_over_real"),
    Column("foot skating, m/s", "foot_skating", digits=3),
]
WAYS = [
    Column("path, m", "path_length"),
    Column("its deviation", "path_length_std"),
    Column("W1 to true paths", "path_length_w1"),
    Column("ADE, m", "ade_k1"),
    Column(f"ADE, best of {PROTOCOL.samples}", f"ade_best_of_{PROTOCOL.samples}_per_person"),
    Column("FDE, m", "fde_k1"),
    Column(f"FDE, best of {PROTOCOL.samples}", f"fde_best_of_{PROTOCOL.samples}_per_person"),
    Column(f"APD of {PROTOCOL.samples}, m", f"apd_of_{PROTOCOL.samples}"),
    Column("error over standing still", "ratio_to_zero_velocity", digits=3),
]
PLACES = [
    Column("depth in things, mm", "depth_in_things", 10, 1, 1000),
    Column("95th percentile, mm", "depth_in_things_p95", 10, 1, 1000),
    Column("deeper than 2 cm, %", "frames_deeper_than_2_cm", 10, 1, 100),
    Column("than 5 cm, %", "frames_deeper_than_5_cm", 10, 1, 100),
    Column("sitting, %", "sitting_frames", 10, 1, 100),
    Column("on a seat, % of it", "seat_under_sitting", 10, 1, 100),
    Column("feet on the floor, %", "floor_under_standing", 10, 1, 100),
    Column("through walls, % of people", "people_through_walls", 10, 1, 100),
    Column("at the right thing, %", "goal_accuracy", 10, 1, 100),
    Column("by chance, %", "goal_chance", 10, 1, 100),
    Column("if another was nearer, %", "goal_ahead_accuracy", 10, 1, 100),
    Column("by chance, %", "goal_ahead_chance", 10, 1, 100),
    Column("on the right seat, %", "goal_sit_accuracy", 10, 1, 100),
    Column("by chance, %", "goal_sit_chance", 10, 1, 100),
]
COMPANY = [
    Column("pairs in one another, %", "pairs_overlapping", 10, 2, 100),
    Column("how deep, mm", "overlap_of_pairs", 10, 2, 1000),
    Column("W1 to how near pairs truly come, m", "nearest_approach_w1"),
    Column("couples in time", "synchrony_recorded"),
    Column("more than with strangers", "synchrony_recorded_over_strangers"),
    Column("composed neighbours, more than with strangers", "synchrony_composed_over_strangers"),
    Column("couples set out apart, s", "onset_lag_recorded"),
    Column("less than with strangers if negative, s", "onset_lag_recorded_over_strangers"),
    Column("composed neighbours, s", "onset_lag_composed"),
    Column("less than with strangers if negative, s", "onset_lag_composed_over_strangers"),
]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--data", type=Path, required=True, help="folder with the open motion data")
    parser.add_argument("--models", type=Path, nargs="*", default=[], help="folders with further graphs and cards")
    parser.add_argument("--cache", type=Path, help="folder where forecasts are kept")
    asked = parser.parse_args()
    test = room_windows(asked.data, "test")
    train = [window.recorded() for window in room_windows(asked.data, "train")]
    MANIFEST.write_text(manifest(test), encoding="utf-8")
    words = real_words(train)
    table: Table = {}
    answers: dict[str, list[np.ndarray]] = {
        "truth": [window.future[None] for window in test],
        "somebody else": borrowed(test),
    }
    made_up: dict[str, np.ndarray] = {}
    systems: dict[str, str] = {}
    for name, samples in answers.items():
        table[name] = {(row.metric, row.horizon_s): row for row in score(test, samples, words)}
    for model in models(asked.models):
        name = model.card.name
        answers[name] = kept(model, test, asked.cache)
        made_up[name] = stayed(train, kept(model, train, asked.cache))
        systems[name] = model.card.system if model.card.parameters else name
        result = result_of(model.card, test, answers[name], words)
        save_result(result, shipped_results())
        table[name] = {(row.metric, row.horizon_s): row for row in result.rows}
        print(f"{name:40} {result.ratio.value:.3f}", flush=True)
    recorded = [window.recorded() for window in test]
    judged(table, recorded, answers, stayed(train, [window.future[None] for window in train]), made_up, systems)
    pictures(table)
    with atomic_write(PAGE) as temporary:
        temporary.write_text(page(table, test), encoding="utf-8")
    print(PAGE.read_text(encoding="utf-8"))


def models(folders: Sequence[Path]) -> list[Forecaster]:
    """The guesses, then every model of the joints of rooms, those that ship and those of runs."""
    shipped = [
        load(card.name) for card in list_models() if card.skeleton == PROTOCOL.skeleton and card.task == "forecast"
    ]
    further = [
        load(path)
        for folder in folders
        for path in sorted(folder.glob("*.onnx"))
        if path.with_suffix(".json").is_file()
    ]
    return [*map(load, GUESSES), *shipped, *(model for model in further if model.card.skeleton == PROTOCOL.skeleton)]


def kept(model: Forecaster, windows: Sequence[RoomWindow], cache: Path | None) -> list[np.ndarray]:
    """A model's futures, from the cache where it has them."""
    if cache is None:
        return forecast_rooms(model, windows)
    cache.mkdir(parents=True, exist_ok=True)
    told = f"{model.card.name} {model.card.checksum} {checksum(windows)} {PROTOCOL.samples}"
    path = cache / f"{model.card.name.replace(' ', '-')}.{hashlib.sha256(told.encode()).hexdigest()[:12]}.npz"
    if not path.is_file():
        futures = forecast_rooms(model, windows)
        with atomic_write(path) as temporary, temporary.open("wb") as file:
            np.savez(file, *(samples.astype(np.float32) for samples in futures))
    with np.load(path) as stored:
        return [stored[f"arr_{number}"] for number in range(len(windows))]


def borrowed(windows: Sequence[RoomWindow], seed: int = 0) -> list[np.ndarray]:
    """Control: for each person what somebody of another room really did, set down where this person is and looks."""
    random, answers = np.random.default_rng(seed), []
    tracks = [
        (window.room, np.concatenate([window.scene.positions[-1:], window.future])[:, person])
        for window in windows
        for person in np.flatnonzero(window.seen.all(0))
    ]
    for window in windows:
        others = [track for room, track in tracks if room != window.room]
        people = []
        for pose in window.scene.positions[-1]:
            track = others[int(random.integers(len(others)))]
            middles = [body[list(HIPS)].mean(0) for body in (pose, track[0])]
            across = [body[HIPS[1]] - body[HIPS[0]] for body in (pose, track[0])]
            mine, theirs = (np.arctan2(line[1], line[0]) for line in across)
            cosine, sine = np.cos(mine - theirs), np.sin(mine - theirs)
            turn = np.array([[cosine, sine, 0], [-sine, cosine, 0], [0, 0, 1]])
            ground = [1.0, 1.0, 0.0]
            people.append((track[1:] - middles[1] * ground) @ turn + middles[0] * ground)
        answers.append(np.stack(people, 1)[None])
    return answers


def measured(figures: Sequence, windows: Sequence[RoomWindow]) -> dict[tuple[str, float], Row]:
    names = [window.room for window in windows]
    return {(row.metric, row.horizon_s): row for row in rows(figures, names, PROTOCOL.fps)}


def judged(
    table: Table,
    windows: Sequence[RoomWindow],
    answers: Mapping[str, list[np.ndarray]],
    real: np.ndarray,
    made_up: Mapping[str, np.ndarray],
    systems: Mapping[str, str],
) -> None:
    """Add realism: by a judge of all models, and of each by one who never saw it or another of its system."""
    knows_all = judge(real, made_up)
    for name, samples in answers.items():
        table[name] |= measured(realism(knows_all, windows, samples), windows)
    for system in dict.fromkeys(systems.values()):
        fair = judge(real, {name: motion for name, motion in made_up.items() if systems[name] != system})
        for name in (name for name in made_up if systems[name] == system):
            found = measured(realism(fair, windows, answers[name]), windows)
            table[name] |= {("realism_unseen_until", moment): row for (_, moment), row in found.items()}


def markdown(table: Table, columns: Sequence[Column], mark: str = "") -> str:
    lines = [f"| model | {' | '.join(column.head for column in columns)} |", "|---|" + "---:|" * len(columns)]
    for name, figures in table.items():
        cells = (
            cell(figures.get((column.metric + mark, column.moment_s)), column.digits, column.scale)
            for column in columns
        )
        lines.append(f"| `{name}` | {' | '.join(cells)} |")
    return "\n".join([*lines, ""])


def pictures(table: Table) -> None:
    """Mean speed over time, and realism over the horizon."""
    import matplotlib
    from matplotlib.figure import Figure

    figure = Figure(figsize=(10, 4), layout="constrained")
    speed, real = figure.subplots(1, 2)
    for axes, metric, label in ((speed, "speed_in_second", "mean speed, m/s"), (real, "realism_until", "realism")):
        for number, (name, figures) in enumerate(table.items()):
            line = sorted((moment, row.value) for (key, moment), row in figures.items() if key == metric)
            colour = "black" if name == "truth" else matplotlib.colormaps["tab20"](number % 20)
            axes.plot(*zip(*line, strict=True), color=colour, marker="o", markersize=2, label=name)
        axes.set(xlabel="seconds ahead", ylabel=label)
        axes.spines[["top", "right"]].set_visible(False)
    figure.legend(*speed.get_legend_handles_labels(), loc="outside right upper", frameon=False, fontsize=7)
    with atomic_write(PAGE.with_suffix(".svg")) as temporary, matplotlib.rc_context({"svg.hashsalt": "motioncast"}):
        figure.savefig(temporary, metadata={"Date": None})


def too_few(windows: Sequence[RoomWindow]) -> str:
    goals = [(window, goal) for window in windows for goal in window.goals]
    counts = {
        "such events": len(goals),
        "of them with another nearer at first": sum(ahead(*goal) for goal in goals),
        "of them seats": sum(goal.kind == "sit" for _, goal in goals),
    }
    told = (f"{count} {what}{' (too few: not measurable)' * (count < FEWEST)}" for what, count in counts.items())
    return ", ".join(told) + "."


def page(table: Table, windows: Sequence[RoomWindow]) -> str:
    people = sum(len(window.scene.people) for window in windows)
    recorded = [window.recorded() for window in windows]
    whole = sum(int(window.seen.all(0).sum()) for window in recorded)
    made = sum(int(window.synthetic.sum()) for window in windows)
    few_real, few = (too_few(some) for some in (recorded, windows))
    return f"""<!-- written by benchmarks/rooms_table.py; do not edit by hand -->
# rooms

One second in, ten seconds out, 25 frames a second, joints of `{PROTOCOL.skeleton}`; {ROOMS} furnished rooms of the test
takes, {len(windows)} windows, {people} people who are there at now. Inverse kinematics moves {made} of them somewhere
in their window; they count only where it is said. Of the others {whole} stay all the time. ± is half of the 95 %
interval of a bootstrap over rooms; rooms share the takes of the test split, so that other takes may differ by more.
Every figure but the errors of the best of {PROTOCOL.samples} and APD is of the first sample.

![speed and realism over time](rooms.svg)

`truth` is what happened. `somebody else` is real motion of a person of another room, set down in place: what a figure
gives to real motion that has nothing to do with this room. `zero-velocity`, `root-velocity-damped` and `replay` are
rules. Models of a shorter horizon were rolled out on their own forecasts.

## Is it a way to move?

The judge is the paper's classifier, trained on windows of training rooms: half real, half of the models below in equal
parts. Judges who never saw a model, nor another of its system, are less sure of it.

{markdown(table, REALISM)}
NDMS and UMWR against words of training rooms. A jump at the seam is the change of velocity there, mean over joints,
over the same at every moment of the true motion.

{markdown(table, LOCAL)}
## Where does it lead?

Paths over the ground of those who were there all the time. ADE, FDE and APD are norms of a person's whole pose.

{markdown(table, WAYS)}
## Does it respect things?

The deepest joint of a body inside a box or a cylinder; seats do not count for who sits. A seat is under who sits where
its top is at most 20 cm below the pelvis, the floor under who stands where the lower ankle is at most 16 cm
above it. The right thing is what a person truly went to, among all of its kind in the room, at the moment of the
contact: {few_real}

{markdown(table, PLACES)}
The same with people whom inverse kinematics moves: they sit, reach and write as a rule says, not as anybody did;
{few}

{markdown(table, PLACES, MADE)}
## Does it respect people?

Bodies are capsules of 5 cm. In time: correlation over time of the speeds of two neighbours, of couples who were
recorded together and of people who were set beside one another, against the same people with people of other rooms;
likewise the seconds between one of them setting out and the other.

{markdown(table, COMPANY)}
Protocol `{protocol_hash(windows)}`, data `{checksum(windows)[:16]}`; again:
`python benchmarks/rooms_table.py --data DIR --models FOLDER`, one model: `motioncast evaluate MODEL rooms --data DIR`.
"""


if __name__ == "__main__":
    main()
