"""``motioncast forecast``: what the people of a file will do next."""

from __future__ import annotations

from pathlib import Path

from motioncast.cli import say
from motioncast.cli.comparing import error_table, summary
from motioncast.cli.reading import AS_THE_FILE_SAYS, Reading, moment, read_scene
from motioncast.cli.writing import open_page, write_forecast
from motioncast.errors import InputError


def forecast(
    *scenes: Path,
    model: str = "somoformer-fast",
    seconds: float | None = None,
    at: float | None = None,
    samples: int = 1,
    seed: int = 0,
    out: Path | None = None,
    view: bool = False,
    json: bool = False,
    reading: Reading = AS_THE_FILE_SAYS,
) -> None:
    """Forecast the people of one scene file, or of several motion files of one world and clock.

    Writes NAME.forecast.npz into the current folder, unless --out or --json is given.

    Args:
        scenes: One scene file, or one motion file a person: bvh, amc, npz, csv, trc, c3d.
        model: Name of a model (motioncast models), or an ONNX file.
        seconds: Length of the forecast. Default: the model's horizon.
        at: Forecast from this second of the motion and compare with what follows. Default: from its end.
        samples: Number of different futures, for models that have several.
        seed: Seed of the samples.
        out: File to write; its suffix tells the format: npz, html, bvh, glb, csv, trc.
        view: Write the interactive page and open it in the browser.
        json: Print the forecast as one JSON object.
        reading: How to read files whose header lies.
    """
    if not scenes:
        raise InputError("no motion file came; give one scene file, or one motion file a person")
    scene = read_scene(scenes, reading)
    now = scene.frames if at is None else moment(scene, at)
    truth = scene[now:] if now < scene.frames else None

    from motioncast.inference.registry import load

    with say.progress(f"{model} looks ahead") as progress:
        answer = load(model).forecast(scene[:now], horizon_s=seconds, samples=samples, seed=seed, progress=progress)
    say.note(answer.warnings)

    if out is None and not json:
        out = Path(f"{scenes[0].stem}.forecast.npz")
    files = [] if out is None else write_forecast(answer, out, truth)
    if view:
        page = (out or Path(f"{scenes[0].stem}.forecast")).with_suffix(".html")
        if page not in files:
            files += write_forecast(answer, page, truth)
        open_page(page)

    if json:
        from motioncast.formats.answers import forecast_answer

        say.emit(forecast_answer(answer, files))
        return
    who = "1 person" if len(answer.people) == 1 else f"{len(answer.people)} people"
    print(f"{answer.card.name}: {who}, {answer.horizon_s:.2f} s ahead at {answer.fps:g} frames a second\n")
    summary(answer)
    print()
    if truth is not None:
        from motioncast.metrics.curve import error_curve

        error_table({answer.card.name: error_curve(answer, truth)}, answer.fps)
        print()
    for file in files:
        print(f"written: {file}")
