from __future__ import annotations

import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from motioncast.benchmarks.run import commit
from motioncast.cli.comparing import error_table
from motioncast.cli.doctor import providers
from motioncast.cli.info import bone_lengths
from motioncast.cli.time import measure
from motioncast.core.scene import Scene
from motioncast.formats.load import load_forecast, load_truth, save_scene
from motioncast.inference.registry import list_models


def test_demo(command, tmp_path: Path) -> None:
    done = command("demo")
    assert done.status == 0
    rows = {
        line.split()[0]: [int(cell) for cell in line.split()[1:]]
        for line in done.out.splitlines()
        if "velocity" in line
    }
    assert set(rows) == {"zero-velocity", "constant-velocity", "neck-velocity", "root-velocity-damped"}
    assert all(len(errors) == 5 for errors in rows.values())
    folder = tmp_path / "motioncast-demo"
    assert sorted(path.name for path in folder.iterdir()) == ["forecast.html", "forecast.npz"]
    forecast, truth = load_forecast(folder / "forecast.npz"), load_truth(folder / "forecast.npz")
    assert len(forecast.people) == 2
    assert truth is not None
    assert truth.frames == len(forecast.best)


def test_demo_of_the_room(command, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("motioncast.cli.demo.FUTURES", 2)
    done = command("demo", "--room", "--out", "here")
    assert done.status == 0
    (head, *rows) = [line for line in done.out.splitlines() if line.startswith((" ", "person "))]
    assert head.split() == ["truly", "future", "1", "future", "2"]
    forecast, truth = load_forecast(tmp_path / "here" / "room.npz"), load_truth(tmp_path / "here" / "room.npz")
    assert forecast.samples.shape[:2] == (2, 250)
    assert len(rows) == len(forecast.people) > 1
    assert len(forecast.history.objects) > 20
    assert truth is not None
    assert truth.frames == 250
    assert (tmp_path / "here" / "room.html").is_file()


def test_info_shows_the_mapping(walk: Path, command) -> None:
    done = command("info", walk)
    assert done.status == 0
    assert "60 frames at 30 a second, 2.00 s" in done.out
    (line,) = [line for line in done.out.splitlines() if line.startswith("left_knee ")]
    assert line.split() == ["left_knee", "left_knee", "left_hip", "42.1", "cm"]


def test_bone_lengths_count_only_what_was_seen(walkers: Scene) -> None:
    observed = walkers.observed.copy()
    knee = walkers.skeleton.index("left_knee")
    observed[:, :, knee] = False
    lengths = bone_lengths(Scene(walkers.positions, walkers.skeleton, 30, observed))
    assert np.isnan(lengths[knee])
    assert np.isnan(lengths[walkers.skeleton.index("left_ankle")])
    assert lengths[walkers.skeleton.index("right_knee")] == pytest.approx(0.421, abs=0.001)


def test_a_map_names_joints(walk: Path, command) -> None:
    Path("names.txt").write_text("left_wrist = left_hand  # it was a glove\n", encoding="utf-8")
    done = command("info", walk, "--map", "names.txt")
    assert done.status == 0
    (line,) = [line for line in done.out.splitlines() if line.startswith("left_wrist ")]
    assert line.split()[1] == "left_hand"


def test_models(command) -> None:
    done = command("models")
    assert done.status == 0
    answer = command("models", "--json").answer("models")
    assert [card["name"] for card in answer["models"]] == [card.name for card in list_models()]
    for card in answer["models"]:
        assert card["name"] in done.out


def test_time(command) -> None:
    answer = command("time", "somoformer-fast", "--people", "2", "--rounds", "3", "--json").answer("time")
    assert answer["people"] == 2
    assert 0 < answer["q1_ms"] <= answer["median_ms"] <= answer["q3_ms"]
    done = command("time", "zero-velocity", "--rounds", "2")
    assert [line.split()[0] for line in done.out.splitlines()[1:7]] == ["1", "2", "3", "4", "8", "16"]


def test_time_of_a_whole_forecast_in_a_room(command) -> None:
    room = ("--people", "1", "--objects", "3")
    answer = command("time", "sast", "--paper-size", *room, "--steps", "1", "--rounds", "1", "--json").answer("time")
    assert (answer["people"], answer["objects"]) == (1, 3)
    refused = command("time", "somoformer", "--paper-size")
    assert refused.status == 2
    assert "there is: sast" in refused.err


def test_quartiles_are_of_the_calls(monkeypatch: pytest.MonkeyPatch) -> None:
    ticks = iter([0.0, 0.001, 10.0, 10.002, 20.0, 20.003])
    monkeypatch.setattr("motioncast.cli.time.perf_counter", lambda: next(ticks))
    timing = measure(lambda: None, people=1, rounds=3)
    np.testing.assert_allclose((timing.q1_ms, timing.median_ms, timing.q3_ms), (1.5, 2.0, 2.5), rtol=1e-6)


def test_doctor_names_extras_and_models(command) -> None:
    done = command("doctor")
    assert done.status == 0
    for word in ("numpy", "extra train", "extra c3d", "somoformer-fast"):
        assert word in done.out


def test_datasets(command) -> None:
    done = command("datasets")
    assert done.status == 0
    assert "mocap.cs.cmu.edu" in done.out


def test_a_folder_without_the_data_set(command, tmp_path: Path) -> None:
    done = command("datasets", "check", "cmu", "--data", tmp_path)
    assert done.status == 2
    assert "cmu_NNN.tar.xz" in done.err


@pytest.mark.data
def test_evaluate(command, shared: Path) -> None:
    answer = command("evaluate", "zero-velocity", "somof-strangers", "--data", shared, "--json").answer("result")
    assert answer["rows"][-1]["value"] == pytest.approx(1.0, abs=1e-6)
    assert answer["commit"] == commit()
    assert answer["setting"]["moments_ms"] == pytest.approx([133.3, 266.7, 533.3, 666.7, 933.3], abs=0.1)


def test_errors_that_are_unknown_show_as_such(capsys: pytest.CaptureFixture[str]) -> None:
    error_table({"long": np.linspace(0, 1, 30), "short": np.linspace(0, 1, 30)[:6]}, fps=15)
    lines = capsys.readouterr().out.splitlines()
    assert lines[0].split() == ["error", "in", "mm", "after", "0.2", "s", "0.4", "s", "1", "s", "2", "s"]
    assert lines[2].split()[-2:] == ["-", "-"]


def test_training_without_its_extra_names_the_command(command, monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setitem(sys.modules, "torch", None)
    monkeypatch.delitem(sys.modules, "motioncast.training.loop", raising=False)
    done = command("train", "somoformer-fast", "--data", tmp_path)
    assert done.status == 1
    assert 'pip install "motioncast[train]"' in done.err


def test_plotting_without_its_extra_names_the_command(command, monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    line = '{"step": 10, "loss": 1.0, "validation": {"couple": 0.9}, "score": 0.9, "seconds": 1.0}\n'
    (tmp_path / "metrics.jsonl").write_text(line, encoding="utf-8")
    for name in [name for name in sys.modules if name.partition(".")[0] == "matplotlib"]:
        monkeypatch.delitem(sys.modules, name)
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    done = command("plot", tmp_path)
    assert done.status == 1
    assert 'pip install "motioncast[plot]"' in done.err


def test_info_ends_with_what_can_be_done(walk: Path, walkers: Scene, command) -> None:
    assert command("info", walk).out.splitlines()[-1] == "ready to forecast"
    Path("names.txt").write_text("left_knee = left_toe\nright_knee = right_toe\n", encoding="utf-8")
    last = command("info", walk, "--map", "names.txt").out.splitlines()[-1]
    assert last.startswith("cannot be forecast by somoformer-fast: no joint for left_knee, right_knee; ")
    save_scene(walkers[:20], "short.npz")
    assert "it reads 29 at 30 a second" in command("info", "short.npz").out.splitlines()[-1]
    observed = walkers.observed.copy()
    observed[-1] = False
    save_scene(replace(walkers, observed=observed), "gone.npz")
    assert "nobody is seen in the last frame" in command("info", "gone.npz").out.splitlines()[-1]


def test_info_of_a_forecast(walk: Path, command) -> None:
    assert command("forecast", walk, "--model", "zero-velocity", "--seconds", "1", "--out", "next.npz").status == 0
    line = "and a forecast by zero-velocity, 1.00 s, of ada, bea; what really happened is"
    assert f"{line} not known\n" in command("info", "next.npz").out
    assert command("forecast", walk, "--model", "zero-velocity", "--seconds", "1", "--at", "1").status == 0
    assert f"{line} in it too, 1.00 s\n" in command("info", "walk.at1.forecast.npz").out


def test_notes_of_the_original_file_are_not_said_again(walkers: Scene, command) -> None:
    save_scene(replace(walkers, remarks=("the unit was guessed",)), "noted.npz")
    assert command("info", "noted.npz").err == ""


def test_doctor_tells_where_it_computes(command) -> None:
    done = command("doctor")
    assert "cores" in done.out
    assert "CPUExecutionProvider" in done.out


def test_doctor_survives_a_broken_runtime(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "onnxruntime", None)
    assert providers().startswith("none (")


@pytest.mark.parametrize("arguments", [("--to", "fbx"), ("--to", "glb", "--out", "walk.fbx")])
def test_a_format_that_is_not_written_brings_the_way_there(walk: Path, command, arguments: tuple[str, ...]) -> None:
    done = command("export", walk, *arguments)
    assert done.status == 2
    assert "npz" in done.err
    assert "Blender" in done.err


def test_a_file_that_is_not_read_brings_the_way_there(tmp_path: Path, command) -> None:
    (tmp_path / "dance.fbx").write_bytes(b"Kaydara FBX Binary  \x00")
    done = command("forecast", "dance.fbx")
    assert done.status == 2
    assert "open it in Blender and export BVH" in " ".join(done.err.split())
