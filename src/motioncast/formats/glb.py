"""GLB (binary glTF 2.0) out: one file of a whole scene, an armature with a plain bone mesh a person.

Layout, so that Blender, three.js and game engines read each person as one armature with one action:

- The root node ``z up`` turns the world into glTF's y up; in it a node a person, in that the joints' nodes.
- Each joint that turns has a rotation channel; the first joint and those that slide (``core.kinematics``)
  have a translation channel. The nodes themselves stand in the rest pose, feet on the floor.
- A person's mesh is one octahedron a bone in the rest pose, skinned to the joint that turns the bone. Its
  node stands at the root of the scene, since its own place has no meaning.
- Someone who is not there has the scale 0 in those frames; glTF's core has no other way to hide a node.

Specification: Khronos Group, glTF 2.0, version 2.0.1 (2021).
"""

from __future__ import annotations

import json
import struct
from pathlib import Path
from typing import Any

import numpy as np

from motioncast.core import kinematics, rotation
from motioncast.core.scene import Scene
from motioncast.formats.files import atomic_write

suffixes = (".glb",)

COLOURS = (
    (0.10, 0.45, 0.90), (0.93, 0.40, 0.13), (0.16, 0.63, 0.35), (0.70, 0.25, 0.68),
    (0.85, 0.65, 0.05), (0.05, 0.62, 0.68), (0.80, 0.18, 0.28), (0.45, 0.40, 0.85),
)  # fmt: skip
"""Linear red, green and blue of the people, in turn."""

_FLOAT, _USHORT, _UBYTE = 5126, 5123, 5121
_VERTICES, _INDICES = 34962, 34963
_TYPES = {(): "SCALAR", (3,): "VEC3", (4,): "VEC4", (4, 4): "MAT4"}


def write_glb(scene: Scene, path: str | Path) -> Path:
    """Writes a scene with all its people; rotations are fitted where it has none.

    Returns:
        The path.

    Raises:
        OutputError: If the file cannot be written.
    """
    content = encode_glb(scene)
    with atomic_write(path) as temporary:
        temporary.write_bytes(content)
    return Path(path)


def encode_glb(scene: Scene) -> bytes:
    """The bytes of the GLB file of a scene."""
    if scene.rotations is None or scene.offsets is None:
        scene = kinematics.fit_rotations(scene)
    file = _File()
    file.json["asset"] = {"version": "2.0", "generator": "motioncast"}
    half = float(np.sqrt(0.5))
    world = file.add("nodes", {"name": "z up", "rotation": [-half, 0.0, 0.0, half]})
    animation: dict[str, Any] = {"name": "motion", "channels": [], "samplers": []}
    times = file.accessor((np.arange(scene.frames) / scene.fps).astype(np.float32), bounds=True)
    places = kinematics.local_places(scene)
    slides = kinematics.sliding(scene, places)
    people, meshes = [], []
    for person in range(len(scene.people)):
        node, mesh = _person(file, scene, person, places[:, person], slides, times, animation)
        people.append(node)
        meshes.append(mesh)
    if people:
        file.json["nodes"][world]["children"] = people
    file.json["scenes"] = [{"nodes": [world, *meshes]}]
    file.json["scene"] = 0
    if animation["channels"]:
        file.json["animations"] = [animation]
    return file.encode()


class _File:
    """The JSON and the binary part, as they grow."""

    def __init__(self) -> None:
        self.json: dict[str, Any] = {}
        self.data = bytearray()

    def add(self, kind: str, entry: dict[str, Any]) -> int:
        """Appends an entry to one of glTF's lists and returns its index."""
        entries = self.json.setdefault(kind, [])
        entries.append(entry)
        return len(entries) - 1

    def accessor(
        self, array: np.ndarray, target: int | None = None, bounds: bool = False, normalised: bool = False
    ) -> int:
        """Appends an array ``(count, ...)`` and returns the index of its accessor."""
        kinds = {"float32": _FLOAT, "uint16": _USHORT, "uint8": _UBYTE}
        view: dict[str, Any] = {"buffer": 0, "byteOffset": len(self.data), "byteLength": array.nbytes}
        if target is not None:
            view["target"] = target
        self.data += array.astype(array.dtype.newbyteorder("<")).tobytes()
        self.data += bytes(-len(self.data) % 4)
        entry: dict[str, Any] = {
            "bufferView": self.add("bufferViews", view),
            "componentType": kinds[array.dtype.name],
            "count": len(array),
            "type": _TYPES[array.shape[1:]],
        }
        if bounds:
            entry["min"] = np.atleast_1d(array.min(0)).tolist()
            entry["max"] = np.atleast_1d(array.max(0)).tolist()
        if normalised:
            entry["normalized"] = True
        return self.add("accessors", entry)

    def encode(self) -> bytes:
        """The whole file: header, JSON chunk, binary chunk."""
        self.json["buffers"] = [{"byteLength": len(self.data)}]
        text = json.dumps(self.json, separators=(",", ":"), ensure_ascii=False, allow_nan=False).encode()
        text += b" " * (-len(text) % 4)
        chunks = struct.pack("<II", len(text), 0x4E4F534A) + text
        chunks += struct.pack("<II", len(self.data), 0x004E4942) + bytes(self.data)
        return struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks


