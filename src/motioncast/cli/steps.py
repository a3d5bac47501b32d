"""What people will do next, step by step: ``motioncast forecast`` with a model of actions."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

from motioncast.cli import say
from motioncast.cli.reading import Reading, read_scene
from motioncast.core.action_sequence import ActionSequence
from motioncast.core.action_steps import ActionSteps
from motioncast.errors import InputError


@Parameter(name="*")
@dataclass(frozen=True)
class Watching:
    """What a model of actions must be told besides a motion or the poses of a video."""

    actions: Annotated[
        Path | None, Parameter(help="Of models of actions: table of the steps so far, first, end and action by tabs.")
    ] = None
    objects: Annotated[
        tuple[str, ...],
        Parameter(help="Of models of actions: a thing that is there; once for each.", consume_multiple=True),
    ] = ()
    camera: Annotated[
        Path | None, Parameter(help="Of models of actions: JSON with focal_px, centre_px and size_px of the camera.")
    ] = None


NOT_WATCHED = Watching()


def tell_steps(
    files: Sequence[Path],
    watching: Watching,
    reading: Reading,
    model: str,
    samples: int,
    seed: int,
    json: bool,
) -> None:
    """Asks for steps and says what came.

    Args:
        files: A scene, or the poses of a video: a folder of OpenPose's JSON, or a file in COCO's layout.
        watching: Steps so far, things, camera.
        reading: How to read motion files whose header lies.
        model: Name of the model, or an ONNX file.
        samples: Number of different futures.
        seed: Seed of the samples.
        json: Print one JSON object.

    Raises:
        InputError: If steps or the camera of a video are missing.
    """
    from motioncast.formats.answers import actions_answer
    from motioncast.inference.registry import load

    forecaster = load(model)
    sequence = watched(files, watching, reading, model, forecaster.card.people)
    with say.progress(f"{model} looks ahead") as progress:
        answer = forecaster.forecast(sequence, samples=samples, seed=seed, progress=progress)
    say.note(answer.warnings)
    if json:
        say.emit(actions_answer(answer))
    else:
        _tell(answer)


def watched(files: Sequence[Path], watching: Watching, reading: Reading, model: str, people: int) -> ActionSequence:
    """The steps so far: of a video by its poses, of a scene as a camera would see it.

    Raises:
        InputError: If what the model must be told is missing.
    """
    from motioncast.datasets.videos import read_camera, steps_of, steps_of_scene
    from motioncast.formats.openpose import read_keypoints
    from motioncast.formats.steps_tsv import read_steps

    if watching.actions is None:
        raise InputError(f'"{model}" must be told what was done so far; give a table of steps with --actions FILE')
    spans = read_steps(watching.actions)
    video = len(files) == 1 and (files[0].is_dir() or files[0].suffix.lower() == ".json")
    if video and watching.camera is None:
        raise InputError(f'"{model}" must be told by which camera {files[0].name} was seen; give --camera FILE')
    camera = None if watching.camera is None else read_camera(watching.camera)
    if video and camera is not None:
        return steps_of(files[0].stem, read_keypoints(files[0], people), spans, camera, watching.objects)
    return steps_of_scene(read_scene(files, reading), spans, watching.objects, camera)


def _tell(answer: ActionSteps) -> None:
    count, steps = answer.actions.shape[:2]
    futures = "1 future" if count == 1 else f"{count} futures, the likeliest shown"
    print(f"{answer.card.name}: {steps} steps ahead, {futures}\n")
    best = answer.best
    for number, person in enumerate(answer.people):
        rows = []
        for step, action in enumerate(answer.actions[best, :, number]):
            chance = answer.probabilities[best, step, number]
            others = [label for label in (-chance).argsort()[:3] if label != action][:2]
            told = ", ".join(f"{answer.labels[label]} {chance[label]:.2f}" for label in others)
            rows.append((step + 1, answer.labels[action], f"{chance[action]:.2f}", told))
        say.table((f"step of {person}", "action", "probability", "or"), rows)
    print()
