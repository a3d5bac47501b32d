"""``motioncast forecast``: what the people of a file will do next."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np

from motioncast.cli import say
from motioncast.cli.comparing import error_curves, error_table, summary
from motioncast.cli.goals import tell_goals
from motioncast.cli.reading import AS_THE_FILE_SAYS, Reading, frames_needed, moment, put_into, read_scene, seconds_of
from motioncast.cli.sampling import AS_THE_CARD_SAYS, Sampling, load_sampling, task_of
from motioncast.cli.steps import NOT_WATCHED, Watching, tell_steps
from motioncast.cli.writing import check_suffix, name_of, open_page, page_beside, spare_inputs, write_forecast
from motioncast.core.forecast import Forecast
from motioncast.core.forecaster import Forecaster
from motioncast.core.scene import Scene
from motioncast.errors import InputError, SceneError


def forecast(
    *scenes: Path,
    model: str = "somoformer-fast",
    seconds: float | None = None,
    at: float | None = None,
    room: Path | None = None,
    samples: int | None = None,
    seed: int = 0,
    sampling: Sampling = AS_THE_CARD_SAYS,
    watching: Watching = NOT_WATCHED,
    out: Path | None = None,
    view: bool = False,
    json: bool = False,
    reading: Reading = AS_THE_FILE_SAYS,
) -> None:
    """Forecast the people of one scene file, or of several motion files of one world and clock.

    Writes NAME.forecast.npz into the current folder, unless --out or --json is given: a+b.forecast.npz of a.bvh and
    b.bvh, a.at1.2.forecast.npz with --at 1.2. A file that was given is never overwritten.

    Args:
        scenes: One scene file, or one motion file a person: bvh, amc, npz, csv, trc, c3d.
        model: Name of a model (motioncast models), or an ONNX file.
        seconds: Length of the forecast. Default: the model's horizon.
        at: Forecast from this second of the motion and compare with what follows. Default: from its end.
        room: Furniture around the people: a JSON file written by hand, or a GLB whose nodes are named.
        samples: Number of different futures, for models that have several, or of goals. Default: 1; 10 goals.
        seed: Seed of the samples.
        sampling: How a model that denoises draws its futures.
        watching: What a model of actions is told besides.
        out: File to write; its suffix tells the format: npz, html, bvh, glb, csv, trc.
        view: Write the interactive page, NAME.forecast.html, and open it in the browser.
        json: Print the forecast as one JSON object.
        reading: How to read files whose header lies.
    """
    if not scenes:
        raise InputError("no motion file came; give one scene file, or one motion file a person")
    if out is not None:
        check_suffix(out)
    task = task_of(model)
    if task == "actions":
        if any((seconds, at, room, out, view)) or sampling != AS_THE_CARD_SAYS:
            raise InputError(
                "steps have no clock, no room and no file; leave --seconds, --at, --room, --out, --view, --sampler and "
                "--steps out, and print them with --json"
            )
        tell_steps(scenes, watching, reading, model, samples or 1, seed, json)
        return
    if watching != NOT_WATCHED:
        raise InputError(f'"{model}" is no model of actions; leave --actions, --objects and --camera out')
    scene = read_scene(scenes, reading)
    now = scene.frames if at is None else moment(scene, at)
    if room is not None:
        scene = put_into(scene, room, now)
    if task == "goals":
        if seconds is not None or view or sampling != AS_THE_CARD_SAYS:
            raise InputError("goals have no time; leave --seconds, --view, --sampler and --steps out")
        tell_goals(scene[:now], [*scenes, reading.map, room], name_of(scenes, at), model, samples, seed, out, json)
        return
    truth = scene[now:] if now < scene.frames else None
    answer = _answer(scene, now, load_sampling(model, sampling), seconds, samples or 1, seed)
    say.note(answer.warnings)

    usual = Path(f"{name_of(scenes, at)}.forecast.npz")
    targets = [out] if out is not None else [] if json else [usual]
    page = out if out is not None and out.suffix.lower() == ".html" else page_beside(out or usual)
    if view and page not in targets:
        targets.append(page)
    spare_inputs([*scenes, reading.map, room], targets, answer.people)
    files = [file for target in targets for file in write_forecast(answer, target, truth)]
    if json:
        from motioncast.formats.answers import forecast_answer

        say.emit(forecast_answer(answer, files))
    else:
        _tell(answer, truth, files)
    if view:
        open_page(page)


def _answer(scene: Scene, now: int, forecaster: Forecaster, seconds: float | None, samples: int, seed: int) -> Forecast:
    """The forecast from frame ``now`` on; its warnings name the people who are left out."""
    model, needed = forecaster.card.name, frames_needed(forecaster.card, scene.fps)
    try:
        with say.progress(f"{model} looks ahead") as progress:
            answer = forecaster.forecast(scene[:now], horizon_s=seconds, samples=samples, seed=seed, progress=progress)
    except SceneError as error:
        if not now < needed <= scene.frames:
            raise
        raise SceneError(
            f'--at {seconds_of(now, scene.fps)} leaves {now} frames before it and "{model}" reads {needed}; '
            f"it works from --at {seconds_of(needed, scene.fps)} on"
        ) from error
    return replace(answer, warnings=(*answer.warnings, *left_out(scene, now, answer.people, needed)))


def left_out(scene: Scene, now: int, forecast: tuple[str, ...], needed: int) -> list[str]:
    """Who is in the scene but not in the forecast, a sentence each, and the latest moment that includes everybody.

    Args:
        scene: The whole scene.
        now: Number of its frames that are history.
        forecast: The people that are forecast.
        needed: Frames of history that the model needs.
    """
    there = np.asarray(scene.observed.any(-1))  # (time, people)
    together = 1 + np.flatnonzero(there[:now].all(1))
    together = together[together >= needed]
    advice = f"; --at {seconds_of(together[-1], scene.fps)} includes everybody" if len(together) else ""
    sentences = []
    for person, name in enumerate(scene.people):
        if name in forecast:
            continue
        before = np.flatnonzero(there[:now, person])
        if len(before):
            last = f"ends at {(before[-1] + 1) / scene.fps:.2f} s, before now ({now / scene.fps:.2f} s),"
        else:
            last = f"is not seen before now ({now / scene.fps:.2f} s)"
        sentences.append(f"{name} {last} and is not forecast{advice}")
    return sentences


def _tell(answer: Forecast, truth: Scene | None, files: list[Path]) -> None:
    who = "1 person" if len(answer.people) == 1 else f"{len(answer.people)} people"
    print(f"{answer.card.name}: {who}, {answer.horizon_s:.2f} s ahead at {answer.fps:g} frames a second\n")
    summary(answer)
    print()
    if truth is not None:
        error_table(error_curves(answer, truth), answer.fps)
        print()
    for file in files:
        print(f"written: {file}")
