"""cmu-actions: labelled runs, sessions strung from them, other people's poses."""

from __future__ import annotations

from itertools import groupby
from pathlib import Path

import numpy as np
import pytest

from motioncast.core.skeletons import UPPER9
from motioncast.datasets import cmu
from motioncast.datasets.cmu_actions import BEGINNINGS, LABELS, SPLITS, Run, bank, read_labels, runs, session
from motioncast.errors import FormatError, InputError


def made_up() -> list[Run]:
    random = np.random.default_rng(0)
    body = np.zeros((9, 3))
    body[UPPER9.index("neck")], body[UPPER9.index("pelvis")] = (0, 0, 1.45), (0, 0, 0.95)
    actions = ("jumping jack", "twist", "squat", "jog")
    return [Run(f"take {action}", action, body + random.normal(0, 0.02, (4, 9, 3))) for action in actions]


def test_a_session_begins_as_said_keeps_a_run_together_and_changes_to_another():
    for number in range(20):
        one = session(made_up(), number)
        told = [LABELS[action] for action in one.actions[:, 0]]
        assert told[0] in BEGINNINGS
        assert max(len(list(part)) for _, part in groupby(told)) <= 5
        assert len(one) == 16
    np.testing.assert_array_equal(session(made_up(), 3).pixels, session(made_up(), 3).pixels)
    assert (session(made_up(), 3).pixels != session(made_up(), 4).pixels).any()


def test_poses_come_from_the_runs_and_the_camera_sees_them():
    available = made_up()
    one = session(available, 0)
    known = {pose.tobytes() for run in available for pose in run.poses}
    assert all(pose.tobytes() in known for pose in one.positions[:, 0])
    assert np.abs(one.pixels - one.camera.project(one.positions)).max() < 30


def test_whole_takes_lie_in_one_split_and_subjects_of_the_main_test_are_named():
    assert set(SPLITS.values()) == {"train", "validation", "test"}
    main = {name: cmu.split_of(int(name[:2]), int(name[3:])) for name in SPLITS}
    assert {name for name, split in main.items() if split == "test"} == {name for name in SPLITS if name[:2] != "02"}


def test_labels_are_read_and_damage_is_named(tmp_path):
    path = tmp_path / "action_labels.csv"
    path.write_text("name,first_frame,end_frame,action\n13_29,0,468,jumping jack\n", "utf-8")
    assert read_labels(tmp_path) == {"13_29": [(0, 468, "jumping jack")]}
    path.write_text("name,first_frame,end_frame,action\n13_29,0,468,cartwheel\n", "utf-8")
    with pytest.raises(FormatError, match=":2:"):
        read_labels(tmp_path)
    with pytest.raises(InputError, match="holds no action_labels"):
        read_labels(tmp_path / "none")


@pytest.mark.data
def test_real_runs_are_as_many_as_the_page_says(shared: Path) -> None:
    found = {split: runs(shared, split) for split in ("train", "validation", "test")}
    assert {split: len(some) for split, some in found.items()} == {"train": 19, "validation": 6, "test": 7}
    takes = [{run.take for run in some} for some in found.values()]
    assert len(set.union(*takes)) == sum(map(len, takes))
    poses = bank(shared)
    assert len(poses) > 5000
    np.testing.assert_array_equal(poses[:, 1], 0)
