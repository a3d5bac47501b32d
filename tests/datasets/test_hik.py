from __future__ import annotations

import json
from collections import Counter
from pathlib import Path

import numpy as np
import pytest

from motioncast.datasets import hik
from motioncast.datasets.hik import Item
from motioncast.errors import FormatError, InputError
from motioncast.testing.smpl import write_smpl

BODY = np.zeros((29, 3), np.float32)


@pytest.fixture(autouse=True)
def body(tmp_path: Path) -> None:
    from motioncast.bodies import smpl

    model = smpl.load(write_smpl(tmp_path / "model" / "m.npz", "smplx"))
    x, y, z = smpl.joints(model, np.zeros(10), np.zeros((1, 165)))[0].T
    standing = np.stack([x, -z, y + 0.95], -1)
    BODY[:24] = standing[:24]
    BODY[24:] = standing[15] + (0, -0.1, 0.05)


def put(folder: Path, name: str, first: int, last: int, **changes: np.ndarray) -> Path:
    """A stay of somebody who walks 1 cm a frame, his number of metres to the side."""
    frames = np.arange(first, last + 1)
    person = int(name.split("_")[1])
    place = np.stack([frames * 0.01, np.full(len(frames), float(person)), np.zeros(len(frames))], -1)
    arrays = {
        "poses3d": (BODY + place[:, None]).astype(np.float32), "frames": frames, "act": np.zeros((len(frames), 82)),
        "smpl": np.zeros((len(frames), 21, 3)), "transforms": np.zeros((len(frames), 6)), "betas": np.zeros(10),
    } | changes  # fmt: skip
    path = folder / "poses" / f"{name}.npz"
    path.parent.mkdir(exist_ok=True)
    np.savez(path, **arrays)
    return path


def test_a_stay_is_a_scene(tmp_path: Path) -> None:
    (scene,) = hik.read(put(tmp_path, "D_3_0", 100, 109))
    assert (scene.frames, scene.fps, scene.people, scene.skeleton.label) == (10, 25.0, ("person 3",), "hik29")
    np.testing.assert_allclose(scene.positions[4, 0, 0], BODY[0] + (1.04, 3, 0), atol=1e-5)
    assert scene.skeleton.names[12] == "neck"
    assert scene.skeleton.landmarks[24:] == ("nose", "left_eye", "right_eye", "left_ear", "right_ear")


def test_frames_that_are_left_out_are_not_observed(tmp_path: Path) -> None:
    (scene,) = hik.read(put(tmp_path, "D_3_0", 100, 103, frames=np.array([100, 101, 105, 106])))
    assert scene.observed[:, 0, 0].tolist() == [True, True, False, False, False, True, True]


def test_an_item_has_everybody_who_is_there_at_its_frame(tmp_path: Path) -> None:
    put(tmp_path, "D_7_0", 90, 130)  # the acting person, there from 10 frames before
    put(tmp_path, "D_2_0", 50, 105)  # leaves in the future
    put(tmp_path, "D_2_1", 110, 130)  # comes back: another stay, not there at the frame
    put(tmp_path, "D_4_0", 100, 130)  # comes in with the first future frame
    put(tmp_path, "D_5_0", 50, 99)  # leaves with the last of the history
    put(tmp_path, "A_9_0", 50, 130)  # another kitchen
    item = Item("D", "walking", 7, 100)
    scene = hik.window(hik.stays(tmp_path), item, 20, 15)
    assert scene.people == ("person 7", "person 2", "person 4")
    assert scene.frames == 35
    seen = scene.observed[:, :, 0]
    assert seen.sum(0).tolist() == [25, 26, 15]
    assert seen[10:, 0].all()
    assert seen[:26, 1].all()
    assert not seen[:20, 2].any()
    np.testing.assert_allclose(scene.positions[20, 0, 0], BODY[0] + (1.0, 7, 0), atol=1e-5)  # row 20 is frame 100
    with pytest.raises(InputError, match="person 5 is not in kitchen D at frame 100"):
        hik.window(hik.stays(tmp_path), Item("D", "walking", 5, 100))


def test_the_evaluation_list(tmp_path: Path) -> None:
    lists = {"D": {"sink": [{"pid": 3, "frame": 900}], "walking": [{"pid": 1, "frame": 700}, {"pid": 1, "frame": 5}]}}
    (tmp_path / "test.json").write_text(json.dumps(lists), encoding="utf-8")
    expected = [Item("D", "sink", 3, 900), Item("D", "walking", 1, 700), Item("D", "walking", 1, 5)]
    assert hik.items(tmp_path) == hik.items(tmp_path / "test.json") == expected
    for text in ("[]", "{}", '{"D": {"sink": [{"pid": 3}]}}', '{"D": {"sink": [{"pid": 3, "frame": "x"}]}}', "{"):
        (tmp_path / "test.json").write_text(text, encoding="utf-8")
        with pytest.raises(FormatError, match="owners' test"):
            hik.items(tmp_path)
    with pytest.raises(InputError, match="no file"):
        hik.items(tmp_path / "model")


@pytest.mark.data
def test_the_public_list_has_961_items(shared: Path) -> None:
    items = hik.items(shared / "hik")
    counts = {"walking": 581, "sitting_down": 99, "whiteboard": 89, "sink": 36, "cupboard": 133, "coffee": 23}
    assert Counter(item.action for item in items) == counts
    assert sum(len(hik.items(shared / "hik", kitchen)) for kitchen in "ABCD") == 3018


def test_odd_files_are_named(tmp_path: Path) -> None:
    for changes, says in (
        ({"poses3d": np.zeros((10, 28, 3))}, "29 finite joints"),
        ({"poses3d": np.full((10, 29, 3), np.nan)}, "29 finite joints"),
        ({"frames": np.arange(9, -1, -1)}, "do not rise"),
        ({"frames": np.arange(10) * 10**9}, "do not rise"),
        ({"frames": np.zeros(0)}, "no frame numbers"),
        ({"frames": np.array(["a"] * 10)}, "no frame numbers"),
    ):
        with pytest.raises(FormatError, match=says):
            list(hik.read(put(tmp_path, "D_1_0", 0, 9, **changes)))
    path = put(tmp_path, "D_1_0", 0, 9)
    path.write_bytes(path.read_bytes()[:300])
    with pytest.raises(FormatError, match="damaged"):
        hik.stays(tmp_path)
    with pytest.raises(InputError, match="another unit"):
        list(hik.read(put(tmp_path, "D_1_0", 0, 9, poses3d=np.repeat(BODY[None] * 100, 10, 0))))
