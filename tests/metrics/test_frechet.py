from __future__ import annotations

import numpy as np
import pytest

from motioncast.metrics.frechet import SPACES, frechet, frechet_in, matrix_root

HIPS = (0, 1)


def test_the_square_of_the_root_is_the_matrix() -> None:
    half = np.random.default_rng(0).normal(size=(6, 4))
    matrix = half @ half.T  # two directions have no spread at all
    root = matrix_root(matrix)
    np.testing.assert_allclose(root @ root, matrix, atol=1e-12)
    np.testing.assert_allclose(root, root.T, atol=1e-12)


def test_scipy_takes_the_same_root() -> None:
    linalg = pytest.importorskip("scipy.linalg")
    random = np.random.default_rng(1)
    one, other = random.normal(size=(60, 5)), random.normal(size=(80, 5)) @ random.normal(size=(5, 5)) + 1
    a, b = np.cov(one.T), np.cov(other.T)
    gap = np.square(one.mean(0) - other.mean(0)).sum()
    expected = gap + np.trace(a + b - 2 * np.real(linalg.sqrtm(a @ b)))
    assert frechet(one, other) == pytest.approx(expected)


def test_independent_features_add_up() -> None:
    random = np.random.default_rng(2)
    one = np.linalg.qr(random.normal(size=(50, 3)))[0]
    one -= one.mean(0)
    one = np.linalg.qr(one)[0] * np.sqrt(49)  # mean 0, covariance 1
    scales, shift = np.array([1.0, 2.0, 5.0]), np.array([1.0, 0.0, -2.0])
    assert frechet(one, one * scales + shift) == pytest.approx(np.square(shift).sum() + np.square(scales - 1).sum())


def test_symmetric_and_blind_to_order_and_to_a_common_turn() -> None:
    random = np.random.default_rng(3)
    one, other = random.normal(size=(40, 4)), random.normal(size=(50, 4)) * 2
    turn = np.linalg.qr(random.normal(size=(4, 4)))[0]
    distance = frechet(one, other)
    assert frechet(other, one) == pytest.approx(distance)
    assert frechet(one[::-1], other) == pytest.approx(distance)
    assert frechet(one @ turn + 7, other @ turn + 7) == pytest.approx(distance)
    assert frechet(one, one) == pytest.approx(0, abs=1e-9)


def test_fewer_items_than_features() -> None:
    random = np.random.default_rng(4)
    few = random.normal(size=(5, 30))
    assert frechet(few, few) == pytest.approx(0, abs=1e-6)
    assert frechet(few, few + 1) == pytest.approx(30)


@pytest.mark.parametrize("space", SPACES)
def test_the_space_names_the_figure_and_the_place_does_not_matter(space: str) -> None:
    random = np.random.default_rng(5)
    motion, real = random.normal(size=(2, 3, 20, 4, 3))
    turn = np.array([[0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    figures = frechet_in(space, motion, real, HIPS)
    assert list(figures) == [f"frechet_{space}"]
    moved = frechet_in(space, motion @ turn + [5.0, -3.0, 0.0], real, HIPS)
    assert moved[f"frechet_{space}"] == pytest.approx(figures[f"frechet_{space}"])


def test_words_tell_how_people_move_and_poses_do_not() -> None:
    random = np.random.default_rng(6)
    poses = random.normal(size=(400, 4, 3))
    still = np.repeat(poses[:, None], 8, 1)
    walking = still + np.arange(8)[:, None, None] * [0.0, 0.2, 0.0]
    assert frechet_in("pose", walking, still, HIPS)["frechet_pose"] == pytest.approx(0, abs=1e-6)
    assert frechet_in("word8", walking, still, HIPS)["frechet_word8"] > 1
