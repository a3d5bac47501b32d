from __future__ import annotations

import json
import shutil
import struct
import subprocess
from pathlib import Path

import numpy as np
import pytest

from motioncast.core import rotation
from motioncast.core.kinematics import fit_rotations
from motioncast.core.scene import Scene
from motioncast.core.skeleton import Skeleton
from motioncast.errors import OutputError
from motioncast.formats.glb import encode_glb, write_glb

TYPES = {5126: np.dtype("<f4"), 5123: np.dtype("<u2"), 5121: np.dtype("u1")}
REST = {"translation": [0, 0, 0], "rotation": [0, 0, 0, 1], "scale": [1, 1, 1]}
WIDTH = {"SCALAR": 1, "VEC3": 3, "VEC4": 4, "MAT4": 16}


class Reader:
    """A strict reader of its own, written from the specification."""

    def __init__(self, content: bytes) -> None:
        magic, version, length = struct.unpack_from("<4sII", content)
        assert (magic, version, length) == (b"glTF", 2, len(content))
        size, kind = struct.unpack_from("<II", content, 12)
        assert kind == 0x4E4F534A
        assert size % 4 == 0
        self.json = json.loads(content[20 : 20 + size])
        binary, kind = struct.unpack_from("<II", content, 20 + size)
        assert kind == 0x004E4942
        self.data = content[28 + size :]
        assert len(self.data) == binary == self.json["buffers"][0]["byteLength"]

    def array(self, index: int) -> np.ndarray:
        accessor = self.json["accessors"][index]
        view = self.json["bufferViews"][accessor["bufferView"]]
        dtype, width = TYPES[accessor["componentType"]], WIDTH[accessor["type"]]
        assert view["byteLength"] == accessor["count"] * width * dtype.itemsize
        values = np.frombuffer(self.data, dtype, accessor["count"] * width, view["byteOffset"])
        values = values.reshape(accessor["count"], width)
        if "min" in accessor:
            np.testing.assert_allclose(accessor["min"], values.min(0), rtol=1e-6)
            np.testing.assert_allclose(accessor["max"], values.max(0), rtol=1e-6)
        return values

    def world(self, frames: int) -> dict[int, np.ndarray]:
        """World matrix of every node, ``(frames, 4, 4)``, the animation sampled at its keys."""
        parts = {}
        for index, node in enumerate(self.json["nodes"]):
            for channel, default in REST.items():
                parts[index, channel] = np.tile(np.array(node.get(channel, default), float), (frames, 1))
        for animation in self.json.get("animations", []):
            for channel in animation["channels"]:
                sampler = animation["samplers"][channel["sampler"]]
                values = self.array(sampler["output"])
                assert len(values) == len(self.array(sampler["input"])) == frames
                parts[channel["target"]["node"], channel["target"]["path"]] = values.astype(float)
        matrices: dict[int, np.ndarray] = {}

        def descend(index: int, above: np.ndarray) -> None:
            local = np.tile(np.eye(4), (frames, 1, 1))
            turn = rotation.to_matrix(np.roll(parts[index, "rotation"], 1, -1))
            local[:, :3, :3] = turn * parts[index, "scale"][:, None, :]
            local[:, :3, 3] = parts[index, "translation"]
            matrices[index] = above @ local
            for child in self.json["nodes"][index].get("children", []):
                descend(child, matrices[index])

        for index in self.json["scenes"][self.json["scene"]]["nodes"]:
            descend(index, np.tile(np.eye(4), (frames, 1, 1)))
        return matrices


def joints(reader: Reader, scene: Scene) -> np.ndarray:
    """Positions of the scene's joints in metres, z up, ``(time, people, joints, 3)``."""
    matrices = reader.world(scene.frames)
    people = []
    for skin in reader.json["skins"]:
        names = {reader.json["nodes"][node]["name"]: node for node in skin["joints"]}
        people.append(np.stack([matrices[names[name]][:, :3, 3] for name in scene.skeleton.names], 1))
    x, y, z = np.moveaxis(np.stack(people, 1), -1, 0)
    return np.stack([x, -z, y], -1)


def apart(content: bytes, scene: Scene) -> float:
    found = joints(Reader(content), scene)
    return float(np.linalg.norm(found - scene.positions, axis=-1)[scene.observed].max())


def test_joints_are_where_the_scene_has_them(walkers):
    assert apart(encode_glb(walkers), walkers) < 0.01
    fitted = fit_rotations(walkers)
    assert apart(encode_glb(fitted), fitted) < 0.001


