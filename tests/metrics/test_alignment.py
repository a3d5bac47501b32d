from __future__ import annotations

import numpy as np
import pytest

from motioncast.core.rotation import from_axis_angle, rotate
from motioncast.core.skeleton import Skeleton
from motioncast.core.skeletons import MRT15, SOMOF13
from motioncast.errors import SkeletonError
from motioncast.metrics.alignment import pa_mpjpe_at, procrustes, root_aligned_mpjpe_at, root_error_at, root_joints

Pair = tuple[np.ndarray, np.ndarray, np.ndarray]


@pytest.fixture
def pair() -> Pair:
    random = np.random.default_rng(4)
    shape = (3, 2, 3, 6)
    return random.normal(size=(*shape, 3)), random.normal(size=(*shape, 3)), random.random(shape) < 0.8


def laid_on(forecast: np.ndarray, truth: np.ndarray) -> np.ndarray:
    """One pose, step by step: best turn by singular values, best scale for it, best shift."""
    a, b = forecast - forecast.mean(0), truth - truth.mean(0)
    left, stretch, right = np.linalg.svd(b.T @ a)
    flip = np.diag([1, 1, np.sign(np.linalg.det(left) * np.linalg.det(right))])
    scale = np.trace(np.diag(stretch) @ flip) / (a**2).sum()
    return np.array([scale * left @ flip @ right @ joint for joint in a]) + truth.mean(0)


def test_naive_twin_of_procrustes(pair: Pair) -> None:
    forecast, truth, observed = pair
    for index in np.ndindex(3, 2, 3):
        seen = observed[index]
        if seen.sum() < 3:
            continue
        mine = procrustes(forecast[index], truth[index], seen)[seen]
        np.testing.assert_allclose(mine, laid_on(forecast[index][seen], truth[index][seen]))


def test_no_other_similarity_comes_nearer(pair: Pair) -> None:
    forecast, truth, _ = (array[0, 0, 0] for array in pair)
    best = np.square(procrustes(forecast, truth) - truth).sum()
    random = np.random.default_rng(0)
    for _ in range(50):
        turn = from_axis_angle(random.normal(size=3) * 0.1)
        other = rotate(turn, procrustes(forecast, truth) * random.uniform(0.9, 1.1)) + random.normal(size=3) * 0.05
        assert np.square(other - truth).sum() >= best


def test_turning_moving_and_scaling_poses_changes_nothing(pair: Pair) -> None:
    forecast, truth, observed = pair
    turned = 0.3 * rotate(from_axis_angle(np.array([1.0, 2.0, 0.5])), forecast) + [1, 2, 3]
    np.testing.assert_allclose(pa_mpjpe_at(turned, truth, observed), pa_mpjpe_at(forecast, truth, observed))
    np.testing.assert_allclose(pa_mpjpe_at(turned, forecast), 0, atol=1e-12)


def test_a_mirror_image_is_another_pose(pair: Pair) -> None:
    _, truth, _ = pair
    assert pa_mpjpe_at(truth * [-1, 1, 1], truth).min() > 0.1


def test_a_pose_without_extent_lies_at_the_middle() -> None:
    truth = np.random.default_rng(0).normal(size=(5, 3))
    np.testing.assert_allclose(procrustes(np.ones((5, 3)), truth), np.broadcast_to(truth.mean(0), (5, 3)))


def test_naive_twins_of_pose_and_path(pair: Pair) -> None:
    forecast, truth, observed = pair
    root = [1, 4]
    for frame in range(2):
        pose, path = [], []
        for w in range(3):
            for p in range(3):
                if not observed[w, frame, p, root].all():
                    continue
                mine, true = forecast[w, frame, p], truth[w, frame, p]
                middle, right = (mine[1] + mine[4]) / 2, (true[1] + true[4]) / 2
                path.append(np.linalg.norm(middle - right))
                pose += [
                    np.linalg.norm((mine[j] - middle) - (true[j] - right)) for j in range(6) if observed[w, frame, p, j]
                ]
        assert root_aligned_mpjpe_at(forecast, truth, root, observed)[frame] == pytest.approx(np.mean(pose))
        assert root_error_at(forecast, truth, root, observed)[frame] == pytest.approx(np.mean(path))


def test_a_shift_is_an_error_of_the_path_alone(pair: Pair) -> None:
    _, truth, _ = pair
    shifted = truth + np.array([3.0, 4.0, 0.0])
    np.testing.assert_allclose(root_aligned_mpjpe_at(shifted, truth, [0]), 0, atol=1e-12)
    np.testing.assert_allclose(root_error_at(shifted, truth, [0]), 5)


def test_order_of_people_and_number_of_windows_change_nothing(pair: Pair) -> None:
    forecast, truth, observed = pair
    order = [2, 0, 1]
    turned = forecast[:, :, order], truth[:, :, order], observed[:, :, order]
    many = tuple(np.repeat(array, 64, 0) for array in pair)
    for f, t, o in (turned, many):
        np.testing.assert_allclose(pa_mpjpe_at(f, t, o), pa_mpjpe_at(*pair))
        np.testing.assert_allclose(root_error_at(f, t, [0], o), root_error_at(forecast, truth, [0], observed))
        mine = root_aligned_mpjpe_at(f, t, [0], o)
        np.testing.assert_allclose(mine, root_aligned_mpjpe_at(forecast, truth, [0], observed))


def test_the_root_is_a_place_of_the_body() -> None:
    assert root_joints(MRT15) == (MRT15.index("pelvis"),)
    assert root_joints(SOMOF13) == (SOMOF13.index("left_hip"), SOMOF13.index("right_hip"))
    with pytest.raises(SkeletonError, match="neither a pelvis nor two hips"):
        root_joints(Skeleton(("hand",), (-1,), ("left_hand",)))
