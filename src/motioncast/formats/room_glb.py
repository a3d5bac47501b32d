"""Rooms from GLB (binary glTF 2.0): nodes whose names carry a category, such as ``table.001`` or ``chair_2``.

A named node is one thing with everything below it that has no other category. A node called ``floor`` or
``ground`` gives the floor's height; others are left out, with a remark. A thing of at most ``MOST_TRIANGLES`` stays a
mesh; a finer one, and one that is a plain box, becomes the box around it, turned like its node. Only what the file
itself holds is read: no compressed and no external buffers.

Specification: Khronos Group, glTF 2.0, version 2.0.1 (2021).
"""

from __future__ import annotations

import json
import re
import struct
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from motioncast.core.categories import category_of
from motioncast.core.room import Room
from motioncast.core.rotation import from_matrix, normalise, rotate, to_matrix
from motioncast.core.scene_object import SceneObject
from motioncast.errors import FormatError, InputError
from motioncast.formats.files import read_bytes

MOST_BYTES = 1 << 27
MOST_NODES = 20_000
MOST_IN_ALL = 2_000_000
MOST_TRIANGLES = 2000

FLOOR = "floor"
FLOORS = (FLOOR, "ground")
TURN = np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]])
"""glTF's y up to z up."""

_FLOAT, _TRIANGLES = 5126, 4
_INDICES = {5121: np.dtype("u1"), 5123: np.dtype("<u2"), 5125: np.dtype("<u4")}


def read_room_glb(path: str | Path) -> Room:
    """The things of a GLB file.

    Raises:
        InputError: If there is no such file.
        FormatError: If it is damaged, compressed, needs other files, or names nothing.
    """
    things, floors, others = [], [], []
    try:
        with np.errstate(all="ignore"):  # what is not finite in the end is refused
            for name, kind, world, triangles in _Glb(path, *_chunks(path)).parts():
                if kind == FLOOR:
                    floors.append(float(triangles[..., 2].max()))
                elif kind:
                    things.append(_thing(name, kind, world, triangles))
                else:
                    others.append(name)
    except (KeyError, IndexError, TypeError, ValueError, AttributeError, OverflowError) as error:
        # a file that is not as specified fails in a hundred places; all mean one thing
        raise FormatError(
            path, f"is not as glTF 2.0 specifies ({type(error).__name__}: {error}); export it again"
        ) from None
    except FormatError:
        raise
    except InputError as error:
        raise FormatError(path, str(error)) from None
    if not things:
        raise FormatError(
            path, "has no mesh whose node's name carries a category; call nodes table.001, chair_2, whiteboard, wall"
        )
    left = f"{Path(path).name}: left out, since their names carry no category: {', '.join(others)[:200]}"
    return Room(tuple(things), max(floors, default=None), (left,) if others else ())


def _chunks(path: str | Path) -> tuple[dict[str, Any], bytes]:
    """The JSON and the binary chunk."""
    content = read_bytes(path, MOST_BYTES + 1)
    if len(content) > MOST_BYTES:
        raise FormatError(path, f"is larger than {MOST_BYTES >> 20} MiB, the most that is read; leave textures out")
    if len(content) < 20 or struct.unpack_from("<4sII", content) != (b"glTF", 2, len(content)):
        raise FormatError(path, "is no whole GLB file of glTF 2.0; export it again")
    chunks: dict[bytes, bytes] = {}
    place = 12
    while place + 8 <= len(content):
        length, kind = struct.unpack_from("<I4s", content, place)
        chunks.setdefault(kind, content[place + 8 : place + 8 + length])
        place += 8 + length
    try:
        about = json.loads(chunks[b"JSON"])
    except RecursionError:
        raise FormatError(path, "holds entries within entries without end; export it again") from None
    if not isinstance(about, dict):
        raise FormatError(path, "holds no JSON object; export it again")
    if about.get("extensionsRequired"):
        needed = ", ".join(map(str, about["extensionsRequired"]))[:80]
        raise FormatError(path, f"needs {needed}; export it without compression")
    return about, chunks.get(b"BIN\0", b"")


