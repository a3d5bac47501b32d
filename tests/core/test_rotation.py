"""Quaternions: a group, and in agreement with SciPy."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from motioncast.core import rotation

seeds = st.integers(0, 10_000)


def some(seed: int, count: int = 6) -> Rotation:
    return Rotation.random(count, random_state=seed)


def ours(turns: Rotation) -> np.ndarray:
    return turns.as_quat(scalar_first=True)


def same(a: np.ndarray, b: np.ndarray) -> None:
    np.testing.assert_allclose(rotation.to_matrix(a), rotation.to_matrix(b), atol=1e-9)


@given(seeds)
def test_group(seed):
    a, b, c = ours(some(seed)), ours(some(seed + 1)), ours(some(seed + 2))
    same(rotation.multiply(a, rotation.multiply(b, c)), rotation.multiply(rotation.multiply(a, b), c))
    same(rotation.multiply(a, rotation.conjugate(a)), np.broadcast_to(rotation.IDENTITY, a.shape))
    same(rotation.multiply(a, rotation.IDENTITY), a)
    vector = np.random.default_rng(seed).normal(size=(6, 3))
    np.testing.assert_allclose(
        rotation.rotate(rotation.multiply(a, b), vector), rotation.rotate(a, rotation.rotate(b, vector)), atol=1e-9
    )
    np.testing.assert_allclose(rotation.rotate(a, vector), some(seed).apply(vector), atol=1e-9)


@given(seeds, st.sampled_from(["xyz", "xzy", "yxz", "yzx", "zxy", "zyx"]))
def test_euler_angles_agree_with_scipy(seed, order):
    turns = some(seed)
    np.testing.assert_allclose(rotation.to_euler(ours(turns), order), turns.as_euler(order.upper()), atol=1e-7)
    same(rotation.from_euler(turns.as_euler(order.upper()), order), ours(turns))


@pytest.mark.parametrize("order", ["zxy", "xyz", "yxz"])
@pytest.mark.parametrize("middle", [np.pi / 2, -np.pi / 2])
def test_gimbal_lock_still_gives_the_rotation(order, middle):
    locked = rotation.from_euler(np.array([0.4, middle, 0.3]), order)
    np.testing.assert_allclose(
        rotation.to_matrix(rotation.from_euler(rotation.to_euler(locked, order), order)),
        rotation.to_matrix(locked), atol=1e-6,
    )  # fmt: skip


@given(seeds)
def test_other_forms_agree_with_scipy(seed):
    turns = some(seed)
    np.testing.assert_allclose(rotation.to_matrix(ours(turns)), turns.as_matrix(), atol=1e-9)
    same(rotation.from_matrix(turns.as_matrix()), ours(turns))
    np.testing.assert_allclose(rotation.to_axis_angle(ours(turns)), turns.as_rotvec(), atol=1e-7)
    same(rotation.from_axis_angle(turns.as_rotvec()), ours(turns))


@given(seeds)
def test_between_swings_one_direction_into_the_other(seed):
    start, end = np.random.default_rng(seed).normal(size=(2, 5, 3))
    turned = rotation.rotate(rotation.between(start, end), start)
    np.testing.assert_allclose(np.cross(turned, end), 0, atol=1e-8)
    assert ((turned * end).sum(-1) > 0).all()
    opposite = rotation.rotate(rotation.between(start, -start), start)
    np.testing.assert_allclose(opposite, -start, atol=1e-7)
