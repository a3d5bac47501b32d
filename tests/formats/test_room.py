"""Rooms written by hand: what is read, and the sentence about what cannot be."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from motioncast.core.room import Room
from motioncast.core.scene_object import SceneObject
from motioncast.errors import FormatError, InputError, OutputError
from motioncast.formats.room import read_room, write_room

TABLE = {"name": "table", "category": "table", "size": [1.6, 0.8, 0.74], "position": [2, 1]}
STOOL = {
    "name": "stool", "category": "sittable", "shape": "cylinder", "size": [0.4, 0.4, 0.5],
    "position": [0, 1, 0.25], "yaw_deg": 90,
}  # fmt: skip


def write(folder: Path, **room: object) -> Path:
    path = folder / "room.json"
    path.write_text(json.dumps({"schema": "motioncast.room/1", "floor_m": 0.1, "objects": [TABLE, STOOL], **room}))
    return path


def test_a_room_is_read(tmp_path: Path) -> None:
    room = read_room(write(tmp_path))
    table, stool = room.objects
    assert room.floor_m == 0.1
    assert (table.name, table.category, table.shape) == ("table", "table", "box")
    np.testing.assert_allclose(table.position, [2, 1, 0.1 + 0.37], atol=1e-6)
    np.testing.assert_allclose(stool.outward(np.array([1.0, 0, 0])), [0, 2, 0.25], atol=1e-6)


def test_the_room_of_the_docs_is_read(tmp_path: Path) -> None:
    page = (Path(__file__).parents[2] / "docs" / "formats.md").read_text(encoding="utf-8")
    (tmp_path / "room.json").write_text(page.split("```json\n")[1].split("```")[0], encoding="utf-8")
    assert [thing.category for thing in read_room(tmp_path / "room.json").objects] == ["table", "sittable", "kettle"]


def test_what_is_written_is_read_again(tmp_path: Path) -> None:
    room = read_room(write(tmp_path))
    write_room(room, tmp_path / "again.json")
    again = read_room(tmp_path / "again.json")
    assert again.floor_m == room.floor_m
    for one, other in zip(room.objects, again.objects, strict=True):
        assert (one.name, one.category, one.shape) == (other.name, other.category, other.shape)
        for part in ("size", "position", "rotation"):
            np.testing.assert_allclose(getattr(one, part), getattr(other, part), atol=1e-4)


def test_a_cloud_is_not_written(tmp_path: Path) -> None:
    cloud = SceneObject("cloud", "occluder", "points", points=np.eye(3))
    with pytest.raises(OutputError, match="npz"):
        write_room(Room((cloud,)), tmp_path / "room.json")
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("change", "told"),
    [
        ({"category": "chair"}, 'use "sittable"'),
        ({"category": "tabel"}, 'use "table"'),
        ({"category": "zzz"}, "use one of whiteboard"),
        ({"size": [160, 80, 74]}, "160 x 80 x 74 m; expected metres"),
        ({"size": [1.6, 0.8, 0]}, "above 0"),
        ({"size": [1.6, 0.8]}, "list of 3 numbers"),
        ({"size": [1.6, 0.8, "0.7"]}, "expected a number"),
        ({"position": [2, 1, True]}, "expected a number"),
        ({"position": [2]}, "list of 2 or 3 numbers"),
        ({"position": [1e9, 1]}, "at most 10000"),
        ({"shape": "points"}, "use box or cylinder"),
        ({"shape": "cylinder"}, "two diameters"),
        ({"yaw": 10}, 'has an entry "yaw"'),
        ({"name": None}, "texts as name"),
    ],
)
def test_an_object_that_cannot_be(tmp_path: Path, change: dict[str, object], told: str) -> None:
    with pytest.raises(FormatError, match=told) as error:
        read_room(write(tmp_path, objects=[STOOL, {**TABLE, **change}]))
    assert "object 2" in str(error.value)


@pytest.mark.parametrize(
    ("change", "told"),
    [
        ({"schema": "motioncast.room/2"}, "expected"),
        ({"floor_m": "0"}, "expected a number"),
        ({"floor_m": None}, 'no "floor_m"'),
        ({"objects": {}}, "must be a list"),
        ({"objects": [7]}, "object 1 is 7"),
        ({"objects": [{"name": "table"}]}, "has no category"),
        ({"walls": []}, 'has an entry "walls"'),
    ],
)
def test_a_room_that_cannot_be(tmp_path: Path, change: dict[str, object], told: str) -> None:
    with pytest.raises(FormatError, match=told):
        read_room(write(tmp_path, **change))


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("{", "is not JSON"),
        ("[]", "schema"),
        ("[" * 100_000, "expected a room"),
        ('{"schema": "motioncast.room/1", "floor_m": NaN, "objects": []}', "no number"),
        ('{"schema": "motioncast.room/1", "objects": [], "objects": []}', "more than once"),
    ],
)
def test_a_text_that_is_no_room(tmp_path: Path, text: str, told: str) -> None:
    (tmp_path / "room.json").write_text(text)
    with pytest.raises(FormatError, match=told):
        read_room(tmp_path / "room.json")


def test_no_file() -> None:
    with pytest.raises(InputError, match="there is no file"):
        read_room("nowhere.json")


JSON = st.recursive(
    st.none() | st.booleans() | st.floats() | st.integers() | st.text(max_size=5),
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(st.sampled_from([*STOOL, "x"]), inner, max_size=4),
)


@given(key=st.sampled_from(list(STOOL)), value=JSON)
def test_whatever_stands_in_an_entry_is_read_or_refused(tmp_path_factory, key: str, value: object) -> None:
    path = write(tmp_path_factory.mktemp("room"), objects=[{**STOOL, key: value}])
    try:
        (thing,) = read_room(path).objects
    except FormatError:
        return
    assert np.isfinite(thing.position).all()
