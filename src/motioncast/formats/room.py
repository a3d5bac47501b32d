"""Rooms from files: JSON written by hand, or a GLB whose nodes are named.

The JSON (``motioncast.room/1``) holds ``floor_m`` and ``objects``, each with ``name``, ``category``, ``shape`` (box or
cylinder), ``size`` (three lengths; of a cylinder diameter, diameter, height), ``position`` (its middle, or x and y of
what stands on the floor) and ``yaw_deg`` (its turn about the vertical, anticlockwise). Metres, z up.
"""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

import numpy as np

from motioncast.core.categories import closest_category
from motioncast.core.room import Room
from motioncast.core.rotation import from_axis_angle, rotate
from motioncast.core.scene_object import CATEGORIES, LARGEST_M, SceneObject
from motioncast.errors import FormatError, InputError, OutputError
from motioncast.formats.files import atomic_write, read_bytes, read_text
from motioncast.formats.room_glb import read_room_glb

SCHEMA = "motioncast.room/1"

MOST_BYTES = 1 << 22
MOST_OBJECTS = 1000
FARTHEST_M = 10_000.0

NEEDED = ("name", "category", "size", "position")
OPTIONAL = {"shape": "box", "yaw_deg": 0.0}


def read_room(path: str | Path) -> Room:
    """The room in a JSON or GLB file.

    Raises:
        InputError: If there is no such file.
        FormatError: If it is damaged, or an object in it cannot be.
    """
    if read_bytes(path, 4) == b"glTF":
        return read_room_glb(path)
    try:
        room = json.loads(read_text(path, MOST_BYTES), parse_constant=_refuse, object_pairs_hook=_once)
    except json.JSONDecodeError as error:
        raise FormatError(
            path, f"is not JSON ({error.msg}); expected a room as in docs/formats.md", error.lineno
        ) from None
    except (ValueError, RecursionError) as error:
        raise FormatError(path, f"{error}; expected a room as in docs/formats.md") from None
    if not isinstance(room, dict) or room.get("schema") != SCHEMA:
        found = room.get("schema") if isinstance(room, dict) else None
        raise FormatError(path, f'has the schema "{found}"; expected "{SCHEMA}"')
    _known(path, "the room", room, ("schema", "floor_m", "objects"))
    floor = None if room.get("floor_m") is None else _number(path, "floor_m", room["floor_m"])
    entries = room.get("objects")
    if not isinstance(entries, list) or len(entries) > MOST_OBJECTS:
        raise FormatError(path, f'the entry "objects" must be a list of at most {MOST_OBJECTS} objects')
    return Room(tuple(_object(path, number, entry, floor) for number, entry in enumerate(entries, 1)), floor)


def write_room(room: Room, path: str | Path) -> None:
    """Writes a room of boxes and cylinders that stand upright and still, as JSON.

    Raises:
        OutputError: If it cannot be written, or an object is a cloud or a mesh, moves, or is tilted.
    """
    entries = []
    for thing in room.objects:
        across, up = (rotate(thing.rotation, axis) for axis in np.eye(3)[[0, 2]])
        if thing.points is not None or thing.moves or np.linalg.norm(up - [0, 0, 1]) > 1e-3:
            raise OutputError(
                f'cannot write {path}: "{thing.name}" is not a box or cylinder that stands upright and still; '
                "save the scene as npz"
            )
        entries.append(
            {
                "name": thing.name, "category": thing.category, "shape": thing.shape,
                "size": _rounded(thing.size), "position": _rounded(thing.position),
                "yaw_deg": round(math.degrees(math.atan2(across[1], across[0])), 4),
            }
        )  # fmt: skip
    text = json.dumps({"schema": SCHEMA, "floor_m": room.floor_m, "objects": entries}, indent=1, ensure_ascii=False)
    with atomic_write(path) as temporary:
        temporary.write_text(text + "\n", encoding="utf-8", newline="\n")


def _object(path: str | Path, number: int, entry: Any, floor: float | None) -> SceneObject:
    called = f"object {number}"
    if not isinstance(entry, dict):
        raise FormatError(path, f"{called} is {entry!r:.40}; expected an entry with {', '.join(NEEDED)}")
    if isinstance(entry.get("name"), str):
        called += f' ("{entry["name"]:.40}")'
    _known(path, called, entry, (*NEEDED, *OPTIONAL))
    for key in NEEDED:
        if key not in entry:
            raise FormatError(path, f"{called} has no {key}; give {', '.join(NEEDED)}")
    entry = {**OPTIONAL, **entry}
    if not all(isinstance(entry[key], str) for key in ("name", "category", "shape")):
        raise FormatError(path, f"{called} needs texts as name, category and shape")
    category = entry["category"]
    if category not in CATEGORIES:
        close = closest_category(category)
        advice = f'use "{close}"' if close else f"use one of {', '.join(CATEGORIES)}"
        raise FormatError(path, f'{called} has the category "{category}", which is unknown; {advice}')
    if entry["shape"] not in ("box", "cylinder"):
        raise FormatError(path, f'{called} has the shape "{entry["shape"]}"; use box or cylinder')
    size = _numbers(path, f"the size of {called}", entry["size"], (3,))
    if min(size) <= 0 or max(size) > LARGEST_M:
        told = " x ".join(f"{length:g}" for length in size)
        raise FormatError(path, f"{called} measures {told} m; expected metres, above 0 and at most {LARGEST_M:g}")
    if entry["shape"] == "cylinder" and size[0] != size[1]:
        raise FormatError(path, f"{called} is a cylinder of two diameters; give diameter, the same again, and height")
    position = _numbers(path, f"the position of {called}", entry["position"], (2, 3))
    if len(position) == 2:
        if floor is None:
            raise FormatError(path, f'{called} stands on the floor, and the room has no "floor_m"; add it')
        position.append(floor + size[2] / 2)
    yaw = math.radians(_number(path, f"yaw_deg of {called}", entry["yaw_deg"]))
    turn = from_axis_angle(np.array([0, 0, yaw]))
    try:
        return SceneObject(entry["name"], category, entry["shape"], np.array(size), np.array(position), turn)
    except InputError as error:
        raise FormatError(path, str(error)) from None


def _known(path: str | Path, called: str, entry: dict[str, Any], keys: tuple[str, ...]) -> None:
    for key in entry:
        if key not in keys:
            raise FormatError(path, f'{called} has an entry "{key:.40}"; known are {", ".join(keys)}')


def _numbers(path: str | Path, called: str, value: Any, counts: tuple[int, ...]) -> list[float]:
    if not isinstance(value, list) or len(value) not in counts:
        raise FormatError(
            path, f"{called} is {value!r:.40}; expected a list of {' or '.join(map(str, counts))} numbers"
        )
    return [_number(path, called, part) for part in value]


def _number(path: str | Path, called: str, value: Any) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float) or abs(value) > FARTHEST_M:
        raise FormatError(path, f"{called} holds {value!r:.40}; expected a number of at most {FARTHEST_M:g}")
    return float(value)


def _rounded(values: np.ndarray) -> list[float]:
    return [round(float(value), 4) for value in values]


def _refuse(constant: str) -> None:
    raise ValueError(f"holds {constant}, which is no number")


def _once(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    entry = dict(pairs)
    if len(entry) < len(pairs):
        raise ValueError(f"names {', '.join(sorted({key for key, _ in pairs}))} more than once in one entry")
    return entry