def test_people_who_are_absent_shrink_to_nothing(walkers):
    observed = walkers.observed.copy()
    observed[:20, 0] = observed[40:, 0] = False
    scene = Scene(walkers.positions, walkers.skeleton, walkers.fps, observed, walkers.people)
    reader = Reader(encode_glb(scene))
    assert apart(encode_glb(scene), scene) < 0.01
    node = [node.get("name") for node in reader.json["nodes"]].index("ada")
    scale = np.linalg.norm(reader.world(60)[node][:, 0, :3], axis=-1)
    np.testing.assert_array_equal(scale > 0.5, observed[:, 0, 0])


def test_the_clock_starts_at_zero_and_runs_at_the_scenes_rate(walkers):
    reader = Reader(encode_glb(walkers))
    inputs = {sampler["input"] for sampler in reader.json["animations"][0]["samplers"]}
    assert len(inputs) == 1
    np.testing.assert_allclose(reader.array(inputs.pop())[:, 0], np.arange(60) / 30, atol=1e-6)


def test_the_bone_mesh_follows_the_joints(walkers):
    """Skinned by hand, the tips of the octahedra lie on the joints."""
    scene = fit_rotations(walkers)
    reader = Reader(encode_glb(scene))
    matrices = reader.world(scene.frames)
    skin = reader.json["skins"][1]
    attributes = reader.json["meshes"][1]["primitives"][0]["attributes"]
    corners, owners = reader.array(attributes["POSITION"]), reader.array(attributes["JOINTS_0"])[:, 0]
    assert (reader.array(attributes["WEIGHTS_0"]) == [255, 0, 0, 0]).all()
    binds = reader.array(skin["inverseBindMatrices"]).reshape(-1, 4, 4).transpose(0, 2, 1)
    whole = np.concatenate([corners, np.ones((len(corners), 1))], 1)
    frame = 17
    placed = [
        (matrices[skin["joints"][owner]][frame] @ binds[owner] @ corner)[:3]
        for owner, corner in zip(owners, whole, strict=True)
    ]
    x, y, z = np.transpose(placed)
    corners = np.stack([x, -z, y], -1)
    for joint in scene.positions[frame, 1]:
        assert np.linalg.norm(corners - joint, axis=-1).min() < 0.02


def test_each_person_has_a_colour_and_an_armature(walkers):
    document = Reader(encode_glb(walkers)).json
    surfaces = [material["pbrMetallicRoughness"] for material in document["materials"]]
    colours = {tuple(surface["baseColorFactor"]) for surface in surfaces}
    assert len(colours) == len(document["skins"]) == 2
    roots = document["scenes"][0]["nodes"]
    assert all(index in roots for index, node in enumerate(document["nodes"]) if "mesh" in node)


def test_a_single_joint_and_a_single_frame():
    scene = Scene(np.ones((1, 1, 1, 3)), Skeleton(("tag",), (-1,), ("",)), 30.0)
    assert apart(encode_glb(scene), scene) < 1e-6


def test_nothing_half_written(walkers, tmp_path):
    with pytest.raises(OutputError):
        write_glb(walkers, tmp_path / "nowhere" / "a.glb")
    assert not list(tmp_path.iterdir())
    assert write_glb(walkers, tmp_path / "a.glb").read_bytes()[:4] == b"glTF"


def test_khronos_validator_has_nothing_to_say(walkers, tmp_path):
    script, frontend = Path(__file__).with_name("validate_glb.mjs"), Path(__file__).parents[2] / "frontend"
    if shutil.which("node") is None or not (frontend / "node_modules" / "gltf-validator").is_dir():
        pytest.skip("needs node and: npm install --prefix frontend gltf-validator@2.0.0-dev.3.10")
    observed = walkers.observed.copy()
    observed[:20, 0] = False
    gone = Scene(walkers.positions, walkers.skeleton, walkers.fps, observed, walkers.people)
    single = Scene(np.ones((1, 1, 1, 3)), Skeleton(("tag",), (-1,), ("",)), 30.0)
    scenes = (walkers, gone, walkers[:1], single)
    paths = [write_glb(scene, tmp_path / f"{number}.glb") for number, scene in enumerate(scenes)]
    command = ["node", str(script), *map(str, paths)]
    done = subprocess.run(command, cwd=frontend, capture_output=True, text=True, check=True, timeout=60)
    for report in json.loads(done.stdout):
        assert report["messages"] == []
