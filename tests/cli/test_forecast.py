from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from motioncast.core.scene import Scene
from motioncast.formats.load import load_forecast, load_scene, load_truth, save_forecast, save_scene
from motioncast.inference.registry import load


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
    truth = load_truth("walk.at1.forecast.npz")
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


def test_only_models_that_denoise_take_steps(walk: Path, command) -> None:
    for option, value in (("--steps", "10"), ("--sampler", "ddim")):
        done = command("forecast", walk, "--model", "somoformer-fast", option, value)
        assert done.status == 2
        assert "does not denoise" in done.err


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
    again = load_scene("walk.motioncast.csv")
    np.testing.assert_allclose(again.positions, walkers.positions, atol=1e-3)
    assert again.people == walkers.people


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (("export", "walk.npz", "--to", "html"), "motioncast forecast"),
        (("export", "walk.npz", "--to", "csv", "--out", "walk.bvh"), "agree"),
        (("export", "walk.npz", "--to", "glb", "--out", "walk.fbx"), "Blender"),
        (("view", "walk.npz"), "motioncast forecast"),
    ],
)
def test_what_a_scene_cannot_become(arguments: tuple[str, ...], says: str, walk: Path, command) -> None:
    done = command(*arguments)
    assert done.status == 2
    assert says in done.err


def test_view_writes_the_page(walk: Path, command) -> None:
    assert command("forecast", walk, "--at", "1", "--model", "zero-velocity").status == 0
    assert command("view", "walk.at1.forecast.npz", "--closed").status == 0
    page = Path("walk.at1.forecast.html").read_text(encoding="utf-8")
    assert page.startswith("<!")
    assert len(page) > 10_000


def test_names_that_cannot_be_those_of_the_input(walk: Path, walkers: Scene, command) -> None:
    save_scene(walkers.select(["ada"]), "ada.npz")
    save_scene(walkers.select(["bea"]), "bea.npz")
    done = command("forecast", "ada.npz", "bea.npz", "--model", "zero-velocity")
    assert "written: ada+bea.forecast.npz" in done.out
    done = command("forecast", walk, "--model", "zero-velocity", "--at", "1.2")
    assert "written: walk.at1.2.forecast.npz" in done.out
    done = command("forecast", "ada+bea.forecast.npz", "--model", "zero-velocity")
    assert "written: ada+bea.forecast.forecast.npz" in done.out
    assert "written: ada+bea.forecast.csv" in command("export", "ada+bea.forecast.npz", "--to", "csv").out
    assert "written: ada+bea.motioncast.csv" in command("export", "ada.npz", "bea.npz", "--to", "csv").out


@pytest.mark.parametrize(
    ("arguments", "file"),
    [
        (("forecast", "ada.bvh", "ada_ada.bvh", "--model", "zero-velocity", "--out", "ada.bvh"), "ada_ada.bvh"),
        (("forecast", "ada.bvh", "--model", "zero-velocity", "--out", "ada.bvh"), "ada.bvh"),
        (("forecast", "ada.bvh", "--model", "zero-velocity", "--out", "folder/../ada.bvh"), "ada.bvh"),
        (("export", "ada.bvh", "ada_ada.bvh", "--to", "bvh", "--out", "ada.bvh"), "ada_ada.bvh"),
        (("export", "ada.bvh", "--to", "bvh", "--out", "ada.bvh"), "ada.bvh"),
    ],
)
def test_a_file_that_was_given_is_never_overwritten(
    arguments: tuple[str, ...], file: str, walkers: Scene, command
) -> None:
    save_scene(walkers.select(["ada"]), "ada.bvh")
    save_scene(walkers.select(["bea"]), "ada_ada.bvh")  # the name under which ada.bvh --out ada.bvh would put ada
    Path("folder").mkdir()
    before = {path: path.read_bytes() for path in Path().glob("*.bvh")}
    done = command(*arguments)
    assert done.status == 2
    assert f"{file} is the file you gave; name another with --out" in done.err
    assert {path: path.read_bytes() for path in Path().glob("*.bvh")} == before


def test_a_link_to_the_input_is_the_input(walk: Path, command) -> None:
    try:
        Path("link.npz").symlink_to(walk)
    except OSError:
        pytest.skip("this system makes no links")
    done = command("forecast", walk, "--model", "zero-velocity", "--out", "link.npz")
    assert done.status == 2
    assert "link.npz is the file you gave" in done.err


def test_a_forecast_is_not_exported_onto_itself(walk: Path, command) -> None:
    assert command("forecast", walk, "--model", "zero-velocity").status == 0
    done = command("export", "walk.forecast.npz", "--to", "npz")
    assert done.status == 2
    assert "walk.forecast.npz is the file you gave" in done.err


def leaving(walkers: Scene, ada_s: float, bea_from_s: float = 0.0) -> Scene:
    """The walkers, of whom ada is seen up to a moment and bea from a moment on."""
    observed = walkers.observed.copy()
    observed[round(ada_s * 30) :, 0] = False
    observed[: round(bea_from_s * 30), 1] = False
    return replace(walkers, observed=observed)


