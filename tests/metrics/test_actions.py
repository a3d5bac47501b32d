"""Metrics of actions and poses against naive twins."""

from __future__ import annotations

import numpy as np
import pytest

from motioncast.core.skeletons import UPPER9
from motioncast.metrics.actions import asymmetry, looks_real, pixel_errors, pose_errors, scaled_pose_errors, top_k

RANDOM = np.random.default_rng(0)
MADE, REAL = RANDOM.normal(size=(2, 3, 4, 9, 3))
NECK = UPPER9.index("neck")


def test_errors_are_means_of_distances_from_the_neck():
    for window in range(3):
        for step in range(4):
            made = [joint - MADE[window, step, NECK] for joint in MADE[window, step]]
            real = [joint - REAL[window, step, NECK] for joint in REAL[window, step]]
            naive = np.mean([np.sqrt(np.sum((a - b) ** 2)) for a, b in zip(made, real, strict=True)])
            assert pose_errors(MADE, REAL)[window, step] == pytest.approx(naive)


def test_pixels_count_where_joints_are_seen():
    seen = RANDOM.random((3, 4, 9)) < 0.6
    seen[0, 0] = False
    found = pixel_errors(MADE[..., :2], REAL[..., :2], seen)
    assert np.isnan(found[0, 0])
    apart = MADE[1, 2, :, :2] - MADE[1, 2, NECK, :2] - REAL[1, 2, :, :2] + REAL[1, 2, NECK, :2]
    naive = [np.hypot(*apart[joint]) for joint in range(9) if seen[1, 2, joint]]
    assert found[1, 2] == pytest.approx(np.mean(naive))


def test_the_best_scale_is_the_best():
    found = scaled_pose_errors(MADE[0, 0], REAL[0, 0])
    made, real = MADE[0, 0] - MADE[0, 0, NECK], REAL[0, 0] - REAL[0, 0, NECK]
    factors = np.linspace(-3, 3, 6001)
    squares = [((factor * made - real) ** 2).sum() for factor in factors]
    best = factors[int(np.argmin(squares))]
    assert found == pytest.approx(np.linalg.norm(best * made - real, axis=-1).mean(), abs=1e-3)


def test_asymmetry_is_the_mean_of_three_differences():
    pose = np.zeros((9, 3))
    at = UPPER9.index
    pose[at("right_shoulder")], pose[at("left_shoulder")] = (-0.2, 0, 0), (0.17, 0, 0)
    pose[at("right_elbow")], pose[at("left_elbow")] = (-0.2, -0.3, 0), (0.17, -0.3, 0)
    pose[at("right_wrist")], pose[at("left_wrist")] = (-0.2, -0.3, 0.3), (0.17, -0.3, 0.24)
    assert asymmetry(pose) == pytest.approx((0.03 + 0 + 0.06) / 3)


def test_top_k_is_among_the_best_sorted():
    scores, truth = RANDOM.random((50, 7)), RANDOM.integers(7, size=50)
    for k in (1, 3, 7):
        naive = [truth[row] in sorted(range(7), key=lambda label: -scores[row, label])[:k] for row in range(50)]
        np.testing.assert_array_equal(top_k(scores, truth, k), naive)


def test_a_classifier_reads_shoulder_widths():
    weights = [(np.eye(27), np.zeros(27)), (np.ones((27, 1)), np.array([-3.0]))]
    poses = MADE[0]
    naive = []
    for pose in poses:
        across = np.linalg.norm(pose[5] - pose[2])
        naive.append(np.maximum(((pose - pose[NECK]) / across).ravel(), 0).sum() > 3 or False)
    # the first layer is linear before its ReLU, which the second layer's input applies
    np.testing.assert_array_equal(looks_real(poses, weights), naive)
    np.testing.assert_array_equal(looks_real(2.5 * poses, weights), naive)
