from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from motioncast.core.skeletons import H36M17
from motioncast.datasets import h36m
from motioncast.errors import FormatError, InputError

TO_17 = [0, 1, 2, 3, 6, 7, 8, 12, 13, 14, 15, 17, 18, 19, 25, 26, 27]


def matrix(vector: np.ndarray) -> np.ndarray:
    """Rodrigues' formula."""
    angle = float(np.linalg.norm(vector))
    if angle == 0:
        return np.eye(3)
    x, y, z = vector / angle
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross


def naive(row: np.ndarray) -> np.ndarray:
    """Positions in metres, y up, as papers compute them: row vectors times a chain of matrices, root left out."""
    chain: list[np.ndarray] = []
    places: list[np.ndarray] = []
    for joint, parent in enumerate(h36m.SKELETON.parents):
        turn = np.eye(3) if joint == 0 else matrix(row[3 + 3 * joint : 6 + 3 * joint])
        chain.append(turn if parent < 0 else turn @ chain[parent])
        places.append(np.zeros(3) if parent < 0 else h36m.OFFSETS_M[joint] @ chain[parent] + places[parent])
    return np.stack(places)


def angles(frames: int = 4) -> np.ndarray:
    return np.random.default_rng(5).normal(0, 0.4, (frames, 99))


def put_text(tmp_path: Path, values: np.ndarray, name: str = "S1/walking_1.txt") -> Path:
    path = tmp_path / name
    path.parent.mkdir(exist_ok=True)
    path.write_text("\n".join(",".join(f"{value:.7f}" for value in row) for row in values) + "\n", encoding="utf-8")
    return path


def test_angles_become_positions_as_papers_compute_them(tmp_path: Path) -> None:
    values = angles()
    (scene,) = h36m.read(put_text(tmp_path, values))
    for frame in range(4):
        x, y, z = naive(values[frame]).T
        np.testing.assert_allclose(scene.positions[frame, 0], np.stack([x, -z, y], -1), atol=1e-5)
    assert (scene.fps, scene.skeleton.label, scene.people) == (50.0, "h36m32", ("S1",))
    assert "pelvis stays" in scene.remarks[0]


def test_a_body_at_rest_stands_and_has_its_right_on_its_right(tmp_path: Path) -> None:
    (scene,) = h36m.read(put_text(tmp_path, np.zeros((2, 99))))
    place = {name: scene.positions[0, 0, joint] for joint, name in enumerate(scene.skeleton.landmarks) if name}
    assert place["head_top"][2] - place["left_ankle"][2] > 1.5
    facing = place["left_toe"] - place["left_ankle"]
    across = place["right_hip"] - place["left_hip"]
    assert np.cross(facing, across)[2] < 0  # seen from above, right is clockwise of ahead


def test_rotations_give_the_positions(tmp_path: Path) -> None:
    from motioncast.core.kinematics import forward

    (scene,) = h36m.read(put_text(tmp_path, angles()))
    assert scene.rotations is not None
    assert scene.offsets is not None
    again = forward(scene.rotations, scene.positions[:, :, 0], scene.offsets, scene.skeleton.parents)
    np.testing.assert_allclose(again, scene.positions, atol=1e-5)


def test_the_17_joints_are_those_of_the_32(tmp_path: Path) -> None:
    (scene,) = h36m.read(put_text(tmp_path, angles()))
    reduced = scene.on(H36M17)
    np.testing.assert_array_equal(reduced.positions, scene.positions[:, :, TO_17])


def standing(frames: int = 5) -> np.ndarray:
    rest = naive(np.zeros(99))
    x, y, z = rest.T
    pose = np.stack([x, -z, y + 0.95], -1)
    return pose + np.linspace(0, 1, frames)[:, None, None] * (1.0, 0, 0)


@pytest.mark.parametrize("scale", [1.0, 1000.0])
@pytest.mark.parametrize("joints", [32, 17])
@pytest.mark.parametrize("flat", [True, False])
def test_positions_in_metres_or_millimetres(scale: float, joints: int, flat: bool, tmp_path: Path) -> None:
    expected = standing()[:, list(range(32)) if joints == 32 else TO_17]
    values = (expected * scale).astype(np.float32)
    path = tmp_path / "h36m.npz"
    np.savez(path, **{"S9_Walking 1": values.reshape(5, -1) if flat else values})
    (scene,) = h36m.read(path)
    np.testing.assert_allclose(scene.positions[:, 0], expected, atol=1e-5)
    assert len(scene.skeleton) == joints
    assert "inferred" in scene.remarks[0]


def test_pickled_positions_by_subject_and_action(tmp_path: Path) -> None:
    poses: dict[str, Any] = {"S1": {"Walking 1": standing(), "Eating": standing(3)}, "S11": {"Walking": standing(2)}}
    path = tmp_path / "data_3d_h36m.npz"
    np.savez(path, positions_3d=np.array(poses, object))
    scenes = list(h36m.read(path))
    assert [(scene.source, scene.frames) for scene in scenes] == [
        ("Human3.6M S1 Walking 1", 5),
        ("Human3.6M S1 Eating", 3),
        ("Human3.6M S11 Walking", 2),
    ]
    np.savez(path, positions_3d=np.array({"S1": {"Walking": print}}, object))
    with pytest.raises(FormatError, match="could run code"):
        list(h36m.read(path))


def test_takes_and_splits(tmp_path: Path) -> None:
    for name in ("S1/walking_1.txt", "S5/walking_1.txt", "S11/eating_2.txt", "Sx/notes.txt"):
        put_text(tmp_path, np.zeros((2, 99)), name)
    assert [path.parent.name for path in h36m.takes(tmp_path)] == ["S1", "S11", "S5"]
    assert [path.parent.name for path in h36m.split(tmp_path, "test")] == ["S5"]
    with pytest.raises(InputError, match="validation"):
        h36m.split(tmp_path, "val")


def test_odd_files_are_named(tmp_path: Path) -> None:
    path = put_text(tmp_path, angles())
    for text, says in (("1,2,3\n1,2\n", "no table"), ("a,b\n", "no table"), ("1,2\n", "99 finite"), ("", "99 finite")):
        path.write_text(text, encoding="utf-8")
        with pytest.raises(FormatError, match=says):
            list(h36m.read(path))
    positions = tmp_path / "poses.npz"
    for values, says in (
        (np.zeros((5, 16, 3)), "32 or 17"),
        (np.full((5, 17, 3), np.nan), "not finite"),
        (np.zeros((5, 17, 3), int), "no array of positions"),
        (np.array("text"), "no array of positions"),
    ):
        np.savez(positions, take=values)
        with pytest.raises(FormatError, match=says):
            list(h36m.read(positions))
