from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from motioncast.core.scene import Scene
from motioncast.formats.load import load_forecast, load_scene, load_truth


def test_writes_the_forecast_beside_nothing_else(walk: Path, command) -> None:
    done = command("forecast", walk, "--model", "constant-velocity", "--seconds", "1")
    assert done.status == 0
    assert "written: walk.forecast.npz" in done.out
    assert sorted(path.name for path in walk.parent.iterdir()) == ["walk.forecast.npz", "walk.npz"]
    forecast = load_forecast("walk.forecast.npz")
    assert forecast.samples.shape == (1, 30, 2, 15, 3)
    assert forecast.people == ("ada", "bea")
    assert load_truth("walk.forecast.npz") is None


def test_from_a_moment_of_the_take_it_is_compared_with_what_followed(walk: Path, walkers: Scene, command) -> None:
    done = command("forecast", walk, "--at", "1", "--model", "zero-velocity", "--seconds", "1")
    assert done.status == 0
    (line,) = [line for line in done.out.splitlines() if line.startswith("zero-velocity ") and "person" not in line]
    errors = [int(number) for number in line.split()[1:]]
    # walking at 1 m/s, standing still is wrong by the way gone (arms add a little)
    np.testing.assert_allclose(errors, [200, 400, 1000], atol=15)
    truth = load_truth("walk.forecast.npz")
    assert truth is not None
    np.testing.assert_allclose(truth.positions, walkers.positions[30:], atol=1e-6)


def test_json_is_one_object_and_writes_no_file(walk: Path, command) -> None:
    done = command("forecast", walk, "--model", "somoformer-fast", "--json", "--seconds", "0.5")
    answer = done.answer("forecast")
    assert done.err == ""
    assert np.shape(answer["samples"][0]["positions"]) == (15, 2, 15, 3)
    assert answer["times_s"][0] == pytest.approx(1 / 30, abs=1e-6)
    assert answer["files"] == []
    assert [path.name for path in walk.parent.iterdir()] == ["walk.npz"]


def test_json_names_the_files_that_were_asked_for(walk: Path, command) -> None:
    answer = command("forecast", walk, "--model", "zero-velocity", "--json", "--out", "next.npz").answer("forecast")
    assert answer["files"] == ["next.npz"]
    assert Path("next.npz").exists()


def test_what_the_user_should_know_is_said_on_stderr(walk: Path, command) -> None:
    done = command("forecast", walk, "--model", "somoformer-fast", "--samples", "10", "--json")
    assert "one future" in done.err
    assert len(done.answer("forecast")["samples"]) == 1


@pytest.mark.parametrize("at", ["0", "2.5", "-1"])
def test_a_moment_outside_the_motion(at: str, walk: Path, command) -> None:
    done = command("forecast", walk, "--at", at)
    assert done.status == 2
    assert "2.00 s" in done.err


def test_nothing_half_written_stays(walk: Path, command, monkeypatch: pytest.MonkeyPatch) -> None:
    def interrupted(*_: object, **__: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(np, "savez_compressed", interrupted)
    done = command("forecast", walk, "--model", "zero-velocity")
    assert done.status == 130
    assert [path.name for path in walk.parent.iterdir()] == ["walk.npz"]


def test_a_folder_that_is_not_there(walk: Path, command) -> None:
    done = command("forecast", walk, "--model", "zero-velocity", "--out", "nowhere/next.npz")
    assert done.status == 1
    assert "nowhere" in done.err


def test_the_motion_continued_in_another_format(walk: Path, command) -> None:
    assert command("forecast", walk, "--model", "zero-velocity", "--seconds", "1", "--out", "next.csv").status == 0
    assert command("forecast", walk, "--model", "zero-velocity", "--seconds", "1").status == 0
    done = command("export", "walk.forecast.npz", "--to", "bvh")
    assert done.status == 0
    for path in [line.removeprefix("written: ") for line in done.out.splitlines()]:
        assert load_scene(path).frames == 60 + 30
    assert command("export", "walk.forecast.npz", "--to", "glb").status == 0
    assert Path("walk.forecast.glb").read_bytes()[:4] == b"glTF"


def test_export_of_a_scene(walk: Path, walkers: Scene, command) -> None:
    assert command("export", walk, "--to", "csv").status == 0
    again = load_scene("walk.csv")
    np.testing.assert_allclose(again.positions, walkers.positions, atol=1e-3)
    assert again.people == walkers.people


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (("export", "walk.npz", "--to", "html"), "motioncast forecast"),
        (("export", "walk.npz", "--to", "csv", "--out", "walk.bvh"), "agree"),
        (("view", "walk.npz"), "motioncast forecast"),
    ],
)
def test_what_a_scene_cannot_become(arguments: tuple[str, ...], says: str, walk: Path, command) -> None:
    done = command(*arguments)
    assert done.status == 2
    assert says in done.err


def test_view_writes_the_page(walk: Path, command) -> None:
    assert command("forecast", walk, "--at", "1", "--model", "zero-velocity").status == 0
    assert command("view", "walk.forecast.npz", "--closed").status == 0
    page = Path("walk.forecast.html").read_text(encoding="utf-8")
    assert page.startswith("<!")
    assert len(page) > 10_000
