from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from motioncast.bodies import smpl
from motioncast.core.skeletons import SMPL22
from motioncast.datasets import amass
from motioncast.errors import FormatError, InputError
from motioncast.testing.smpl import write_smpl

LAYOUTS = {"smplh": ("_poses", 156, "mocap_framerate"), "smplx": ("_stageii", 165, "mocap_frame_rate")}


def put(folder: Path, kind: str = "smplh", subset: str = "CMU", **changes: object) -> Path:
    """A take of a person who stands in the world, z up, and lifts the left arm."""
    suffix, width, rate = LAYOUTS[kind]
    path = folder / subset / "01" / f"01_01{suffix}.npz"
    path.parent.mkdir(parents=True, exist_ok=True)
    poses = np.zeros((8, width))
    poses[:, 0] = np.pi / 2
    poses[:, 3 * SMPL22.index("left_shoulder") + 2] = np.linspace(0, 1, 8)
    entries: dict[str, object] = {
        "poses": poses, "trans": np.full((8, 3), (1.0, 2.0, 0.95)), "betas": np.zeros(16), "gender": np.array("male"),
        rate: 120.0, "dmpls": np.zeros((8, 8)), "markers_latent_vids": np.array({"a": object}, object),
    } | changes  # fmt: skip
    np.savez(path, **{name: value for name, value in entries.items() if value is not None})  # pyright: ignore[reportArgumentType]
    return path


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    write_smpl(tmp_path / "body_models" / "smplh" / "male" / "model.npz", "smplh", 16)
    write_smpl(tmp_path / "body_models" / "smplx" / "SMPLX_MALE.npz", "smplx", 400)
    amass._model.cache_clear()
    return tmp_path


@pytest.mark.parametrize("kind", LAYOUTS)
def test_a_take_stands_in_the_world_with_rotations(kind: str, folder: Path) -> None:
    path = put(folder, kind)
    (scene,) = amass.read(path)
    body = smpl.load(smpl.find(folder / "body_models", kind, "male"))
    with np.load(path, allow_pickle=True) as file:
        expected = smpl.joints(body, file["betas"], file["poses"][:, :66], file["trans"])
    np.testing.assert_allclose(scene.positions[:, 0], expected, atol=1e-6)
    assert (scene.fps, scene.skeleton, scene.source) == (120.0, SMPL22, "AMASS CMU 01 01_01")
    assert scene.rotations is not None
    height = scene.positions[:, 0, :, 2]
    assert (height[:, SMPL22.index("head")] > 1.4).all()
    wrist = height[:, SMPL22.index("left_wrist")]
    assert wrist[-1] - wrist[0] > 0.3


def test_gender_may_be_bytes_and_files_of_shapes_are_no_takes(folder: Path) -> None:
    path = put(folder, gender=np.array(b"male"))
    np.savez(path.parent / "shape.npz", betas=np.zeros(16))
    np.savez(path.parent / "male_stagei.npz", betas=np.zeros(16))
    assert amass.takes(folder) == [path]
    (scene,) = amass.read(path)
    assert scene.frames == 8


def test_splits_by_subset(folder: Path) -> None:
    for subset in ("CMU", "BMLrub", "HDM05", "Other"):
        put(folder, subset=subset)
    found = {split: [path.parts[-3] for path in amass.takes(folder, split)] for split in amass.SPLITS}
    assert found == {"train": ["CMU"], "validation": ["HDM05"], "test": ["BMLrub"]}
    assert len(amass.takes(folder)) == 4


@pytest.mark.parametrize(
    ("changes", "says"),
    [
        ({"poses": np.zeros((8, 100))}, r"poses of shape \(8, 100\)"),
        ({"trans": np.zeros((7, 3))}, r"trans of shape \(7, 3\)"),
        ({"mocap_framerate": None}, "no frame rate"),
        ({"mocap_framerate": np.array("fast")}, "no frame rate"),
        ({"betas": None}, '"betas"'),
        ({"poses": np.full((8, 156), np.nan)}, '"poses"'),
        ({"poses": np.array({"a": 1}, object)}, '"poses"'),
    ],
)
def test_odd_takes_are_named(changes: dict[str, object], says: str, folder: Path) -> None:
    with pytest.raises(FormatError, match=says):
        list(amass.read(put(folder, **changes)))


def test_cut_files_and_missing_models(folder: Path, tmp_path: Path) -> None:
    path = put(folder, gender=np.array("female"))
    with pytest.raises(InputError, match="no female model of the kind smplh"):
        list(amass.read(path))
    path.write_bytes(path.read_bytes()[:400])
    with pytest.raises(FormatError, match="damaged"):
        list(amass.read(path))


def test_a_whole_copy_is_fine(folder: Path) -> None:
    put(folder)
    findings = amass.DATASET.check(folder)
    assert {finding.kind for finding in findings} == {"there"}
    assert findings[1].what.startswith("body_models/**/*.npz: 2 files")
    put(folder, subset="SFU", gender=np.array("female"))
    (odd,) = (finding.what for finding in amass.DATASET.check(folder) if finding.kind == "odd")
    assert "no female model" in odd
