from __future__ import annotations

import numpy as np
import pytest

from motioncast.core import rotation
from motioncast.inference.turns import best_turns


def turns_of(after: np.ndarray, before: np.ndarray) -> np.ndarray:
    """Turns ``(..., 3, 3)`` of vectors ``(..., n, 3)``."""
    return np.moveaxis(best_turns(np.moveaxis(np.swapaxes(after, -1, -2) @ before, (-2, -1), (0, 1))), (0, 1), (-2, -1))


@pytest.mark.parametrize("vectors", [2, 3, 8])
def test_the_turns_are_those_of_singular_values(vectors: int) -> None:
    random = np.random.default_rng(vectors)
    before = random.normal(size=(40, 5, vectors, 3)) * 10.0 ** random.uniform(-3, 3, (40, 5, 1, 1))
    turn = rotation.normalise(random.normal(size=(40, 5, 4)))
    after = rotation.rotate(turn[:, :, None], before) + 0.1 * np.abs(before) * random.normal(size=before.shape)
    fit = np.swapaxes(after, -1, -2) @ before
    turns, oracle = turns_of(after, before), rotation.to_matrix(rotation.kabsch(before, after))
    size = np.linalg.norm(fit, axis=(-1, -2))
    assert (((oracle - turns) * fit).sum((-1, -2)) < 3e-6 * size).all()
    np.testing.assert_allclose(turns @ np.swapaxes(turns, -1, -2), np.broadcast_to(np.eye(3), turns.shape), atol=1e-12)
    assert (np.linalg.det(turns) > 0).all()
    singular = np.linalg.svd(fit)[1]
    clear = singular[..., 1] - singular[..., 2] > 0.05 * size
    np.testing.assert_allclose(turns[clear], oracle[clear], atol=1e-4)


def test_a_line_turns_without_a_twist_of_its_own() -> None:
    """Vectors along one line leave the twist about it open; rounding must not choose it."""
    line = np.array([[0.0, 0.0, 0.3]]) + np.random.default_rng(0).normal(0, 1e-12, (50, 1, 3))
    turns = turns_of(line, np.array([[0.0, 0.0, 0.3]]))
    np.testing.assert_allclose(turns, np.broadcast_to(np.eye(3), turns.shape), atol=1e-4)


def test_nothing_to_fit_is_no_turn() -> None:
    np.testing.assert_allclose(best_turns(np.zeros((3, 3, 1)))[..., 0], np.eye(3))
