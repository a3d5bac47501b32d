"""``motioncast forecast`` with a model of actions."""

from __future__ import annotations

import json

import numpy as np
import pytest

from motioncast.datasets import kitchen

MODEL = "futurehuman3d"
CAMERA = {"focal_px": 1000, "centre_px": [640, 360], "size_px": [1280, 720]}


@pytest.fixture
def video(tmp_path):
    """A folder of OpenPose's files, its steps, its camera."""
    cooks = kitchen.sequence("validation", 0)
    (tmp_path / "video").mkdir()
    lines = ["first\tend\taction"]
    for step, (pose, action) in enumerate(zip(cooks.pixels[:12, 0], cooks.actions[:12, 0], strict=True)):
        keypoints = np.zeros((25, 3))
        keypoints[:9, :2], keypoints[:9, 2] = pose, 0.9
        text = json.dumps({"people": [{"pose_keypoints_2d": keypoints.ravel().tolist()}]})
        (tmp_path / "video" / f"{step:012d}_keypoints.json").write_text(text, "utf-8")
        lines.append(f"{step}\t{step + 1}\t{cooks.labels[action]}")
    (tmp_path / "steps.tsv").write_text("\n".join([*lines, ""]), "utf-8")
    (tmp_path / "camera.json").write_text(json.dumps(CAMERA), "utf-8")
    return ["forecast", "video", "--model", MODEL]


TOLD = ["--actions", "steps.tsv", "--camera", "camera.json", "--objects", "tomato", "--objects", "flour"]


def test_ten_steps_are_told(command, video):
    done = command(*video, *TOLD)
    assert done.status == 0, done.err
    assert "10 steps ahead, 1 future" in done.out
    assert len([line for line in done.out.splitlines() if line[:1].isdigit()]) == 10


def test_json_is_as_published(command, video):
    answer = command(*video, *TOLD, "--samples", 3, "--json").answer("actions")
    assert len(answer["samples"]) == 3
    assert sum(sample["weight"] for sample in answer["samples"]) == pytest.approx(1, abs=1e-5)
    first = answer["samples"][0]["steps"][0]
    assert max(first["probabilities"][0]) == first["probabilities"][0][answer["labels"].index(first["actions"][0])]


@pytest.mark.parametrize(
    ("left_out", "sentence"),
    [("--actions", "what was done so far"), ("--camera", "which camera"), ("--objects", "which objects are there")],
)
def test_what_is_missing_is_said_in_one_sentence(command, video, left_out, sentence):
    given = [part for pair in zip(TOLD[::2], TOLD[1::2], strict=True) if pair[0] != left_out for part in pair]
    done = command(*video, *given)
    assert done.status == 2
    assert sentence in done.err
    assert len(done.err.splitlines()) == 1


def test_what_steps_do_not_have_is_refused(command, video):
    done = command(*video, *TOLD, "--seconds", 3)
    assert done.status == 2
    assert "leave --seconds" in done.err
    done = command("forecast", "video", "--model", "somoformer-fast", *TOLD)
    assert done.status == 2
    assert "no model of actions" in done.err
