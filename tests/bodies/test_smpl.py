from __future__ import annotations

import pickle
from pathlib import Path

import numpy as np
import pytest

from motioncast.bodies import smpl
from motioncast.core.kinematics import forward
from motioncast.core.rotation import from_axis_angle, to_matrix
from motioncast.core.skeletons import SMPL22, SMPL24
from motioncast.errors import FormatError, InputError
from motioncast.testing.smpl import write_smpl


@pytest.fixture(params=["smpl", "smplh", "smplx"])
def model(request: pytest.FixtureRequest, tmp_path: Path) -> smpl.SmplModel:
    return smpl.load(write_smpl(tmp_path / "model.npz", request.param, 20))


def motion(model: smpl.SmplModel, frames: int = 5) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    rng = np.random.default_rng(3)
    poses = rng.normal(0, 0.6, (frames, len(model.parents) * 3))
    return rng.normal(size=10), poses, rng.normal(size=(frames, 3))


def naive(model: smpl.SmplModel, betas: np.ndarray, pose: np.ndarray, shift: np.ndarray) -> tuple[np.ndarray, ...]:
    """Joints and skin of one frame by 4 x 4 matrices, as Loper et al. write them, one vertex at a time."""
    body = model.template + sum(beta * model.shapes[..., number] for number, beta in enumerate(betas))
    rest = model.regressor @ body
    turns = to_matrix(from_axis_angle(pose.reshape(-1, 3)))
    world: list[np.ndarray] = []
    for joint, parent in enumerate(model.parents):
        step = np.eye(4)
        step[:3, :3] = turns[joint]
        step[:3, 3] = rest[joint] - (rest[parent] if parent >= 0 else 0)
        world.append(step if parent < 0 else world[parent] @ step)
    bends = (turns[1:] - np.eye(3)).ravel()
    skin = []
    for vertex in range(len(body)):
        point = np.append(body[vertex] + model.corrections[vertex] @ bends, 1)
        moved = np.zeros(4)
        for joint, matrix in enumerate(world):
            away = np.eye(4)
            away[:3, 3] = -rest[joint]
            moved += model.weights[vertex, joint] * (matrix @ away @ point)
        skin.append(moved[:3] + shift)
    return np.stack([matrix[:3, 3] for matrix in world]) + shift, np.stack(skin)


def test_joints_and_skin_equal_the_slow_way(model: smpl.SmplModel) -> None:
    betas, poses, shift = motion(model, 2)
    joints, skin = smpl.joints(model, betas, poses, shift), smpl.vertices(model, betas, poses, shift)
    assert (joints.dtype, skin.dtype) == (np.float32, np.float32)
    for frame in range(2):
        slow_joints, slow_skin = naive(model, betas, poses[frame], shift[frame])
        np.testing.assert_allclose(joints[frame], slow_joints, atol=2e-5)
        np.testing.assert_allclose(skin[frame], slow_skin, atol=2e-5)


def test_at_rest_the_skin_is_the_shaped_body(model: smpl.SmplModel) -> None:
    betas = np.array([2.0, -1.0])
    skin = smpl.vertices(model, betas, np.zeros((1, 3)))
    np.testing.assert_allclose(skin[0], model.shaped(betas), atol=1e-6)
    np.testing.assert_allclose(
        smpl.joints(model, betas, np.zeros((1, 66)))[0], (model.regressor @ model.shaped(betas))[:22], atol=1e-6
    )


def test_blocks_of_frames_and_chosen_vertices_change_nothing(
    model: smpl.SmplModel, monkeypatch: pytest.MonkeyPatch
) -> None:
    betas, poses, shift = motion(model, 5)
    whole = smpl.vertices(model, betas, poses, shift)
    np.testing.assert_allclose(smpl.vertices(model, betas, poses, shift, [7, 2]), whole[:, [7, 2]], atol=1e-6)
    monkeypatch.setattr(smpl, "FRAMES_AT_ONCE", 2)
    np.testing.assert_allclose(smpl.vertices(model, betas, poses, shift), whole, atol=1e-6)


def test_first_joints_alone_are_the_same(model: smpl.SmplModel) -> None:
    betas, poses, shift = motion(model)
    few = smpl.joints(model, betas, poses[:, :66], shift)
    np.testing.assert_allclose(few, smpl.joints(model, betas, poses, shift)[:, :22], atol=1e-6)
    assert model.skeleton(22) is SMPL22


@pytest.mark.parametrize("up", ["z", "y"])
def test_a_scene_stands_upright_and_its_rotations_give_its_positions(model: smpl.SmplModel, up: str) -> None:
    betas, poses, shift = motion(model)
    poses[:, :3] = (np.pi / 2, 0, 0) if up == "z" else 0  # a body with y up turned to stand in its world
    scene = smpl.scene(model, betas, poses[:, :66], shift, 60.0, "ann", up)
    assert scene.skeleton is SMPL22
    assert scene.rotations is not None
    assert scene.offsets is not None
    again = forward(scene.rotations, scene.positions[:, :, 0], scene.offsets, SMPL22.parents)
    np.testing.assert_allclose(again, scene.positions, atol=1e-5)
    raw = smpl.joints(model, betas, poses[:, :66], shift)
    x, y, z = np.moveaxis(raw, -1, 0)
    np.testing.assert_allclose(scene.positions[:, 0], raw if up == "z" else np.stack([x, -z, y], -1), atol=1e-5)
    spine = scene.positions[:, 0, SMPL22.index("spine1")] - scene.positions[:, 0, 0]
    assert (spine[:, 2] > 0.1).all()
    assert scene.offsets[0, SMPL22.index("left_knee"), 2] < -0.3  # the rest body stands too


