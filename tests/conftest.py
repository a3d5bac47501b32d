"""Fixtures that every test may use: the open data beside the checkout, and a small made-up scene."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from hypothesis import settings

from motioncast.core.scene import Scene
from motioncast.core.skeletons import MRT15

settings.register_profile("motioncast", derandomize=True, max_examples=30, deadline=None)
settings.load_profile("motioncast")

STANDING = {
    "pelvis": (0, 0, 0.95), "neck": (0, 0, 1.45), "head": (0, 0, 1.62),
    "hip": (0.1, 0, 0.92), "knee": (0.12, -0.02, 0.50), "ankle": (0.12, 0.02, 0.09),
    "shoulder": (0.17, 0, 1.40), "elbow": (0.24, 0, 1.12), "wrist": (0.26, -0.05, 0.88),
}  # fmt: skip


@pytest.fixture(scope="session")
def shared() -> Path:
    """The folder of open motion data beside the checkout; the test is skipped where there is none."""
    folder = Path(__file__).parents[2] / "shared" / "data"
    if not folder.is_dir():
        pytest.skip(f"needs the open motion data in {folder}")
    return folder


def standing_pose() -> np.ndarray:
    """A person of 1.7 m who stands at the origin and faces -y, ``(15, 3)``."""
    pose = []
    for name in MRT15.names:
        side, _, place = name.partition("_")
        x, y, z = STANDING[place or name]
        pose.append((-x if side == "right" else x, y, z))
    return np.array(pose, np.float32)


@pytest.fixture
def walkers() -> Scene:
    """Two people who walk towards one another for two seconds at 30 fps and swing their arms a little."""
    seconds = np.arange(60) / 30
    positions = np.broadcast_to(standing_pose(), (60, 2, 15, 3)).copy()
    for person, direction in enumerate((1.0, -1.0)):
        positions[:, person, :, 0] += (direction * (seconds - 2.5))[:, None]
        positions[:, person, :, 1] += 0.3 * person
        for wrist, phase in (("left_wrist", 0.0), ("right_wrist", np.pi)):
            positions[:, person, MRT15.index(wrist), 0] += 0.1 * np.sin(2 * np.pi * seconds + phase)
    return Scene(positions, MRT15, 30.0, people=("ada", "bea"), source="made up for tests")
