"""Fixtures that every test may use: the open data beside the checkout, and a small made-up scene."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from hypothesis import settings

from motioncast.core.scene import Scene
from motioncast.core.skeletons import MRT15
from motioncast.testing.scenes import standing_pose

settings.register_profile("motioncast", derandomize=True, max_examples=30, deadline=None)
settings.load_profile("motioncast")


@pytest.fixture(scope="session")
def shared() -> Path:
    """The folder of open motion data beside the checkout; the test is skipped where there is none."""
    folder = Path(__file__).parents[2] / "shared" / "data"
    if not folder.is_dir():
        pytest.skip(f"needs the open motion data in {folder}")
    return folder


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
