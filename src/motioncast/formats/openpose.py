"""Poses that a detector found in a video: JSON of OpenPose (25 joints) and in COCO's layout (17 joints).

OpenPose writes a folder with one file a frame, ``people`` with ``pose_keypoints_2d``. COCO's layout, that of AlphaPose
and Detectron2's evaluators, is one list of detections with ``image_id`` and ``keypoints``. Both give x, y and a
confidence for each joint.

What is read are the nine joints of ``core.skeletons.UPPER9``. Of OpenPose they are its first nine, as in FutureHuman3D
(Table 4.13). COCO has no neck and no hip in the middle: they lie between the shoulders and between the hips. In both
the nose stands for the head.
"""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

import numpy as np

from motioncast.errors import FormatError, InputError
from motioncast.formats.files import read_text

SURE = 0.05
"""Joints of less confidence are taken for not seen."""

OPENPOSE_JOINTS, COCO_JOINTS = 25, 17

COCO_PLACES = ((0,), (5, 6), (6,), (8,), (10,), (5,), (7,), (9,), (11, 12))
"""For each of the nine joints the joints of COCO that it lies between."""


def read_keypoints(path: str | Path, people: int = 1) -> np.ndarray:
    """Poses of a video.

    Args:
        path: A folder of OpenPose's files, or one file in COCO's layout.
        people: How many people are followed. One: the surest in each frame. Two: the surest two, from left to right.

    Returns:
        ``(frames, people, 9, 2)`` pixels, y down; NaN where not seen.

    Raises:
        InputError: If there is no such file or folder, or nobody in it.
        FormatError: If a file is damaged.
    """
    path = Path(path)
    if path.is_dir():
        files = sorted(path.glob("*.json"))
        frames = [_openpose(file) for file in files]
    elif path.is_file():
        frames = _coco(path)
    else:
        raise InputError(f"there is no file or folder {path}; give OpenPose's folder or a file in COCO's layout")
    poses = np.stack([_followed(found, people) for found in frames]) if frames else np.empty((0, people, 9, 2))
    if not np.isfinite(poses).any():
        raise InputError(f"{path} shows nobody; expected poses with a confidence above {SURE}")
    return poses


def _openpose(file: Path) -> list[np.ndarray]:
    """The people of a frame, each ``(9, 3)``: x, y, confidence."""
    try:
        people = _parsed(file)["people"]
        found = [np.array(person["pose_keypoints_2d"], np.float64).reshape(OPENPOSE_JOINTS, 3) for person in people]
    except (KeyError, TypeError, ValueError):
        raise FormatError(file, 'no people with "pose_keypoints_2d" of 25 joints; run OpenPose with BODY_25') from None
    return [joints[:9] for joints in found]


MOST_FRAMES = 10_000_000


def _coco(file: Path) -> list[list[np.ndarray]]:
    """The people of each frame; frames without any are empty."""
    frames: dict[int, list[np.ndarray]] = {}
    try:
        for entry in _parsed(file):
            joints = np.array(entry["keypoints"], np.float64).reshape(COCO_JOINTS, 3)
            frames.setdefault(_frame_of(entry["image_id"]), []).append(_from_coco(joints))
    except (KeyError, TypeError, ValueError):
        raise FormatError(file, 'no list of detections with "image_id" and "keypoints" of 17 joints') from None
    first, last = min(frames, default=0), max(frames, default=-1)
    if last - first > MOST_FRAMES:
        raise FormatError(file, f"image_id goes from {first} to {last}; expected numbers of frames")
    return [frames.get(frame, []) for frame in range(first, last + 1)]


def _frame_of(name: int | str) -> int:
    """The number of a frame: itself, or the last number in a name such as ``video_0012.jpg``."""
    if isinstance(name, int):
        return name
    numbers = re.findall(r"\d+", Path(name).stem)
    if not numbers:
        raise ValueError(name)
    return int(numbers[-1])


def _from_coco(joints: np.ndarray) -> np.ndarray:
    parts = [joints[list(place)] for place in COCO_PLACES]
    return np.stack([np.append(part[:, :2].mean(0), part[:, 2].min()) for part in parts])


def _followed(found: list[np.ndarray], people: int) -> np.ndarray:
    """The surest people of a frame, ``(people, 9, 2)``, from left to right."""
    best = sorted(found, key=lambda joints: -joints[:, 2].sum())[:people]
    best.sort(key=lambda joints: joints[1, 0])
    poses = np.full((people, 9, 2), np.nan)
    for row, joints in enumerate(best):
        seen = np.isfinite(joints).all(1) & (joints[:, 2] > SURE)
        poses[row, seen] = joints[seen, :2]
    return poses


def _parsed(file: Path) -> Any:
    try:
        return json.loads(read_text(file))
    except (ValueError, RecursionError) as error:
        raise FormatError(file, f"this is no JSON ({error})") from None