def _person(
    file: _File,
    scene: Scene,
    person: int,
    places: np.ndarray,
    slides: np.ndarray,
    times: int,
    animation: dict[str, Any],
) -> tuple[int, int]:
    """Adds a person; returns the nodes of the armature and of the mesh."""
    assert scene.rotations is not None
    assert scene.offsets is not None
    name, skeleton = scene.people[person], scene.skeleton
    offsets = scene.offsets[person].astype(np.float64)
    offsets[0] = 0
    rest = _rest_positions(offsets, skeleton.parents)
    offsets[0, 2] = -rest[:, 2].min()
    rest[:, 2] += offsets[0, 2]
    first = len(file.json["nodes"])
    for joint, joint_name in enumerate(skeleton.names):
        file.add("nodes", {"name": joint_name, "translation": offsets[joint].tolist()})
    for joint, parent in enumerate(skeleton.parents):
        if joint:
            file.json["nodes"][first + max(parent, 0)].setdefault("children", []).append(first + joint)
    armature = file.add("nodes", {"name": name, "children": [first]})

    def animate(node: int, channel: str, values: np.ndarray, interpolation: str = "LINEAR") -> None:
        output = file.accessor(np.ascontiguousarray(values, np.float32))
        animation["samplers"].append({"input": times, "output": output, "interpolation": interpolation})
        target = {"node": node, "path": channel}
        animation["channels"].append({"sampler": len(animation["samplers"]) - 1, "target": target})

    turns = rotation.normalise(scene.rotations[:, person].astype(np.float64))
    for joint in range(len(skeleton) if scene.frames else 0):
        if joint == 0 or slides[joint]:
            animate(first + joint, "translation", places[:, joint])
        if joint == 0 or not np.allclose(turns[:, joint], rotation.IDENTITY, atol=1e-6):
            animate(first + joint, "rotation", np.roll(turns[:, joint], -1, -1))  # wxyz to xyzw
    there = np.any(scene.observed[:, person], -1)
    if not there.all():
        animate(armature, "scale", np.repeat(there[:, None], 3, 1), "STEP")

    inverse_binds = np.tile(np.eye(4, dtype=np.float32), (len(skeleton), 1, 1))
    inverse_binds[:, 3, :3] = -rest  # glTF stores matrices column by column
    joints = list(range(first, first + len(skeleton)))
    binds = file.accessor(inverse_binds)
    rig = {"name": name, "joints": joints, "skeleton": first, "inverseBindMatrices": binds}
    skin = file.add("skins", rig)
    mesh = _mesh(file, rest, skeleton.parents, f"{name} bones", COLOURS[person % len(COLOURS)])
    return armature, file.add("nodes", {"name": f"{name} bones", "mesh": mesh, "skin": skin})


def _rest_positions(offsets: np.ndarray, parents: tuple[int, ...]) -> np.ndarray:
    still = np.tile(rotation.IDENTITY, (1, 1, len(parents), 1))
    return kinematics.forward(still, np.zeros((1, 1, 3)), offsets[None], parents)[0, 0]


def _mesh(
    file: _File, rest: np.ndarray, parents: tuple[int, ...], name: str, colour: tuple[float, float, float]
) -> int:
    """Octahedra: a slim one along each bone, which its start turns, a small one at each end of the tree."""
    shapes, owners = [], []
    for joint, parent in enumerate(parents):
        start = rest[max(parent, 0)]
        length = float(np.linalg.norm(rest[joint] - start))
        if length > 1e-6:
            shapes.append(_octahedron(start, rest[joint]))
            owners.append(max(parent, 0))
        if joint not in parents:
            below = np.array([0, 0, 0.015])
            shapes.append(_octahedron(rest[joint] - below, rest[joint] + below))
            owners.append(joint)
    corners = np.concatenate(shapes).astype(np.float32)
    bound = np.zeros((len(corners), 4), np.uint16)
    bound[:, 0] = np.repeat(owners, 6)
    weights = np.zeros((len(corners), 4), np.uint8)
    weights[:, 0] = 255
    faces = (np.arange(len(shapes))[:, None, None] * 6 + _FACES).reshape(-1)
    primitive = {
        "attributes": {
            "POSITION": file.accessor(corners, _VERTICES, bounds=True),
            "JOINTS_0": file.accessor(bound, _VERTICES),
            "WEIGHTS_0": file.accessor(weights, _VERTICES, normalised=True),
        },
        "indices": file.accessor(faces.astype(np.uint16), _INDICES),
        "material": file.add(
            "materials",
            {
                "name": name,
                "pbrMetallicRoughness": {
                    "baseColorFactor": [*colour, 1.0], "metallicFactor": 0.0, "roughnessFactor": 0.7
                },
            },
        ),
    }  # fmt: skip
    return file.add("meshes", {"name": name, "primitives": [primitive]})


_FACES = np.array([[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 4, 1], [5, 2, 1], [5, 3, 2], [5, 4, 3], [5, 1, 4]])
"""Corners of an octahedron's faces, anticlockwise from outside; without normals faces are flat by default."""


def _octahedron(start: np.ndarray, end: np.ndarray) -> np.ndarray:
    """Corners ``(6, 3)``: the start, four about a fifth of the way, the end."""
    bone = end - start
    across = np.cross(bone, np.eye(3)[np.abs(bone).argmin()])
    across *= 0.1 * np.linalg.norm(bone) / np.linalg.norm(across)
    beside = np.cross(across, bone) / np.linalg.norm(bone)
    middle = start + 0.2 * bone
    return np.array([start, middle + across, middle + beside, middle - across, middle - beside, end])
