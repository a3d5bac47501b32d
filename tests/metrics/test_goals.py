from __future__ import annotations

import math

import numpy as np
import pytest

from motioncast.core.skeletons import H36M17
from motioncast.metrics.goals import (
    PARTS,
    conditional_inception_score,
    diversity,
    diversity_weights,
    mpjpe_of_best,
    mpjpe_of_most_likely,
    part_errors,
)

SAMPLES, GOALS, JOINTS = 3, 4, 17


@pytest.fixture
def poses() -> np.ndarray:
    return np.random.default_rng(0).normal(size=(SAMPLES, GOALS, JOINTS, 3))


@pytest.fixture
def truth() -> np.ndarray:
    return np.random.default_rng(1).normal(size=(SAMPLES, JOINTS, 3))


def apart(one: np.ndarray, other: np.ndarray, weights: np.ndarray | None = None) -> float:
    """Distance of two poses, coordinate by coordinate."""
    total = 0.0
    for joint in range(len(one)):
        length = math.sqrt(sum((one[joint, axis] - other[joint, axis]) ** 2 for axis in range(3)))
        total += length * (1.0 if weights is None else weights[joint])
    return total / len(one)


def test_best_and_most_likely_are_what_loops_find(poses: np.ndarray, truth: np.ndarray) -> None:
    errors = [[apart(poses[s, g], truth[s]) for g in range(GOALS)] for s in range(SAMPLES)]
    np.testing.assert_allclose(mpjpe_of_best(poses, truth), [min(row) for row in errors])
    np.testing.assert_allclose(mpjpe_of_most_likely(poses, truth), [row[0] for row in errors])


def test_more_goals_never_make_the_best_worse(poses: np.ndarray, truth: np.ndarray) -> None:
    best = [mpjpe_of_best(poses[:, : count + 1], truth) for count in range(GOALS)]
    assert np.all(np.diff(best, axis=0) <= 0)
    assert np.any(np.diff(best, axis=0) < 0)


def test_diversity_is_what_loops_find(poses: np.ndarray) -> None:
    weights = diversity_weights(H36M17.landmarks)
    assert weights.sum() == JOINTS + 4
    for factor in (None, weights):
        found = [
            np.mean([apart(poses[s, a], poses[s, b], factor) for a in range(GOALS) for b in range(a)])
            for s in range(SAMPLES)
        ]
        np.testing.assert_allclose(diversity(poses, factor), found)
    assert diversity(poses[:, :1]).tolist() == [0.0] * SAMPLES


def test_the_inception_score_is_what_loops_find() -> None:
    p = np.random.default_rng(2).dirichlet(np.ones(5), (SAMPLES, GOALS))
    found = []
    for sample in p:
        marginal = [sum(row[label] for row in sample) / GOALS for label in range(5)]
        gains = [sum(row[label] * math.log(row[label] / marginal[label]) for label in range(5)) for row in sample]
        found.append(math.exp(sum(gains) / GOALS))
    np.testing.assert_allclose(conditional_inception_score(p), found)


def test_the_inception_score_knows_its_bounds() -> None:
    sure = np.eye(GOALS)[None]
    assert conditional_inception_score(sure).tolist() == pytest.approx([GOALS])
    assert conditional_inception_score(np.repeat(sure[:, :1], GOALS, 1)).tolist() == [1.0]


def test_parts_are_of_the_best_goal_and_hold_every_joint_once(poses: np.ndarray, truth: np.ndarray) -> None:
    places = [place for part in PARTS.values() for place in part]
    assert sorted(places) == sorted(H36M17.landmarks)
    parts = part_errors(poses, truth, H36M17.landmarks)
    whole = sum(len(PARTS[part]) * errors for part, errors in parts.items())
    np.testing.assert_allclose(np.asarray(whole) / JOINTS, mpjpe_of_best(poses, truth))
