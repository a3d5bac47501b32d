"""What people may be heading for: ``motioncast forecast`` with a model of goals."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from motioncast.cli import say
from motioncast.cli.writing import check_suffix, spare_inputs
from motioncast.core.goal_poses import GoalPoses
from motioncast.core.scene import Scene

GOALS = 10
"""Goals where nobody asks for another number."""


def tell_goals(
    scene: Scene,
    given: Sequence[Path | None],
    name: str,
    model: str,
    samples: int | None,
    seed: int,
    out: Path | None,
    json: bool,
) -> None:
    """Asks for goals, writes them and says what came.

    Args:
        scene: The motion up to now.
        given: The files that were read; none of them is overwritten.
        name: What the answer is called, before its suffix.
        model: Name of the model, or an ONNX file.
        samples: Number of goals.
        seed: Seed of what is drawn by chance.
        out: File to write. Default: NAME.goals.npz, unless JSON is printed.
        json: Print one JSON object.
    """
    from motioncast.formats.load import save_goals
    from motioncast.inference.registry import load

    if out is not None:
        check_suffix(out, (".npz",))
    with say.progress(f"{model} looks for goals") as progress:
        count = GOALS if samples is None else samples
        answer = load(model).forecast(scene, samples=count, seed=seed, progress=progress)
    say.note(answer.warnings)
    targets = [out] if out is not None else [] if json else [Path(f"{name}.goals.npz")]
    spare_inputs(given, targets, answer.people)
    files = [file for target in targets for file in save_goals(answer, target)]
    if json:
        from motioncast.formats.answers import goals_answer

        say.emit(goals_answer(answer, files))
        return
    _tell(answer)
    for file in files:
        print(f"written: {file}")


def _tell(answer: GoalPoses) -> None:
    who = "1 person" if len(answer.people) == 1 else f"{len(answer.people)} people"
    print(f"{answer.card.name}: {len(answer.poses)} goals of {who}, the likeliest first\n")
    say.table(
        ("person", "probability of each goal"),
        [
            (person, " ".join(f"{weight:.2f}" for weight in answer.weights[:, number]))
            for number, person in enumerate(answer.people)
        ],
    )
    print()
