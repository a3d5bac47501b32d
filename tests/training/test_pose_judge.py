"""The classifier of poses."""

from __future__ import annotations

import numpy as np
import pytest

torch = pytest.importorskip("torch")

from motioncast.datasets import kitchen  # noqa: E402
from motioncast.metrics.actions import looks_real  # noqa: E402
from motioncast.training import pose_judge  # noqa: E402

pytestmark = pytest.mark.torch


def test_it_tells_real_poses_from_spoilt_ones_that_it_never_saw(monkeypatch):
    monkeypatch.setattr(pose_judge, "STEPS", 60)
    poses = kitchen.bank(1200).astype(np.float64)
    random = np.random.default_rng(0)
    made = pose_judge.spoilt(poses[:500], random)
    weights = pose_judge.judge_poses(poses[:500], made)
    assert looks_real(poses[600:], weights).mean() > 0.7
    assert looks_real(pose_judge.spoilt(poses[600:], random), weights).mean() < 0.4


def test_no_spoilt_pose_is_the_real_one():
    poses = kitchen.bank(50).astype(np.float64)
    spoilt = pose_judge.spoilt(poses, np.random.default_rng(0))
    assert (np.abs(spoilt - poses).max((1, 2)) > 1e-3).all()
