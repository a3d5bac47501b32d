"""Poses of detectors: OpenPose's folder, COCO's list."""

from __future__ import annotations

import json

import numpy as np
import pytest

from motioncast.errors import FormatError, InputError
from motioncast.formats.openpose import read_keypoints


def person(offset: float, joints: int, confidence: float = 0.9) -> list[float]:
    return [value for joint in range(joints) for value in (offset + joint, offset + 2 * joint, confidence)]


def openpose(folder, *frames):
    for number, people in enumerate(frames):
        text = json.dumps({"people": [{"pose_keypoints_2d": keypoints} for keypoints in people]})
        (folder / f"video_{number:012d}_keypoints.json").write_text(text, encoding="utf-8")
    return folder


def test_the_first_nine_of_openpose_are_ours_and_gaps_are_not_seen(tmp_path):
    gone = person(100, 25)
    gone[3 * 4 + 2] = 0.0
    poses = read_keypoints(openpose(tmp_path, [person(100, 25)], [], [gone]))
    assert poses.shape == (3, 1, 9, 2)
    np.testing.assert_array_equal(poses[0, 0, :, 0], 100 + np.arange(9))
    assert np.isnan(poses[1]).all()
    assert np.isnan(poses[2, 0, 4]).all()
    assert np.isfinite(poses[2, 0, [0, 1, 2, 3, 5, 6, 7, 8]]).all()


def test_of_three_people_the_surest_are_followed_from_left_to_right(tmp_path):
    frame = [person(500, 25, 0.8), person(300, 25, 0.2), person(100, 25, 0.7)]
    assert read_keypoints(openpose(tmp_path, frame))[0, 0, 0, 0] == 500
    np.testing.assert_array_equal(read_keypoints(tmp_path, people=2)[0, :, 0, 0], [100, 500])


def test_coco_has_its_neck_and_hip_between(tmp_path):
    file = tmp_path / "poses.json"
    entries = [{"image_id": name, "keypoints": person(0, 17)} for name in ("clip3_0007.jpg", "clip3_0009.jpg")]
    file.write_text(json.dumps(entries), encoding="utf-8")
    poses = read_keypoints(file)
    assert len(poses) == 3  # frame 8 shows nobody
    assert np.isnan(poses[1]).all()
    np.testing.assert_array_equal(poses[0, 0, :, 0], [0, 5.5, 6, 8, 10, 5, 7, 9, 11.5])


@pytest.mark.parametrize(
    "text", ["{", "[1]", '[{"image_id": 1, "keypoints": [1, 2]}]', '[{"image_id": "a.jpg", "keypoints": []}]', "3"]
)
def test_damaged_lists_are_refused(tmp_path, text):
    file = tmp_path / "poses.json"
    file.write_text(text, encoding="utf-8")
    with pytest.raises(FormatError):
        read_keypoints(file)


def test_other_damage_and_nobody(tmp_path):
    with pytest.raises(InputError, match="no file or folder"):
        read_keypoints(tmp_path / "none")
    with pytest.raises(InputError, match="shows nobody"):
        read_keypoints(tmp_path)
    (tmp_path / "a.json").write_text('{"people": [{"pose_keypoints_2d": [1, 2]}]}', encoding="utf-8")
    with pytest.raises(FormatError, match="25 joints"):
        read_keypoints(tmp_path)
