"""``motioncast demo``: a shipped scene, forecast and compared with what really happened."""

from __future__ import annotations

from collections.abc import Mapping
from importlib import resources
from pathlib import Path

import numpy as np

from motioncast.cli.comparing import error_table
from motioncast.cli.say import note, progress, table
from motioncast.cli.writing import make_folder, open_page
from motioncast.core.forecast import Forecast
from motioncast.core.scene import Scene

COUPLE_S, ROOM_S = 3.0, 10.0
"""Seconds that are forecast of the couple, and of the room."""

FUTURES = 4
"""Futures of the room: ten seconds ahead there is no one answer."""


def demo(
    *, room: bool = False, model: str | None = None, out: Path = Path("motioncast-demo"), view: bool = False
) -> None:
    """Forecast the shipped dancing couple, or people in a furnished room, and compare with what really happened.

    Args:
        room: Take the room and forecast four futures of ten seconds.
        model: Name of a model (motioncast models), or an ONNX file. Default: somoformer-fast, in the room sast.
        out: Folder for the forecast and its page.
        view: Open the page in the browser.
    """
    make_folder(out)
    page = _room(model or "sast", out) if room else _couple(model or "somoformer-fast", out)
    print(f"\nLook at it:      {page}  (one file, open it in a browser)")
    print(f"Numbers:         {page.with_suffix('.npz')}")
    if room:
        print("Your own room:   motioncast forecast room.npz --model sast --seconds 10 --samples 4 --view")
    else:
        print("Your own motion: motioncast forecast a.bvh b.bvh --view")
        print("Ten seconds of people in a furnished room: motioncast demo --room")
    if view:
        open_page(page)


def _couple(model: str, out: Path) -> Path:
    from motioncast.inference.baselines import RULES
    from motioncast.inference.registry import load_forecaster
    from motioncast.metrics.curve import error_curve

    history, truth = _example("salsa.npz", COUPLE_S)
    answers = {name: load_forecaster(name).forecast(history, horizon_s=COUPLE_S) for name in (model, *RULES)}
    answer = answers[model]
    note(answer.warnings)
    curves = {name: error_curve(guess, truth) for name, guess in answers.items()}

    print(f"A couple dances salsa. {model}, never trained on this take, saw {history.duration_s:.1f} s and")
    print(f"forecasts {COUPLE_S:g} s. Against what really happened, mean of both people's joints:\n")
    error_table(curves, answer.fps)
    return _write(answer, truth, out / "forecast.html", "Salsa: what will they do next?", curves)


def _room(model: str, out: Path) -> Path:
    from motioncast.inference.registry import load_forecaster

    history, truth = _example("room.npz", ROOM_S)
    with progress(f"{model} looks ahead") as told:
        answer = load_forecaster(model).forecast(history, horizon_s=ROOM_S, samples=FUTURES, progress=told)
    note(answer.warnings)

    print(
        f"{len(answer.people)} people among {len(history.objects)} things, in a room composed of takes that {model} was"
    )
    print(f"not trained on. How far each is from where it was, {ROOM_S:g} s later:\n")
    now, later = (scene.select(answer.people).positions for scene in (history[-1:], truth[-1:]))
    gone = np.linalg.norm((answer.samples[:, -1] - now[0]).mean(2), axis=-1)  # futures, people
    truly = np.linalg.norm((later - now)[0].mean(1), axis=-1)
    still_there = truth.select(answer.people).observed[-1].any(-1)
    rows = [
        (person, f"{truly[row]:.1f} m" if still_there[row] else "left", *(f"{metres:.1f} m" for metres in gone[:, row]))
        for row, person in enumerate(answer.people)
    ]
    table(("", "truly", *(f"future {number}" for number in range(1, len(gone) + 1))), rows)
    return _write(answer, truth, out / "room.html", "A furnished room: what will they do next?", {})


def _example(name: str, seconds: float) -> tuple[Scene, Scene]:
    """A shipped scene up to so many seconds before its end, and the rest."""
    from motioncast.formats.load import load_scene

    with resources.as_file(resources.files("motioncast") / "data" / name) as example:
        scene = load_scene(example)
    now = scene.frames - round(seconds * scene.fps)
    return scene[:now], scene[now:]


def _write(answer: Forecast, truth: Scene, page: Path, title: str, curves: Mapping[str, np.ndarray]) -> Path:
    from motioncast.formats.load import save_forecast
    from motioncast.view.page import write_page

    save_forecast(answer, page.with_suffix(".npz"), truth)
    drawn = {name: (answer.times_s[: len(curve)], curve) for name, curve in curves.items()}
    write_page(answer, page, truth=truth, title=title, curves=drawn)
    return page