class _Glb:
    """Nodes and meshes of a file; every index and length is checked before it is followed."""

    def __init__(self, path: str | Path, about: dict[str, Any], data: bytes) -> None:
        self.path, self.about, self.data = path, about, data

    def entry(self, kind: str, index: int) -> dict[str, Any]:
        entries = self.about[kind]
        if type(index) is not int or not 0 <= index < len(entries):
            raise FormatError(self.path, f"speaks of {kind} {index!r:.20} and has {len(entries)}; export it again")
        return entries[index]

    def parts(self) -> Iterator[tuple[str, str, np.ndarray, np.ndarray]]:
        """Name, category, matrix and world triangles ``(m, 3, 3)``, z up, of each thing; the category may be empty."""
        whole = np.eye(4)
        whole[:3, :3] = TURN
        nodes = self.entry("scenes", self.about.get("scene", 0)).get("nodes", [])
        waiting = [(index, whole, -1, "") for index in reversed(nodes)]
        things: dict[int, tuple[str, str, np.ndarray, list[np.ndarray]]] = {}
        visits = triangles = 0
        while waiting:
            index, above, owner, kind = waiting.pop()
            node = self.entry("nodes", index)
            name, world = str(node.get("name", f"node {index}")), above @ _matrix(node)
            own = _kind(name)
            if own and own != kind:
                owner, kind = index, own
            if "mesh" in node:
                pieces = things.setdefault(owner if kind else index, (name, kind, world, []))[3]
                local = self.triangles(self.entry("meshes", node["mesh"]))
                pieces.append(local @ world[:3, :3].T + world[:3, 3])
                triangles += len(local)
            waiting += [(child, world, owner, kind) for child in reversed(node.get("children", []))]
            visits += 1
            if visits > MOST_NODES or triangles > MOST_IN_ALL:
                raise FormatError(
                    self.path, f"has more than {MOST_NODES} nodes or {MOST_IN_ALL} triangles, or a circle; simplify it"
                )
        for name, kind, world, pieces in things.values():
            if sum(map(len, pieces)):
                yield name, kind, world, np.concatenate(pieces)

    def triangles(self, mesh: dict[str, Any]) -> np.ndarray:
        """Corners of a mesh's triangles in its own frame, ``(m, 3, 3)``; lines and points are left out."""
        found = [np.zeros((0, 3, 3))]
        for primitive in mesh["primitives"]:
            if primitive.get("mode", _TRIANGLES) != _TRIANGLES:
                continue
            corners = self.numbers(primitive["attributes"]["POSITION"], "VEC3")
            if "indices" in primitive:
                corners = corners[self.numbers(primitive["indices"], "SCALAR")[:, 0]]
            found.append(corners[: len(corners) // 3 * 3].reshape(-1, 3, 3))
        triangles = np.concatenate(found)
        if not np.isfinite(triangles).all():
            raise FormatError(self.path, "has corners that are not finite numbers; export it again")
        return triangles

    def numbers(self, index: int, kind: str) -> np.ndarray:
        """The numbers of an accessor, ``(count, width)``."""
        accessor = self.entry("accessors", index)
        width = {"VEC3": 3, "SCALAR": 1}[kind]
        dtype = np.dtype("<f4") if kind == "VEC3" else _INDICES[accessor["componentType"]]
        if accessor["type"] != kind or "sparse" in accessor or (kind == "VEC3" and accessor["componentType"] != _FLOAT):
            raise FormatError(
                self.path, f"has an accessor {index} that is not plain {kind}; export it without compression"
            )
        view = self.entry("bufferViews", accessor["bufferView"])
        if view["buffer"] != 0 or "uri" in self.entry("buffers", 0):
            raise FormatError(self.path, "keeps its numbers in another file; export it as one GLB")
        start, count = view.get("byteOffset", 0) + accessor.get("byteOffset", 0), accessor["count"]
        stride = view.get("byteStride", width * dtype.itemsize)
        end = start + (count - 1) * stride + width * dtype.itemsize
        if (
            min(start, accessor.get("byteOffset", 0), count - 1) < 0
            or stride < width * dtype.itemsize
            or end > len(self.data)
        ):
            raise FormatError(self.path, f"has an accessor {index} beyond its data; export it again")
        return np.ndarray((count, width), dtype, self.data, start, (stride, dtype.itemsize)).astype(
            np.float64 if kind == "VEC3" else np.int64
        )


def _kind(name: str) -> str:
    """The category that a node's name carries, ``FLOOR``, or nothing."""
    return category_of(name) or (FLOOR if re.split(r"[^a-z]", name.lower())[0] in FLOORS else "")


def _matrix(node: dict[str, Any]) -> np.ndarray:
    """A node's own matrix ``(4, 4)``."""
    if "matrix" in node:
        return np.array(node["matrix"], np.float64).reshape(4, 4).T  # column by column
    matrix = np.eye(4)
    x, y, z, w = node.get("rotation", (0, 0, 0, 1))
    matrix[:3, :3] = to_matrix(normalise(np.array([w, x, y, z], np.float64))) * np.array(node.get("scale", (1, 1, 1)))
    matrix[:3, 3] = node.get("translation", (0, 0, 0))
    return matrix


def _thing(name: str, category: str, world: np.ndarray, triangles: np.ndarray) -> SceneObject:
    """A mesh, or the box around it, in a frame turned like its node; z of the frame is up where the node stands."""
    axes = world[:3, :3] @ TURN.T  # of a node that is not turned, the world's own
    lengths = np.linalg.norm(axes, axis=0)
    rotation = np.array([1.0, 0, 0, 0])
    axes = axes / np.maximum(lengths, 1e-9)
    if lengths.min() > 1e-9 and np.allclose(axes.T @ axes, np.eye(3), atol=1e-3) and np.linalg.det(axes) > 0:
        rotation = from_matrix(axes)
    local = rotate(rotation * [1, -1, -1, -1], triangles)
    low, high = local.min((0, 1)), local.max((0, 1))
    middle, size = (low + high) / 2, high - low
    place = rotate(rotation, middle)
    corners, faces = np.unique((local - middle).reshape(-1, 3).round(5), axis=0, return_inverse=True)
    if len(triangles) > MOST_TRIANGLES or np.allclose(np.abs(corners), size / 2, atol=1e-3):
        return SceneObject(name, category, "box", size, place, rotation)
    return SceneObject(
        name, category, "mesh", position=place, rotation=rotation, points=corners, faces=faces.reshape(-1, 3)
    )
