"""The pinhole camera against its own definition."""

from __future__ import annotations

import numpy as np
import pytest

from motioncast.core.camera import Camera, look_at
from motioncast.core.rotation import to_matrix
from motioncast.errors import InputError

CAMERA = look_at(np.array([2.5, -1.5, 1.6]), np.array([0.1, 0.2, 1.1]), 900.0, (640.0, 480.0))


def test_what_it_looks_at_is_in_the_middle_and_up_is_up():
    np.testing.assert_allclose(CAMERA.project(np.array([0.1, 0.2, 1.1])), [320, 240], atol=1e-9)
    above = CAMERA.project(np.array([0.1, 0.2, 1.3]))
    assert above[1] < 240
    assert above[0] == pytest.approx(320)


def test_projection_is_that_of_the_matrices():
    points = np.random.default_rng(0).normal((0, 0, 1.1), 0.3, (20, 3))
    x, y, z = ((points - CAMERA.position) @ to_matrix(CAMERA.rotation)).T
    expected = np.stack([320 + 900 * x / -z, 240 - 900 * y / -z], -1)
    np.testing.assert_allclose(CAMERA.project(points), expected)


def test_a_pixel_and_its_depth_are_the_point_again():
    points = np.random.default_rng(1).normal((0, 0, 1.1), 0.3, (5, 4, 3))
    again = CAMERA.unproject(CAMERA.project(points), -CAMERA.seen(points)[..., 2])
    np.testing.assert_allclose(CAMERA.to_world(again), points, atol=1e-9)


def test_what_is_behind_has_no_place():
    assert np.isnan(CAMERA.project(2 * CAMERA.position - [0.1, 0.2, 1.1])).all()


def test_absurd_cameras_are_refused():
    with pytest.raises(InputError, match="straight up or down"):
        look_at(np.array([0, 0, 3.0]), np.zeros(3))
    with pytest.raises(InputError, match="focal length"):
        Camera(0, np.ones(2), np.ones(2), np.zeros(3), np.array([1.0, 0, 0, 0]))
    with pytest.raises(InputError, match="position"):
        Camera(1, np.ones(2), np.ones(2), np.full(3, np.nan), np.array([1.0, 0, 0, 0]))
