"""A room around people, from the command line: forecast, view, info, JSON."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from motioncast.formats.load import load_forecast, load_scene


@pytest.fixture
def room(walk: Path) -> Path:
    table = {"name": "long table", "category": "table", "size": [2, 0.8, 0.74], "position": [0, 3], "yaw_deg": 20}
    path = walk.parent / "kitchen.json"
    path.write_text(json.dumps({"schema": "motioncast.room/1", "floor_m": 0, "objects": [table]}), encoding="utf-8")
    return path


def test_a_forecast_keeps_its_room(walk: Path, room: Path, command) -> None:
    made = command("forecast", walk, "--room", room, "--model", "zero-velocity", "--seconds", "1")
    assert (made.status, made.err) == (0, "")
    history = load_forecast("walk.forecast.npz").history
    assert [thing.name for thing in history.objects] == ["long table"]
    assert history.floor_m == 0


def test_json_lists_what_stands_around(walk: Path, room: Path, command) -> None:
    quick = ("--model", "zero-velocity", "--seconds", "0.1", "--json")
    (table,) = command("forecast", walk, "--room", room, *quick).answer("forecast")["objects"]
    assert (table["name"], table["category"], table["shape"]) == ("long table", "table", "box")
    assert table["position"] == pytest.approx([0, 3, 0.37], abs=1e-6)
    assert "objects" not in command("forecast", walk, *quick).answer("forecast")


def test_a_page_can_be_furnished_later(walk: Path, room: Path, command) -> None:
    assert command("forecast", walk, "--model", "zero-velocity", "--seconds", "1").status == 0
    assert command("view", "walk.forecast.npz", "--room", room, "--closed").status == 0
    assert "long table" in Path("walk.forecast.html").read_text(encoding="utf-8")


def test_info_lists_what_stands_around(walk: Path, room: Path, command) -> None:
    done = command("info", walk, "--room", room)
    (line,) = [line for line in done.out.splitlines() if line.startswith("long table")]
    assert "2.00 x 0.80 x 0.74 m" in line
    assert "(0.00, 3.00, 0.37)" in line
    assert "floor at 0.00 m" in done.out
    assert "object" not in command("info", walk).out


def test_what_is_inferred_or_odd_is_said(walk: Path, room: Path, command) -> None:
    about = json.loads(room.read_text())
    x, y = (float(value) for value in load_scene(walk).positions[29, 0, 0, :2])
    about["objects"][0] |= {"position": [x, y, 0.4], "size": [0.6, 0.6, 1.2]}
    del about["floor_m"]
    room.write_text(json.dumps(about), encoding="utf-8")
    done = command("forecast", walk, "--at", "1", "--room", room, "--model", "zero-velocity", "--json")
    assert "lowest feet" in done.err
    assert "ada stands" in done.err
    assert 'inside "long table"' in done.err
    assert done.status == 0


def test_a_room_with_a_mistake_is_one_sentence(walk: Path, room: Path, command) -> None:
    room.write_text(room.read_text().replace('"table"', '"desk"'), encoding="utf-8")
    done = command("forecast", walk, "--room", room)
    assert done.status == 2
    assert 'has the category "desk", which is unknown; use "table"' in done.err
    assert sorted(path.name for path in walk.parent.iterdir()) == ["kitchen.json", "walk.npz"]
