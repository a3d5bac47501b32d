"""Every example runs on a shipped scene and does what its text says."""

from __future__ import annotations

import runpy
from importlib import resources
from pathlib import Path

import pytest

from motioncast.formats.load import load_scene, save_scene

EXAMPLES = sorted((Path(__file__).parents[1] / "examples").glob("[0-9]*.py"))
SCENE = Path(str(resources.files("motioncast"))) / "data" / "salsa.npz"

SAYS = {
    "00_forecast_a_file": "left wrist at",
    "01_follow_a_tracker": "forecast, in 3.0 s",
    "02_continue_an_animation": "salsa_continued.glb",
    "03_compare_with_simple_guesses": "root-velocity-damped",
    "04_bring_your_own_model": "all checks hold",
    "05_forecast_in_a_room": "stool: sittable at",
}
LEAVES = {
    "00_forecast_a_file": {"forecast.npz", "forecast.html"},
    "05_forecast_in_a_room": {"kitchen.json", "room.html"},
}


@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: path.stem)
def test_example(
    path: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    main = runpy.run_path(str(path))["main"]
    scene = SCENE
    if path.stem.startswith("01"):  # a forecast a frame: a second more than the model's history is enough
        scene = tmp_path / "short.npz"
        save_scene(load_scene(SCENE)[:61], scene)
    main(*([] if path.stem.startswith("04") else [str(scene)]))
    assert SAYS[path.stem] in capsys.readouterr().out
    assert LEAVES.get(path.stem, set()) <= {entry.name for entry in tmp_path.iterdir()}


def test_there_are_examples() -> None:
    assert [path.stem for path in EXAMPLES] == list(SAYS)
