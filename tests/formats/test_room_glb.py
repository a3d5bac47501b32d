"""Rooms from GLB: names, frames, floors; and files that are damaged, compressed or name nothing."""

from __future__ import annotations

import json
import struct
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from motioncast.errors import FormatError
from motioncast.formats.room import read_room

CUBE = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], np.float32) / 2
QUADS = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
FACES = np.array([face for a, b, c, d in QUADS for face in ((a, b, c), (a, c, d))], np.uint16)
WEDGE = CUBE * np.where(CUBE[:, 1:2] > 0, [0.5, 1, 1], 1).astype(np.float32)
HALF = float(np.sqrt(0.5))


def glb(nodes: list[dict[str, Any]], **more: Any) -> bytes:
    """A file with these nodes; mesh 0 is a cube of 1 m, mesh 1 one with a narrow top."""
    data = CUBE.tobytes() + WEDGE.tobytes() + FACES.tobytes()
    edges = [0, CUBE.nbytes, 2 * CUBE.nbytes, len(data)]
    about = {
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": nodes,
        "meshes": [{"primitives": [{"attributes": {"POSITION": mesh}, "indices": 2}]} for mesh in (0, 1)],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": 8, "type": "VEC3"},
            {"bufferView": 1, "componentType": 5126, "count": 8, "type": "VEC3"},
            {"bufferView": 2, "componentType": 5123, "count": 36, "type": "SCALAR"},
        ],
        "bufferViews": [
            {"buffer": 0, "byteOffset": start, "byteLength": end - start}
            for start, end in pairwise(edges)
        ],
        "buffers": [{"byteLength": len(data)}],
        **more,
    }  # fmt: skip
    return packed(about, data)


def packed(about: dict[str, Any], data: bytes) -> bytes:
    text = json.dumps(about).encode()
    text += b" " * (-len(text) % 4)
    chunks = struct.pack("<I4s", len(text), b"JSON") + text + struct.pack("<I4s", len(data), b"BIN\0") + data
    return struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks


def read(content: bytes, folder: Path) -> Any:
    (folder / "room.glb").write_bytes(content)
    return read_room(folder / "room.glb")


ROOM = [
    {"name": "Kitchen", "children": [1, 2, 3, 4, 5]},
    {"name": "table.001", "mesh": 0, "translation": [2, 0.4, -1], "scale": [1.6, 0.8, 0.7], "children": [6]},
    {"name": "chair_2", "mesh": 0, "translation": [0, 0.25, 0], "rotation": [0, HALF, 0, HALF], "scale": [1, 0.5, 0.4]},
    {"name": "Floor", "mesh": 0, "translation": [0, -0.5, 0], "scale": [9, 1, 9]},
    {"name": "Lamp", "mesh": 0},
    {"name": "Trash bin", "mesh": 1, "translation": [3, 0.5, 0]},
    {"name": "table leg", "mesh": 0, "translation": [0, -1, 0]},
]


def test_names_carry_categories_and_boxes_stand_z_up(tmp_path: Path) -> None:
    room = read(glb(ROOM), tmp_path)
    table, chair, bin_ = room.objects
    assert [thing.category for thing in room.objects] == ["table", "sittable", "trash"]
    assert [thing.name for thing in room.objects] == ["table.001", "chair_2", "Trash bin"]
    assert room.floor_m == pytest.approx(0.0, abs=1e-6)
    assert "Lamp" in room.remarks[0]
    np.testing.assert_allclose(table.size, [1.6, 0.7, 1.6], atol=1e-4, err_msg="its leg belongs to it")
    np.testing.assert_allclose(table.position, [2, 1, 0], atol=1e-4)
    np.testing.assert_allclose(chair.size, [1, 0.4, 0.5], atol=1e-4)
    np.testing.assert_allclose(chair.outward(np.array([1.0, 0, 0])), [0, 1, 0.25], atol=1e-4)
    assert (chair.shape, bin_.shape) == ("box", "mesh")
    assert bin_.corners[:, 2].min() == pytest.approx(0, abs=1e-4)
    np.testing.assert_allclose(bin_.outward(bin_.points).max(0), [3.5, 0.5, 1], atol=1e-4)


def test_a_thing_of_another_category_below_one_is_its_own(tmp_path: Path) -> None:
    nodes = [{"name": "counter", "mesh": 0, "children": [1]}, {"name": "sink", "mesh": 0, "translation": [0, 1, 0]}]
    room = read(glb(nodes), tmp_path)
    assert [thing.category for thing in room.objects] == ["cupboard", "sink"]
    assert room.floor_m is None


@pytest.mark.parametrize(
    ("content", "told"),
    [
        (b"glTF", "no whole GLB"),
        (glb(ROOM)[:-8], "no whole GLB"),
        (glb([{"name": "lamp", "mesh": 0}]), "no mesh whose node's name carries a category"),
        (glb([{"name": "table", "mesh": 7}]), "speaks of meshes 7"),
        (glb([{"name": "table", "mesh": 0, "children": [0]}]), "a circle"),
        (glb([{"name": "table", "mesh": 0, "scale": [100, 1, 1]}]), "measures 100 x 1 x 1 m"),
        (glb([{"name": "table", "mesh": 0, "scale": [1e300, 1e300, 1]}]), "not finite|measures"),
        (glb(ROOM, extensionsRequired=["KHR_draco_mesh_compression"]), "without compression"),
        (glb(ROOM, buffers=[{"uri": "room.bin", "byteLength": 8}]), "in another file"),
        (glb(ROOM, meshes=[{}, {}]), "not as glTF 2.0 specifies"),
    ],
)
def test_a_file_that_cannot_be_read(tmp_path: Path, content: bytes, told: str) -> None:
    with pytest.raises(FormatError, match=told):
        read(content, tmp_path)


@pytest.mark.parametrize(
    "change",
    [{"count": 10**12}, {"count": 0}, {"count": -8}, {"byteOffset": -4}, {"byteOffset": 10**9}, {"componentType": 5123},
     {"type": "VEC2"}, {"sparse": {}}, {"bufferView": "0"}],
)  # fmt: skip
def test_an_accessor_that_lies_is_not_followed(tmp_path: Path, change: dict[str, Any]) -> None:
    corners = {"bufferView": 0, "componentType": 5126, "count": 8, "type": "VEC3"}
    corner_indices = {"bufferView": 2, "componentType": 5123, "count": 36, "type": "SCALAR"}
    with pytest.raises(FormatError):
        read(glb(ROOM, accessors=[{**corners, **change}, corners, corner_indices]), tmp_path)


@given(place=st.integers(0, len(glb(ROOM)) - 1), byte=st.integers(0, 255))
def test_a_damaged_byte_is_read_or_refused(tmp_path_factory, place: int, byte: int) -> None:
    content = bytearray(glb(ROOM))
    content[place] = byte
    try:
        room = read(bytes(content), tmp_path_factory.mktemp("room"))
    except FormatError:
        return
    assert all(np.isfinite(thing.position).all() for thing in room.objects)
