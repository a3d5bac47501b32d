"""The command line called in this process, in an empty folder."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest
from jsonschema import Draft202012Validator

from motioncast.cli.app import run
from motioncast.core.scene import Scene
from motioncast.formats.load import save_scene


@dataclass(frozen=True)
class Done:
    """What a command left: exit status, and what it said on stdout and stderr."""

    status: int
    out: str
    err: str

    def answer(self, schema: str) -> dict[str, Any]:
        """The JSON object on stdout, checked against a published schema."""
        answer = json.loads(self.out)
        text = (Path(__file__).parents[2] / "docs" / "schemas" / f"{schema}.json").read_text(encoding="utf-8")
        Draft202012Validator(json.loads(text)).validate(answer)
        return answer


@pytest.fixture
def command(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> Callable[..., Done]:
    """Runs ``motioncast ARGUMENTS`` in an empty folder."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("webbrowser.open", lambda address: pytest.fail(f"a browser was opened for {address}"))

    def call(*arguments: object) -> Done:
        capsys.readouterr()
        status = run([str(argument) for argument in arguments])
        return Done(status, *capsys.readouterr())

    return call


@pytest.fixture
def walk(walkers: Scene, tmp_path: Path) -> Path:
    """A scene file of two people who walk for two seconds."""
    path = tmp_path / "walk.npz"
    save_scene(walkers, path)
    return path
