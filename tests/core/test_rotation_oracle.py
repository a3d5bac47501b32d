"""Rotations: the axioms of the group, and SciPy as an independent reference."""

from __future__ import annotations

from itertools import permutations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation, Slerp

from motioncast.core import rotation

ORDERS = ["".join(axes) for axes in permutations("xyz")]
seeds = st.integers(0, 2**32 - 1)


def some(seed: int, count: int = 1) -> np.ndarray:
    """Random unit quaternions, ``(count, 4)``."""
    return rotation.normalise(np.random.default_rng(seed).normal(size=(count, 4)))


def scipy_of(quaternion: np.ndarray) -> Rotation:
    return Rotation.from_quat(np.roll(quaternion, -1, axis=-1))


def apart(a: np.ndarray, b: np.ndarray) -> float:
    """The largest angle between rotations, in radians; accurate for small ones."""
    difference = rotation.multiply(a, rotation.conjugate(b))
    return float(2 * np.arcsin(np.minimum(np.linalg.norm(difference[..., 1:], axis=-1), 1)).max())


@given(seeds)
def test_rotations_are_a_group(seed):
    a, b, c = some(seed, 3)
    assert apart(rotation.multiply(a, rotation.conjugate(a)), rotation.IDENTITY) < 1e-12
    assert apart(rotation.multiply(rotation.IDENTITY, a), a) < 1e-12
    left = rotation.multiply(rotation.multiply(a, b), c)
    right = rotation.multiply(a, rotation.multiply(b, c))
    np.testing.assert_allclose(left, right, atol=1e-12)
    np.testing.assert_allclose(np.linalg.norm(left), 1, atol=1e-12)


@given(seeds)
def test_products_turn_by_the_right_factor_first(seed):
    a, b = some(seed, 2)
    vector = np.random.default_rng(seed).normal(size=3)
    one_by_one = rotation.rotate(a, rotation.rotate(b, vector))
    np.testing.assert_allclose(rotation.rotate(rotation.multiply(a, b), vector), one_by_one, atol=1e-12)
    reference = (scipy_of(a) * scipy_of(b)).apply(vector)
    np.testing.assert_allclose(one_by_one, reference, atol=1e-12)


@given(seeds)
def test_matrices_agree_with_scipy_and_come_back(seed):
    q = some(seed, 5)
    matrix = rotation.to_matrix(q)
    np.testing.assert_allclose(matrix, scipy_of(q).as_matrix(), atol=1e-12)
    assert apart(rotation.from_matrix(matrix), q) < 1e-7


@pytest.mark.parametrize("axis", range(3))
def test_matrices_of_half_turns_come_back(axis):
    half = np.zeros(4)
    half[axis + 1] = 1  # w is zero: the naive formula divides by it
    assert apart(rotation.from_matrix(rotation.to_matrix(half)), half) < 1e-9


@given(seeds)
def test_rotation_vectors_agree_with_scipy_and_come_back(seed):
    q = some(seed, 5)
    vector = rotation.to_axis_angle(q)
    np.testing.assert_allclose(vector, scipy_of(q).as_rotvec(), atol=1e-9)
    assert apart(rotation.from_axis_angle(vector), q) < 1e-9
    np.testing.assert_allclose(rotation.to_axis_angle(-q), vector, atol=1e-9)


@pytest.mark.parametrize("angle", [0.0, 1e-12, 1e-9, 1e-7, 1e-5, np.pi - 1e-6, np.pi])
def test_rotation_vectors_are_exact_near_rest_and_near_half_turns(angle):
    vector = angle * np.array([2.0, -1.0, 2.0]) / 3
    back = rotation.to_axis_angle(rotation.from_axis_angle(vector))
    np.testing.assert_allclose(back, vector, rtol=1e-7, atol=1e-15)


@pytest.mark.parametrize("order", ORDERS)
@given(seed=seeds)
def test_euler_angles_agree_with_scipy_and_come_back(order, seed):
    angles = np.random.default_rng(seed).uniform(-np.pi, np.pi, (4, 3))
    q = rotation.from_euler(angles, order)
    reference = Rotation.from_euler(order.upper(), angles)  # upper case: each axis turns with the ones before
    np.testing.assert_allclose(rotation.to_matrix(q), reference.as_matrix(), atol=1e-12)
    back = rotation.to_euler(q, order)
    assert apart(rotation.from_euler(back, order), q) < 1e-6
    assert (np.abs(back[:, 1]) <= np.pi / 2).all()


