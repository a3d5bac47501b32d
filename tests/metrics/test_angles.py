from __future__ import annotations

import numpy as np
import pytest

from motioncast.core.rotation import conjugate, from_axis_angle, multiply, to_axis_angle
from motioncast.metrics.angles import angle_errors, joint_angle_error_at


@pytest.fixture
def turns() -> tuple[np.ndarray, np.ndarray]:
    random = np.random.default_rng(5)
    return tuple(from_axis_angle(random.normal(size=(4, 3, 2, 5, 3))) for _ in range(2))  # pyright: ignore[reportReturnType]


def test_it_is_the_angle_of_the_turn_between(turns: tuple[np.ndarray, np.ndarray]) -> None:
    one, other = turns
    between = np.linalg.norm(to_axis_angle(multiply(one, conjugate(other))), axis=-1)
    np.testing.assert_allclose(angle_errors(one, other), between)


def test_small_and_half_turns_are_exact() -> None:
    still = np.array([1.0, 0, 0, 0])
    for angle in (1e-9, 1e-3, np.pi):
        assert angle_errors(from_axis_angle(np.array([0, angle, 0])), still) == pytest.approx(angle, rel=1e-7)


def test_naive_twin(turns: tuple[np.ndarray, np.ndarray]) -> None:
    one, other = turns
    observed = np.random.default_rng(0).random((4, 3, 2, 5)) < 0.7
    for frame in range(3):
        angles = [
            2 * np.arccos(min(1.0, abs(float(np.dot(one[w, frame, p, j], other[w, frame, p, j])))))
            for w in range(4) for p in range(2) for j in range(5) if observed[w, frame, p, j]
        ]  # fmt: skip
        assert joint_angle_error_at(one, other, observed)[frame] == pytest.approx(np.mean(angles))


def test_invariances(turns: tuple[np.ndarray, np.ndarray]) -> None:
    one, other = turns
    expected = joint_angle_error_at(one, other)
    assert joint_angle_error_at(one, one).max() == 0
    np.testing.assert_allclose(joint_angle_error_at(-one, other), expected)
    np.testing.assert_allclose(joint_angle_error_at(one[:, :, ::-1], other[:, :, ::-1]), expected)
    np.testing.assert_allclose(joint_angle_error_at(*(np.repeat(turn, 64, 0) for turn in turns)), expected)
    turn = from_axis_angle(np.array([0.3, -0.2, 1.0]))
    np.testing.assert_allclose(joint_angle_error_at(multiply(turn, one), multiply(turn, other)), expected)
