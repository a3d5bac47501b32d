"""``motioncast demo``: the shipped dancing couple, forecast and compared with what really happened."""

from __future__ import annotations

from importlib import resources
from pathlib import Path

from motioncast.cli.comparing import error_table
from motioncast.cli.say import note
from motioncast.cli.writing import make_folder, open_page

HORIZON_S = 3.0


def demo(*, model: str = "somoformer-fast", out: Path = Path("motioncast-demo"), view: bool = False) -> None:
    """Forecast the shipped dancing couple and compare with what really happened.

    Args:
        model: Name of a model (motioncast models), or an ONNX file.
        out: Folder for the forecast and its page.
        view: Open the page in the browser.
    """
    from motioncast.formats.load import load_scene, save_forecast
    from motioncast.inference.baselines import RULES
    from motioncast.inference.registry import load
    from motioncast.metrics.curve import error_curve
    from motioncast.view.page import write_page

    with resources.as_file(resources.files("motioncast") / "data" / "salsa.npz") as example:
        scene = load_scene(example)
    now = scene.frames - round(HORIZON_S * scene.fps)
    history, truth = scene[:now], scene[now:]
    answers = {name: load(name).forecast(history, horizon_s=HORIZON_S) for name in (model, *RULES)}
    answer = answers[model]
    note(answer.warnings)
    curves = {name: error_curve(guess, truth) for name, guess in answers.items()}

    print(f"A couple dances salsa. {model}, never trained on this take, saw {history.duration_s:.1f} s and")
    print(f"forecasts {HORIZON_S:g} s. Against what really happened, mean of both people's joints:\n")
    error_table(curves, answer.fps)

    make_folder(out)
    page = out / "forecast.html"
    save_forecast(answer, out / "forecast.npz", truth)
    drawn = {name: (answer.times_s[: len(curve)], curve) for name, curve in curves.items()}
    write_page(answer, page, truth=truth, title="Salsa: what will they do next?", curves=drawn)
    print(f"\nLook at it:      {page}  (one file, open it in a browser)")
    print(f"Numbers:         {out / 'forecast.npz'}")
    print("Your own motion: motioncast forecast a.bvh b.bvh --view")
    if view:
        open_page(page)
