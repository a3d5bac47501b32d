from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from motioncast.core.skeletons import H36M17
from motioncast.core.voxels import CELLS, SIDE_M, across, cell_of, corner_of, hip_centred, numbered, turned, turned_back
from motioncast.testing import walkers

VOXEL_M = SIDE_M / CELLS
ANGLES = st.floats(-np.pi, np.pi)


@given(st.lists(st.floats(-0.999, 0.999), min_size=3, max_size=3))
def test_a_point_is_within_a_voxel_of_its_lower_corner(point: list[float]) -> None:
    offset = np.array(point) - corner_of(cell_of(np.array(point)))
    assert (offset >= -1e-9).all()
    assert (offset < VOXEL_M + 1e-9).all()


def test_corners_and_cells_are_inverse_and_numbers_run_along_z() -> None:
    voxels = numbered()
    np.testing.assert_array_equal(cell_of(corner_of(voxels) + 1e-6), voxels)
    np.testing.assert_array_equal(voxels[:2], [[0, 0, 0], [0, 0, 1]])
    assert np.ravel_multi_index(tuple(voxels[1234]), (CELLS,) * 3) == 1234


@given(ANGLES)
def test_turning_back_is_the_inverse_and_keeps_heights(angle: float) -> None:
    axis, vector = np.array([np.cos(angle), np.sin(angle)]), np.array([0.3, -0.7, 1.1])
    np.testing.assert_allclose(turned_back(turned(vector, axis), axis), vector, atol=1e-12)
    assert turned(vector, axis)[2] == vector[2]


@given(ANGLES)
def test_motion_in_the_cube_knows_neither_place_nor_direction(angle: float) -> None:
    motion = walkers(people=1, frames=10).on(H36M17).positions[:, 0].astype(np.float64)
    axis = np.array([np.cos(angle), np.sin(angle)])
    moved = turned(motion, axis) + np.array([30, -4, 0.2])
    own, other = (hip_centred(here, across(here[-1], H36M17)) for here in (motion, moved))
    np.testing.assert_allclose(own, other, atol=1e-9)


def test_in_the_cube_the_right_side_is_right_and_the_hips_row_is_its_path() -> None:
    motion = walkers(people=1, frames=10).on(H36M17).positions[:, 0].astype(np.float64)
    own = hip_centred(motion, across(motion[-1], H36M17))
    right, left = (H36M17.landmarks.index(f"{side}_hip") for side in ("right", "left"))
    assert own[-1, right, 0] > 0.05 > -0.05 > own[-1, left, 0]
    np.testing.assert_array_equal(own[-1, 0], np.zeros(3))
    gone = np.linalg.norm(motion[0, 0] - motion[-1, 0])
    np.testing.assert_allclose(np.linalg.norm(own[0, 0]), gone)
    knee = H36M17.landmarks.index("right_knee")
    np.testing.assert_allclose(np.linalg.norm(own[0, knee]), np.linalg.norm(motion[0, knee] - motion[0, 0]))


def test_who_lies_on_the_side_faces_along_the_world() -> None:
    assert across(np.zeros((17, 3)), H36M17).tolist() == [1.0, 0.0]
