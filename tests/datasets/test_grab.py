from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from motioncast.bodies import smpl
from motioncast.datasets import grab
from motioncast.errors import FormatError, InputError
from motioncast.testing.smpl import write_smpl


def write_ply(path: Path, vertices: np.ndarray, kind: str = "binary_little_endian") -> Path:
    path.parent.mkdir(parents=True, exist_ok=True)
    head = (
        f"ply\nformat {kind} 1.0\ncomment made up\nelement vertex {len(vertices)}\nproperty uchar red\n"
        "property float x\nproperty float y\nproperty float z\nelement face 1\n"
        "property list uchar int vertex_indices\nend_header\n"
    )
    rows = np.zeros(len(vertices), [("red", "u1"), ("x", "<f4"), ("y", "<f4"), ("z", "<f4")])
    for axis, column in zip("xyz", vertices.T, strict=True):
        rows[axis] = column
    text = "".join(f"0 {x:.7g} {y:.7g} {z:.7g}\n" for x, y, z in vertices).encode() + b"3 0 1 2\n"
    path.write_bytes(head.encode() + (text if kind == "ascii" else rows.tobytes() + b"\x03" + bytes(12)))
    return path


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """SMPL-X of few vertices, and person s1 who is 3 % larger than it."""
    model = smpl.load(write_smpl(tmp_path / "body_models" / "smplx" / "SMPLX_MALE.npz", "smplx"))
    monkeypatch.setattr(grab, "POINTS", {name: 60 + number for number, name in enumerate(grab.POINTS)})
    write_ply(tmp_path / "tools" / "subject_meshes" / "male" / "s1.ply", model.template * 1.03)
    grab._own_body.cache_clear()
    return tmp_path


def params(frames: int = 5) -> dict[str, np.ndarray]:
    poses = np.random.default_rng(0).normal(0, 0.2, (frames, 165)).astype(np.float32)
    poses[:, :3] = (np.pi / 2, 0, 0)
    return {
        "transl": np.full((frames, 3), (0, 1, 0.2), np.float32), "global_orient": poses[:, :3],
        "body_pose": poses[:, 3:66], "fullpose": poses, "left_hand_pose": np.zeros((frames, 24), np.float32),
    }  # fmt: skip


def put(folder: Path, body: object, name: str = "s1/cup_drink_1") -> Path:
    path = folder / "grab" / f"{name}.npz"
    path.parent.mkdir(parents=True, exist_ok=True)
    entries = {"gender": "male", "sbj_id": "s1", "n_frames": 5, "framerate": 120.0, "n_comps": 24, "body": body}
    np.savez(path, **{name: np.array(value, object) for name, value in entries.items()})  # pyright: ignore[reportArgumentType]
    return path


def test_a_take_is_the_persons_own_body(folder: Path) -> None:
    given = params()
    (scene,) = grab.read(put(folder, {"params": given, "vtemp": "tools/subject_meshes/male/s1.ply"}))
    model = smpl.load(folder / "body_models" / "smplx" / "SMPLX_MALE.npz")
    own = smpl.with_template(model, model.template * 1.03)
    joints = smpl.joints(own, np.zeros(0), given["fullpose"], given["transl"])
    np.testing.assert_allclose(scene.positions[:, 0, :22], joints[:, :22], atol=1e-5)
    np.testing.assert_allclose(scene.positions[:, 0, -2:], joints[:, [27, 42]], atol=1e-5)
    skin = smpl.vertices(own, np.zeros(0), given["fullpose"], given["transl"], [60])
    nose = scene.skeleton.find("nose")
    assert nose is not None
    np.testing.assert_allclose(scene.positions[:, 0, nose], skin[:, 0], atol=1e-5)
    assert (scene.fps, scene.people, scene.source) == (120.0, ("s1 cup_drink_1",), "GRAB s1 cup_drink_1")
    assert scene.observed.all()


def test_without_a_full_pose_the_fingers_are_not_seen(folder: Path) -> None:
    given = params()
    del given["fullpose"]
    (scene,) = grab.read(put(folder, {"params": given}))
    assert not scene.observed[:, 0, -2:].any()
    assert scene.observed[:, 0, :-2].all()


def test_splits_by_person(folder: Path) -> None:
    for name in ("s1/cup_drink_1", "s2/cup_drink_1", "s10/cup_drink_1"):
        put(folder, {}, name)
    assert [path.parent.name for split in ("train", "validation", "test") for path in grab.takes(folder, split)] == [
        "s2",
        "s1",
        "s10",
    ]


@pytest.mark.parametrize(
    ("body", "says"),
    [
        ({}, "no gender"),
        (3, "no gender"),
        ({"params": {"transl": np.zeros((5, 3))}}, '"global_orient"'),
        ({"params": {"fullpose": np.zeros((5, 156))}}, '"fullpose"'),
        ({"params": {"fullpose": np.zeros((5, 165)), "transl": np.full((5, 3), np.inf)}}, '"transl"'),
        ({"params": print}, "could run code"),
    ],
)
def test_odd_takes_are_named(body: object, says: str, folder: Path) -> None:
    with pytest.raises(FormatError, match=says):
        list(grab.read(put(folder, body)))


def test_the_persons_mesh_must_fit(folder: Path) -> None:
    path = put(folder, {"params": params()})
    write_ply(folder / "tools" / "subject_meshes" / "male" / "s1.ply", np.zeros((4, 3)))
    with pytest.raises(InputError, match="use its own"):
        list(grab.read(path))


def test_vertices_of_both_kinds_of_ply(tmp_path: Path) -> None:
    vertices = np.random.default_rng(0).normal(size=(7, 3)).astype(np.float32)
    for kind in ("ascii", "binary_little_endian"):
        path = write_ply(tmp_path / f"{kind}.ply", vertices, kind)
        np.testing.assert_allclose(grab.read_vertices(path), vertices, rtol=1e-6)
        whole = path.read_bytes()
        for content in (
            whole[:-50],
            whole.replace(b" 7\n", b" 99999999999\n"),
            b"solid",
            whole.replace(b"ply", b"PLY"),
        ):
            path.write_bytes(content)
            with pytest.raises(FormatError):
                grab.read_vertices(path)
    with pytest.raises(FormatError, match="big"):
        grab.read_vertices(write_ply(tmp_path / "big.ply", vertices, "binary_big_endian"))
