"""The scene: masks, slices, people, and joining takes."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from motioncast.core.scene import Scene, join
from motioncast.core.skeletons import COCO17, MRT15, SOMOF13
from motioncast.errors import SceneError, SkeletonError


def test_unseen_joints_are_zero_and_may_hold_anything(walkers):
    seen = walkers.observed.copy()
    seen[3, 1, 4] = False
    positions = walkers.positions.copy()
    positions[3, 1, 4] = np.nan
    assert (replace(walkers, positions=positions, observed=seen).positions[3, 1, 4] == 0).all()
    with pytest.raises(SceneError, match=r"right_hip.*person 2 in frame 3"):
        replace(walkers, positions=positions, observed=None)


@pytest.mark.parametrize("fps", [0, -1, np.nan, np.inf])
def test_a_frame_rate_is_positive(fps):
    with pytest.raises(SceneError, match="frame rate"):
        Scene(np.zeros((1, 1, 15, 3)), MRT15, fps)


def test_shapes_are_checked():
    with pytest.raises(SceneError, match="15 joints"):
        Scene(np.zeros((1, 1, 13, 3)), MRT15, 30)
    with pytest.raises(SceneError, match="mask"):
        Scene(np.zeros((1, 1, 15, 3)), MRT15, 30, np.ones((1, 1, 3), bool))
    with pytest.raises(SceneError, match="ids"):
        Scene(np.zeros((1, 2, 15, 3)), MRT15, 30, people=("a", "a"))


def test_people_are_selected_by_name(walkers):
    assert walkers.select(["bea"]).people == ("bea",)
    np.testing.assert_array_equal(walkers.select(["bea", "ada"]).positions, walkers.positions[:, ::-1])
    with pytest.raises(SceneError, match='no person "eve"'):
        walkers.select(["eve"])


def test_takes_join_with_early_ends(walkers):
    short = replace(walkers[:40].select(["ada"]), people=("bea",))
    both = join([walkers, short])
    assert both.people == ("ada", "bea (1)", "bea (2)")
    assert both.observed[:40].all()
    assert not both.observed[40:, 2].any()
    with pytest.raises(SceneError, match="frames a second"):
        join([walkers, replace(walkers, fps=25)])
    with pytest.raises(SceneError, match="different joints"):
        join([walkers, walkers.on(SOMOF13)])
    with pytest.raises(SceneError, match="no motion"):
        join([])


def test_another_skeleton_by_landmarks(walkers):
    other = walkers.on(SOMOF13)
    knee = other.positions[:, :, SOMOF13.index("left_knee")]
    np.testing.assert_array_equal(knee, walkers.positions[:, :, MRT15.index("left_knee")])
    with pytest.raises(SkeletonError, match="left_eye"):
        walkers.on(COCO17)