def test_who_is_left_out_is_named(walkers: Scene, command) -> None:
    save_scene(leaving(walkers, 1.5), "left.npz")
    done = command("forecast", "left.npz", "--model", "zero-velocity", "--json")
    note = "ada ends at 1.50 s, before now (2.00 s), and is not forecast; --at 1.5 includes everybody"
    assert done.err == f"note: {note}\n"
    assert done.answer("forecast")["warnings"] == [note]
    done = command("forecast", "left.npz", "--model", "zero-velocity", "--at", "1.5")
    assert done.err == ""
    assert "2 people" in done.out


@pytest.mark.parametrize("scene", [{"ada_s": 0.27}, {"ada_s": 1.0, "bea_from_s": 1.2}])
def test_no_moment_is_advised_where_none_serves(scene: dict[str, float], walkers: Scene, command) -> None:
    save_scene(leaving(walkers, **scene), "left.npz")
    done = command("forecast", "left.npz", "--json")
    assert "and is not forecast\n" in done.err
    assert "--at" not in done.err


def test_who_comes_later_is_named(walkers: Scene, command) -> None:
    save_scene(leaving(walkers, 2.0, 1.5), "late.npz")
    done = command("forecast", "late.npz", "--at", "1", "--model", "zero-velocity")
    assert done.err == "note: bea is not seen before now (1.00 s) and is not forecast\n"


def test_a_moment_too_early_says_from_when_on(walk: Path, command) -> None:
    done = command("forecast", walk, "--at", "0.3")
    assert done.status == 2
    assert "--at 0.3 leaves 9 frames before it" in done.err
    assert "works from --at 0.967 on" in done.err
    assert command("forecast", walk, "--at", "0.967").status == 0
    assert command("forecast", walk, "--at", "0.933").status == 2


def test_standing_still_is_measured_too(walk: Path, command) -> None:
    done = command("forecast", walk, "--at", "1", "--seconds", "0.5", "--out", "next.html")
    header, model, still = done.out.split("\n\n")[-2].splitlines()
    assert header.split()[-6:] == ["0.2", "s", "0.4", "s", "0.5", "s"]
    assert (model.split()[0], still.split()[0]) == ("somoformer-fast", "zero-velocity")
    np.testing.assert_allclose([int(cell) for cell in still.split()[1:]], [200, 400, 500], atol=15)
    assert "zero-velocity" in Path("next.html").read_text(encoding="utf-8")


@pytest.mark.parametrize(("seconds", "moments"), [("0.1", ["0.1"]), ("5", ["0.2", "0.4", "1", "2", "3", "5"])])
def test_the_table_ends_with_the_last_moment(seconds: str, moments: list[str], walk: Path, command) -> None:
    done = command("forecast", walk, "--model", "zero-velocity", "--seconds", seconds)
    (line,) = [line for line in done.out.splitlines() if line.startswith("after ")]
    assert line.split()[1::2] == moments


@pytest.mark.parametrize("out", ["next.fbx", "next", "next.txt"])
def test_an_unknown_suffix_is_told_before_the_work(out: str, command) -> None:
    done = command("forecast", "nowhere.bvh", "--out", out)
    assert done.status == 2
    assert ".html" in done.err
    assert "FBX" in done.err
    assert "docs/formats.md" in done.err


def test_no_browser(walk: Path, command, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("webbrowser.open", lambda address: False)
    done = command("forecast", walk, "--model", "zero-velocity", "--view", "--out", "two.npz")
    assert done.status == 0
    assert "open two.forecast.html yourself" in done.err
    assert "open two.forecast.html yourself" in command("view", "two.npz").err


def test_a_browser(walk: Path, command, monkeypatch: pytest.MonkeyPatch) -> None:
    shown: list[str] = []
    monkeypatch.setattr("webbrowser.open", lambda address: shown.append(address) or True)
    done = command("forecast", walk, "--model", "zero-velocity", "--view", "--json")
    assert done.err == ""
    assert done.answer("forecast")["files"] == ["walk.forecast.html"]
    assert shown == [Path("walk.forecast.html").resolve().as_uri()]


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (("view", "a.npz", "b.npz"), "2 files came; view shows one forecast"),
        (("view",), "no file came"),
        (("view", "nowhere.bvh"), "nowhere.bvh"),
        (("view", "walk.npz"), "only forecasts can be shown; make one with: motioncast forecast walk.npz --view"),
        (("export", "--to", "npz"), "no file came"),
    ],
)
def test_what_cannot_be_shown(arguments: tuple[str, ...], says: str, walk: Path, command) -> None:
    done = command(*arguments)
    assert done.status == 2
    assert says in done.err
    assert len(done.err.splitlines()) == 1


def test_a_page_is_html(walk: Path, command) -> None:
    assert command("forecast", walk, "--model", "zero-velocity").status == 0
    before = Path("walk.forecast.npz").read_bytes()
    assert command("view", "walk.forecast.npz", "--closed", "--out", "walk.forecast.npz").status == 2
    assert Path("walk.forecast.npz").read_bytes() == before


def test_a_truth_that_lacks_somebody_can_be_shown(walk: Path, walkers: Scene, command) -> None:
    answer = load("zero-velocity").forecast(walkers[:30])
    save_forecast(answer, "next.npz", walkers[30:].select(["ada"]))
    assert command("view", "next.npz", "--closed").status == 0
