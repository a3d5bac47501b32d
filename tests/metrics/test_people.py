from __future__ import annotations

import numpy as np
import pytest

from motioncast.metrics.people import gaps, minimum_distance, nearest_approach, penetration, rod_distance

BONES = [(1, 0), (2, 1), (3, 1)]


@pytest.fixture
def motion() -> np.ndarray:
    """Motion ``(time 4, people 3, joints 4, 3)``, people near one another."""
    random = np.random.default_rng(9)
    return random.normal(size=(4, 3, 4, 3)) * 0.3 + random.normal(size=(3, 1, 3)) * 0.5


def distance(one: np.ndarray, other: np.ndarray, points: int = 101) -> float:
    """Least distance of points of two rods: a little too large."""
    shares = np.linspace(0, 1, points)[:, None]
    a, b = (rod[0] + shares * (rod[1] - rod[0]) for rod in (one, other))
    return float(np.linalg.norm(a[:, None] - b, axis=-1).min())


def test_naive_twin_of_the_distance_of_rods() -> None:
    random = np.random.default_rng(0)
    for number in range(30):
        one, other = random.normal(size=(2, 2, 3))
        other = other * [1, 1, 1 - number % 2]  # some far apart, some that nearly cross
        found = rod_distance(one, other)
        assert found == pytest.approx(distance(one, other), abs=0.03)
        assert found <= distance(one, other) + 1e-12
        assert rod_distance(other, one) == pytest.approx(found)
        assert rod_distance(one[::-1], other) == pytest.approx(found)


@pytest.mark.parametrize(
    ("other", "expected"),
    [
        ([[0, 1, 0], [2, 1, 0]], 1.0),  # beside, parallel
        ([[5, 0, 0], [7, 0, 0]], 3.0),  # behind, on one line
        ([[1, 0, 0], [3, 0, 0]], 0.0),  # overlapping on one line
        ([[1, -1, 0], [1, 1, 0]], 0.0),  # crossing
        ([[1, 2, 0], [1, 5, 0]], 2.0),  # pointing at the middle
        ([[4, 4, 0], [5, 9, 0]], np.hypot(2, 4)),  # end to end
        ([[1, 3, 0], [1, 3, 0]], 3.0),  # a point
        ([[5, 4, 0], [5, 4, 0]], 5.0),
    ],
)
def test_rods_in_every_position(other: list[list[float]], expected: float) -> None:
    assert rod_distance(np.array([[0.0, 0, 0], [2, 0, 0]]), np.array(other, float)) == pytest.approx(expected)


def test_nearly_parallel_rods() -> None:
    one = np.array([[0.0, 0, 0], [1, 0, 0]])
    for tilt in 10.0 ** -np.arange(1, 12):
        assert rod_distance(one, one + np.array([[0, 0.3, 0], [0, 0.3 + tilt, 0]])) == pytest.approx(0.3, abs=1e-6)


def test_naive_twin_of_gaps(motion: np.ndarray) -> None:
    radii = np.array([0.1, 0.05, 0.02])
    observed = np.random.default_rng(1).random(motion.shape[:-1]) < 0.8
    found = gaps(motion, BONES, radii, observed)
    assert found.shape == (4, 3)
    for t in range(4):
        for pair, (p, q) in enumerate([(0, 1), (0, 2), (1, 2)]):
            clear = [np.inf] + [
                float(rod_distance(motion[t, p, list(a)], motion[t, q, list(b)])) - radii[i] - radii[k]
                for i, a in enumerate(BONES) for k, b in enumerate(BONES)
                if observed[t, p, list(a)].all() and observed[t, q, list(b)].all()
            ]  # fmt: skip
            assert found[t, pair] == pytest.approx(min(clear))


def test_invariances(motion: np.ndarray) -> None:
    found = gaps(motion, BONES)
    turn = np.linalg.qr(np.random.default_rng(2).normal(size=(3, 3)))[0]
    np.testing.assert_allclose(gaps(motion @ turn + 7, BONES), found, atol=1e-9)
    np.testing.assert_allclose(np.sort(gaps(motion[:, [2, 0, 1]], BONES), -1), np.sort(found, -1))
    np.testing.assert_allclose(gaps(motion[2], BONES), found[2])
    assert minimum_distance(found) == found.min()


def test_people_who_are_alone_are_in_nobodys_way(motion: np.ndarray) -> None:
    alone = gaps(motion[:, :1], BONES)
    assert alone.shape == (4, 0)
    assert minimum_distance(alone) == np.inf
    assert penetration(alone) == (0.0, 0.0)
    unseen = gaps(motion, BONES, observed=np.zeros(motion.shape[:-1], bool))
    assert np.isinf(unseen).all()
    assert penetration(unseen) == (0.0, 0.0)


def test_people_who_walk_through_one_another() -> None:
    upright = np.array([[0.0, 0, 0], [0, 0, 1.7]])
    places = np.array([-0.3, -0.04, 0.0, 0.06, 0.3])
    motion = np.stack([np.stack([upright, upright + np.array([place, 0, 0])]) for place in places])
    share, depth = penetration(gaps(motion, [(1, 0)], radius_m=0.05))
    assert share == pytest.approx(0.6)
    assert depth == pytest.approx(np.mean([0.06, 0.1, 0.04]))
    assert penetration(gaps(motion, [(1, 0)], radius_m=0.05), tolerance_m=0.05)[0] == pytest.approx(0.4)


def test_naive_twin_of_nearest_approaches(motion: np.ndarray) -> None:
    path, observed = motion[:, :, 0, :2], np.ones((4, 3), bool)
    observed[1, 2] = observed[3, 0] = False
    for seen in (None, observed):
        expected = [
            min(
                np.hypot(*(path[t, one] - path[t, other]))
                for t in range(4) if seen is None or (seen[t, one] and seen[t, other])
            )
            for one, other in ((0, 1), (0, 2), (1, 2))
        ]  # fmt: skip
        np.testing.assert_allclose(nearest_approach(path, seen), expected)
    observed[:, 1] = False
    assert np.isnan(nearest_approach(path, observed)).tolist() == [True, False, True]