def test_the_skeleton_of_every_joint_is_recognised(tmp_path: Path) -> None:
    for kind, fingers in (("smplh", True), ("smplx", True), ("smpl", False)):
        model = smpl.load(write_smpl(tmp_path / f"{kind}.npz", kind))
        skeleton = model.skeleton(len(model.parents))
        assert skeleton.parents == model.parents
        assert skeleton.names[skeleton.landmarks.index("left_hand")] == ("left_middle1" if fingers else "left_hand")
    assert smpl.load(tmp_path / "smpl.npz").skeleton(24) is SMPL24


def test_expressions_are_no_shapes(tmp_path: Path) -> None:
    assert smpl.load(write_smpl(tmp_path / "a.npz", "smplx", 20)).shapes.shape[-1] == 10
    assert smpl.load(write_smpl(tmp_path / "b.npz", "smplx", 400)).shapes.shape[-1] == 300
    assert smpl.load(write_smpl(tmp_path / "c.npz", "smplh", 16)).shapes.shape[-1] == 16


def test_a_pickle_is_answered_with_how_to_convert_it(tmp_path: Path) -> None:
    write_smpl(tmp_path / "model.npz")
    with np.load(tmp_path / "model.npz", allow_pickle=True) as file:
        arrays = {name: file[name] for name in smpl.ARRAYS}
    old = tmp_path / "SMPL_MALE.pkl"
    old.write_bytes(pickle.dumps(arrays, 2))
    with pytest.raises(InputError, match="could run code") as caught:
        smpl.load(old)
    _, _, code = str(caught.value).partition('python -c "')
    exec(code.removesuffix('"'), {})
    assert smpl.load(tmp_path / "SMPL_MALE.npz").kind == "smpl"


def test_what_does_not_fit_is_said(tmp_path: Path) -> None:
    model = smpl.load(write_smpl(tmp_path / "model.npz"))
    with pytest.raises(InputError, match="at most 10"):
        smpl.joints(model, np.zeros(16), np.zeros((1, 66)))
    with pytest.raises(InputError, match="poses of 52 joints"):
        smpl.joints(model, np.zeros(10), np.zeros((1, 156)))
    with pytest.raises(InputError, match="use its own"):
        smpl.with_template(model, np.zeros((7, 3)))


def damaged(path: Path, **changes: np.ndarray | None) -> Path:
    with np.load(path, allow_pickle=True) as file:
        arrays = {name: file[name] for name in smpl.ARRAYS} | changes
    np.savez(path, **{name: array for name, array in arrays.items() if array is not None})
    return path


def test_odd_files_are_named(tmp_path: Path) -> None:
    with pytest.raises(FormatError, match="lacks weights"):
        smpl.load(damaged(write_smpl(tmp_path / "a.npz"), weights=None))
    with pytest.raises(FormatError, match="posedirs has the shape"):
        smpl.load(damaged(write_smpl(tmp_path / "b.npz"), posedirs=np.zeros((4, 3, 207))))
    with pytest.raises(FormatError, match="no numbers in weights"):
        smpl.load(damaged(write_smpl(tmp_path / "f.npz"), weights=np.array("text")))
    with pytest.raises(FormatError, match="16 joints"):
        smpl.load(damaged(write_smpl(tmp_path / "c.npz"), J_regressor=np.zeros((16, 96))))
    with pytest.raises(FormatError, match="before its child"):
        smpl.load(damaged(write_smpl(tmp_path / "d.npz"), kintree_table=np.full((2, 24), 30)))
    (tmp_path / "e.npz").write_bytes((tmp_path / "a.npz").read_bytes()[:5000])
    with pytest.raises(FormatError, match="damaged"):
        smpl.load(tmp_path / "e.npz")


def test_models_are_found_where_releases_put_them(tmp_path: Path) -> None:
    folder = tmp_path / "data" / "body_models"
    first = write_smpl(folder / "smplh" / "male" / "model.npz", "smplh")
    second = write_smpl(folder / "SMPLX_NEUTRAL.npz", "smplx")
    take = tmp_path / "data" / "CMU" / "01" / "01_poses.npz"
    assert smpl.models_beside(take) == folder.resolve()
    assert smpl.find(folder, "smplh", "male") == first
    assert smpl.find(folder, "smplx", "neutral") == second
    with pytest.raises(InputError, match="no female model"):
        smpl.find(folder, "smplh", "female")
    with pytest.raises(InputError, match="body_models"):
        smpl.models_beside(tmp_path / "elsewhere" / "a.npz")
