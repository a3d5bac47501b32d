"""The user's own videos, MPII Cooking 2 and IKEA ASM, in tiny files of their layouts."""

from __future__ import annotations

import json

import numpy as np
import pytest

from motioncast.core.camera import look_at
from motioncast.core.scene import Scene
from motioncast.core.skeletons import MRT15, UPPER9
from motioncast.core.upper_body import depth_m, most_articulated
from motioncast.datasets import ikea_asm, mpii_cooking
from motioncast.datasets.video_folder import SHARES, split_of
from motioncast.datasets.videos import read_camera, steps_of, steps_of_scene
from motioncast.errors import FormatError, InputError, SceneError
from motioncast.formats.steps_tsv import Span

FRAMES = 12
CAMERA = {"focal_px": 800, "centre_px": [320, 240], "size_px": [640, 480]}


def pose(hand: float) -> np.ndarray:
    body = np.array([[0, -40], [0, 0], [-30, 5], [-35, 50], [-20, 90], [30, 5], [35, 50], [20, 90], [0, 100]], float)
    body[4] += hand, -hand
    return body + np.array([300, 200])


def write_folder(folder, video):
    """Poses of COCO's layout whose right hand is farthest out in frames 3 and 9; a camera."""
    entries = []
    for frame in range(FRAMES):
        ours = pose(60 if frame in (3, 9) else 0)
        coco = np.full((17, 3), 0.9)
        coco[[0, 6, 8, 10, 5, 7, 9], :2] = ours[[0, 2, 3, 4, 5, 6, 7]]
        coco[[11, 12], :2] = ours[8]
        entries.append({"image_id": frame, "keypoints": coco.ravel().tolist()})
    target = folder / "poses" / f"{video}.json"
    target.parent.mkdir(parents=True, exist_ok=True)
    target.write_text(json.dumps(entries), encoding="utf-8")
    (folder / "camera.json").write_text(json.dumps(CAMERA), encoding="utf-8")


def test_mpii_cooking_counts_from_one_and_merges_by_the_users_table(tmp_path):
    write_folder(tmp_path, "s08-d02-cam-002")
    (tmp_path / "annotations.csv").write_text(
        "fileName,startFrame,endFrame,activity\n"
        "s08-d02-cam-002,7,12,cut dice\ns08-d02-cam-002,1,6,wash\ns08-d02-cam-002,1,2,open cupboard\ns99,1,6,wash\n",
        encoding="utf-8",
    )
    (tmp_path / "clusters.tsv").write_text("label\tcluster\nwash\twash\ncut dice\tcut\nopen cupboard\t\n", "utf-8")
    (tmp_path / "characteristic.tsv").write_text("video\tfirst\tframe\ns08-d02-cam-002\t6\t8\n", "utf-8")
    (tmp_path / "objects.tsv").write_text("video\tobject\ns08-d02-cam-002\tknife\n", "utf-8")
    (sequence,) = mpii_cooking.sequences(tmp_path)
    assert [sequence.labels[action] for action in sequence.actions[:, 0]] == ["wash", "cut"]
    assert sequence.things == ("knife",)
    np.testing.assert_allclose(sequence.pixels[0, 0, 4], pose(60)[4])  # found: frame 3
    np.testing.assert_allclose(sequence.pixels[1, 0, 4], pose(0)[4])  # named: frame 8
    assert list(mpii_cooking.sequences(tmp_path, split_of("s08-d02-cam-002")))
    others = set(SHARES) - {split_of("s08-d02-cam-002")}
    assert not [one for split in others for one in mpii_cooking.sequences(tmp_path, split)]


def test_ikea_asm_counts_from_zero_with_inclusive_ends_and_leaves_nothing_out_but_na(tmp_path):
    video = "Lack_TV_Bench/0025_black_table"
    write_folder(tmp_path, video)
    annotation = [
        {"segment": [0, 5], "label": "pick up leg"},
        {"segment": [6, 6], "label": "NA"},
        {"segment": [7, 11], "label": "spin leg"},
    ]
    database = {video: {"subset": "training", "annotation": annotation}}
    (tmp_path / "gt_segments.json").write_text(json.dumps({"version": "2.0.0", "database": database}), "utf-8")
    assert ikea_asm.labelled(tmp_path) == {video: [Span(0, 6, "pick up leg"), Span(7, 12, "spin leg")]}
    (sequence,) = ikea_asm.sequences(tmp_path)
    assert len(sequence) == 2
    np.testing.assert_allclose(sequence.pixels[1, 0, 4], pose(60)[4])  # frame 9