@pytest.mark.parametrize("order", ORDERS)
@pytest.mark.parametrize("middle", [np.pi / 2, -np.pi / 2, np.pi / 2 - 1e-5, np.pi / 2 - 1e-4, 1e-4 - np.pi / 2])
def test_gimbal_lock_loses_no_rotation(order, middle):
    q = rotation.from_euler(np.array([0.4, middle, -1.1]), order)
    back = rotation.to_euler(q, order)
    assert np.isfinite(back).all()
    assert apart(rotation.from_euler(back, order), q) < 5e-5


def test_fewer_than_three_euler_angles():
    two = rotation.from_euler(np.array([0.3, -0.5]), "zx")
    assert apart(two, rotation.from_euler(np.array([0.3, -0.5, 0.0]), "zxy")) < 1e-12


@given(seeds, st.floats(0, 1))
def test_slerp_agrees_with_scipy(seed, share):
    a, b = some(seed, 2)
    reference = Slerp([0, 1], Rotation.concatenate([scipy_of(a), scipy_of(b)]))(share)
    turned = rotation.slerp(a, b, share)
    np.testing.assert_allclose(rotation.to_matrix(turned), reference.as_matrix(), atol=1e-7)
    other_sign = rotation.slerp(a, -b, share)  # -b is the same rotation
    assert apart(other_sign, turned) < 1e-7


def test_slerp_ends_and_batches():
    a, b = some(1, 6), some(2, 6)
    assert apart(rotation.slerp(a, b, 0.0), a) < 1e-9
    assert apart(rotation.slerp(a, b, 1.0), b) < 1e-9
    shares = np.linspace(0, 1, 6)
    one_by_one = [rotation.slerp(a[i], b[i], shares[i]) for i in range(6)]
    np.testing.assert_allclose(rotation.slerp(a, b, shares), one_by_one, atol=1e-12)


@given(seeds)
def test_between_turns_one_direction_into_the_other_by_the_shortest_way(seed):
    start, end = np.random.default_rng(seed).normal(size=(2, 3))
    q = rotation.between(start, end)
    turned = rotation.rotate(q, start / np.linalg.norm(start))
    np.testing.assert_allclose(turned, end / np.linalg.norm(end), atol=1e-9)
    angle = np.arccos(np.clip(start @ end / np.linalg.norm(start) / np.linalg.norm(end), -1, 1))
    np.testing.assert_allclose(np.linalg.norm(rotation.to_axis_angle(q)), angle, atol=1e-6)


@pytest.mark.parametrize("direction", [*np.eye(3), np.array([1.0, 1.0, 1.0]), np.array([0.0, -3.0, 4.0])])
@pytest.mark.parametrize("bend", [0.0, 1e-9, 1e-5, 1e-3])
def test_between_opposite_directions(direction, bend):
    opposite = -direction + bend * np.roll(direction, 1)
    q = rotation.between(direction, opposite)
    np.testing.assert_allclose(np.linalg.norm(q), 1, atol=1e-12)
    turned = rotation.rotate(q, direction / np.linalg.norm(direction))
    np.testing.assert_allclose(turned, opposite / np.linalg.norm(opposite), atol=1e-4)


def test_between_a_zero_vector_is_the_identity():
    np.testing.assert_array_equal(rotation.between(np.zeros(3), np.eye(3)), np.tile(rotation.IDENTITY, (3, 1)))


@given(seeds)
def test_kabsch_agrees_with_scipy(seed):
    random = np.random.default_rng(seed)
    rest, bones = random.normal(size=(2, 4, 3))
    expected, _ = Rotation.align_vectors(bones, rest)
    np.testing.assert_allclose(rotation.to_matrix(rotation.kabsch(rest, bones)), expected.as_matrix(), atol=1e-6)


@given(seeds, st.integers(2, 5))
def test_kabsch_finds_the_rotation_even_of_flat_bones(seed, count):
    rest = np.random.default_rng(seed).normal(size=(count, 3))
    rest[:, 2] = 0  # a plane, whose mirror image fits as well: the answer must not be one
    q = some(seed)[0]
    assert apart(rotation.kabsch(rest, rotation.rotate(q, rest)), q) < 1e-5


def test_normalise_makes_the_identity_of_nothing():
    np.testing.assert_array_equal(rotation.normalise(np.zeros(4)), rotation.IDENTITY)
    np.testing.assert_allclose(rotation.normalise(np.array([0.0, 0.0, 0.0, -5.0])), [0, 0, 0, -1])
