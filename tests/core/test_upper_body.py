"""How far away people stand, from the size of their trunks."""

from __future__ import annotations

import numpy as np
import pytest

from motioncast.core.camera import look_at
from motioncast.core.upper_body import NECK, PELVIS, TRUNK_M, depth_m
from motioncast.errors import SceneError

CAMERA = look_at(np.array([3.5, 0, 1.2]), np.array([0, 0, 1.2]))


def upright(trunk: float = TRUNK_M) -> np.ndarray:
    pose = np.zeros((9, 3))
    pose[NECK], pose[PELVIS] = (0, 0, 1.2 + trunk / 2), (0, 0, 1.2 - trunk / 2)
    return pose


def test_an_upright_person_of_usual_size_is_where_it_is():
    assert depth_m(CAMERA.project(upright())[None, None], 1000.0)[0] == pytest.approx(3.5)


def test_who_bends_is_no_farther_away_and_a_gap_does_not_matter():
    bent = upright()
    bent[NECK] = bent[PELVIS] + [0.0, 0.45, 0.1]
    pixels = CAMERA.project(np.stack([upright(), bent, bent]))[:, None]
    pixels[2, 0, NECK] = np.nan
    assert depth_m(pixels, 1000.0)[0] == pytest.approx(3.5)


def test_nobody_seen_is_refused():
    with pytest.raises(SceneError, match="person 2 are never seen together"):
        depth_m(np.stack([np.arange(18.0).reshape(9, 2), np.full((9, 2), np.nan)])[None], 1000.0)