def test_what_is_missing_is_said(tmp_path):
    with pytest.raises(InputError, match=r"no file .*annotations\.csv"):
        next(mpii_cooking.sequences(tmp_path))
    with pytest.raises(InputError, match=r"no file .*gt_segments"):
        next(ikea_asm.sequences(tmp_path))
    (tmp_path / "gt_segments.json").write_text('{"database": {"a": {"annotation": []}}}', "utf-8")
    with pytest.raises(InputError, match=r"camera\.json"):
        next(ikea_asm.sequences(tmp_path))
    (tmp_path / "camera.json").write_text(json.dumps(CAMERA), "utf-8")
    with pytest.raises(InputError, match="none of the 1 labelled videos"):
        next(ikea_asm.sequences(tmp_path))
    (tmp_path / "gt_segments.json").write_text('{"database": {"a": {"annotation": [{}]}}}', "utf-8")
    with pytest.raises(FormatError, match="database"):
        next(ikea_asm.sequences(tmp_path))
    (tmp_path / "annotations.csv").write_text("fileName,startFrame,endFrame,activity\na,5,4,wash\n", "utf-8")
    with pytest.raises(FormatError, match=":2:"):
        next(mpii_cooking.sequences(tmp_path))


def test_the_split_keeps_its_shares():
    found = [split_of(f"video {number}") for number in range(2000)]
    for split, share in SHARES.items():
        assert found.count(split) / 2000 == pytest.approx(share, abs=0.03)


def test_the_most_articulated_frame_is_within_its_step():
    poses = np.stack([pose(10.0 * frame) for frame in range(8)])
    poses[6, 4] = np.nan
    assert most_articulated(poses, 0, 3) == 0  # farthest from the middle one
    assert most_articulated(poses, 4, 7) == 5
    with pytest.raises(SceneError, match="frames 6 to 6 show no hand"):
        most_articulated(np.where(np.arange(9)[:, None] == 1, poses, np.nan), 6, 7)


def test_a_scene_is_seen_from_ahead(tmp_path):
    positions = np.zeros((6, 1, 15, 3), np.float32)
    places = {
        "pelvis": (0, 0, 1), "neck": (0, 0, 1.52), "head": (0.1, 0, 1.7), "left_shoulder": (0, 0.2, 1.5),
        "left_elbow": (0, 0.25, 1.2), "left_wrist": (0.1, 0.25, 1), "right_shoulder": (0, -0.2, 1.5),
        "right_elbow": (0, -0.25, 1.2), "right_wrist": (0.1, -0.25, 1),
    }  # fmt: skip
    for name, place in places.items():
        positions[:, :, MRT15.index(name)] = place
    scene = Scene(positions, MRT15, 30.0)
    sequence = steps_of_scene(scene, [Span(0, 3, "take"), Span(3, 6, "put")])
    assert depth_m(sequence.pixels, sequence.camera.focal_px)[0] == pytest.approx(3.5, abs=0.1)
    right, left = (sequence.pixels[0, 0, UPPER9.index(f"{side}_wrist"), 0] for side in ("right", "left"))
    assert right < left  # who faces the camera has the right hand on its left
    with pytest.raises(SceneError, match="ends at frame 9 of 6"):
        steps_of_scene(scene, [Span(3, 9, "take")])


def test_people_act_side_by_side():
    pixels = np.stack([np.stack([pose(0), pose(9)])] * 4)
    camera = look_at(np.zeros(3), np.array([0.0, 1.0, 0.0]))
    spans = [Span(0, 2, "take", 0), Span(0, 2, "wipe", 1)]
    assert steps_of("pair", pixels, spans, camera).actions.shape == (1, 2)
    with pytest.raises(SceneError, match="1, 0 of the 2 people"):
        steps_of("pair", pixels, spans[:1], camera)


def test_a_camera_of_unknown_place_looks_ahead(tmp_path):
    path = tmp_path / "camera.json"
    path.write_text(json.dumps(CAMERA), "utf-8")
    np.testing.assert_allclose(read_camera(path).project(np.array([0, 3.0, 0])), [320, 240])
    for text in ('{"focal_px": 800}', "[]", '{"focal_px": [1, 2], "centre_px": [1, 2], "size_px": [1, 2]}'):
        path.write_text(text, "utf-8")
        with pytest.raises(FormatError):
            read_camera(path)
    with pytest.raises(InputError, match="no file"):
        read_camera(tmp_path / "none.json")
