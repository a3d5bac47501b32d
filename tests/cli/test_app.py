from __future__ import annotations

import subprocess
import sys
from importlib import import_module
from pathlib import Path

import pytest

from motioncast.cli.app import COMMANDS, run
from motioncast.errors import OutputError


@pytest.mark.parametrize("name", COMMANDS)
def test_every_command_is_where_its_name_says(name: str, command) -> None:
    assert callable(getattr(import_module(f"motioncast.cli.{name}"), name))
    done = command(name, "--help")
    assert done.status == 0
    assert f"Usage: motioncast {name}" in done.out
    assert COMMANDS[name].split()[0] in done.out


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (["forcast", "a.bvh"], 'Did you mean "forecast"'),
        (["forecast", "a.npz", "--secnds", "2"], "--seconds"),
        (["forecast", "a.npz", "--seconds", "two"], '"two"'),
        (["forecast"], "no motion file came"),
        (["forecast", "nowhere.bvh"], "nowhere.bvh"),
        (["datasets", "check", "cmo", "--data", "."], "cmu"),
        (["train", "nothing", "--data", "."], "somoformer-fast"),
        (["evaluate", "zero-velocity", "cmu-dueet", "--data", "."], "cmu-duet"),
    ],
)
def test_a_mistake_is_one_sentence_and_status_2(arguments: list[str], says: str, command) -> None:
    done = command(*arguments)
    assert done.status == 2
    assert done.out == ""
    assert says in done.err
    assert len(done.err.splitlines()) == 1
    assert "Traceback" not in done.err


@pytest.mark.parametrize(
    ("error", "status", "says"),
    [
        (KeyboardInterrupt(), 130, "interrupted"),
        (OutputError("cannot write x: the disk is full; free some space"), 1, "the disk is full"),
        (ZeroDivisionError("division by zero"), 1, "a fault of motioncast"),
    ],
)
def test_exit_status(error: BaseException, status: int, says: str, command, monkeypatch: pytest.MonkeyPatch) -> None:
    def fail() -> None:
        raise error

    monkeypatch.setattr("motioncast.cli.doctor.doctor", fail)
    done = command("doctor")
    assert done.status == status
    assert says in done.err
    assert len(done.err.splitlines()) == 1


def test_our_faults_show_their_place_when_asked(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("MOTIONCAST_TRACEBACK", "1")
    monkeypatch.setattr("motioncast.cli.doctor.found", lambda package: 1 / 0)
    with pytest.raises(ZeroDivisionError):
        run(["doctor"])


def test_as_a_program(walk: Path) -> None:
    def call(*arguments: str) -> subprocess.CompletedProcess[str]:
        program = [sys.executable, "-W", "error", "-m", "motioncast.cli", *arguments]
        return subprocess.run(program, capture_output=True, text=True)

    done = call("forecast", str(walk), "--model", "zero-velocity", "--out", str(walk.parent / "next.npz"))
    assert (done.returncode, done.stderr) == (0, "")
    assert (walk.parent / "next.npz").exists()
    assert call("forecast", str(walk), "--model", "zero").returncode == 2
