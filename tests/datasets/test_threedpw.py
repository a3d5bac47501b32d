from __future__ import annotations

import os
import pickle
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from motioncast.bodies import smpl
from motioncast.core.skeletons import SMPL24
from motioncast.datasets import threedpw
from motioncast.errors import FormatError, InputError
from motioncast.testing.smpl import write_smpl


def sequence(tmp_path: Path, frames: int = 6, scale: float = 1.0) -> dict[str, Any]:
    """Two people who stand in 3DPW's layout, y up; the second's camera is lost in frame 2."""
    body = smpl.load(write_smpl(tmp_path / "model.npz"))
    places = [np.full((frames, 3), (1.5 * person, 0, 2)) for person in range(2)]
    joints = [smpl.joints(body, np.zeros(10), np.zeros((frames, 72)), place) for place in places]
    valid = np.ones((2, frames), np.int64)
    valid[1, 2] = 0
    return {
        "sequence": "downtown_test_00",
        "jointPositions": [(person * scale).reshape(frames, 72).astype(np.float64) for person in joints],
        "poses": [np.zeros((frames, 72))] * 2,
        "genders": ["m", "f"],
        "campose_valid": list(valid),
        "cam_poses": np.zeros((frames, 4, 4)),
    }


def put(tmp_path: Path, data: object, split: str = "train") -> Path:
    path = tmp_path / "sequenceFiles" / split / "downtown_test_00.pkl"
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(pickle.dumps(data, 2))
    return path


def test_people_stand_upright_in_the_world(tmp_path: Path) -> None:
    data = sequence(tmp_path)
    (scene,) = threedpw.read(put(tmp_path, data))
    raw = data["jointPositions"][1].reshape(6, 24, 3)
    x, y, z = np.moveaxis(raw, -1, 0)
    np.testing.assert_allclose(scene.positions[0, 1], np.stack([x, -z, y], -1)[0], atol=1e-6)
    head, foot = SMPL24.index("head"), SMPL24.index("left_foot")
    assert (scene.positions[0, :, head, 2] - scene.positions[0, :, foot, 2] > 1.3).all()
    assert (scene.fps, scene.skeleton, len(scene.people)) == (30.0, SMPL24, 2)
    assert scene.observed[:, 0].all()
    assert not scene.observed[2, 1].any()
    assert scene.observed[3, 1].all()


def test_takes_by_split(tmp_path: Path) -> None:
    for split in threedpw.SPLITS:
        put(tmp_path, {}, split)
    assert [path.parent.name for path in threedpw.takes(tmp_path)] == ["train", "validation", "test"]
    assert len(threedpw.takes(tmp_path, "validation")) == 1


class Bomb:
    def __init__(self, where: Path) -> None:
        self.where = where

    def __reduce__(self) -> tuple[Any, ...]:
        return os.mkdir, (str(self.where),)


def test_a_bomb_does_not_run(tmp_path: Path) -> None:
    path = put(tmp_path, sequence(tmp_path) | {"texture_maps": Bomb(tmp_path / "hole")})
    with pytest.raises(FormatError, match="could run code"):
        list(threedpw.read(path))
    assert not (tmp_path / "hole").exists()


def test_damaged_and_odd_files_are_named(tmp_path: Path) -> None:
    data = sequence(tmp_path)
    path = put(tmp_path, data)
    path.write_bytes(path.read_bytes()[:3000])
    with pytest.raises(FormatError, match="damaged"):
        list(threedpw.read(path))
    joints = data["jointPositions"]
    for change, says in (
        ({"jointPositions": [joint[:, :69] for joint in joints]}, r"shape \(6, 69\)"),
        ({"jointPositions": [joints[0], joints[1][:4]]}, "one length"),
        ({"jointPositions": []}, "no entry for each person"),
        ({"jointPositions": [joints[0] * np.nan, joints[1]]}, "not finite"),
        ({"campose_valid": [np.ones(3)] * 2}, "campose_valid"),
    ):
        with pytest.raises(FormatError, match=says):
            list(threedpw.read(put(tmp_path, data | change)))
    with pytest.raises(FormatError, match="no jointPositions"):
        list(threedpw.read(put(tmp_path, [1, 2])))


def test_another_unit_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="another unit"):
        list(threedpw.read(put(tmp_path, sequence(tmp_path, scale=1000))))
