from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from motioncast.metrics.physical import bone_length_drift, foot_skating, mean_jerk, seam_jump, velocity_change

BONES = [(1, 0), (2, 1), (3, 0)]


@pytest.fixture
def motion() -> np.ndarray:
    """Motions ``(windows 2, people 3, time 9, joints 4, 3)``."""
    return np.cumsum(np.random.default_rng(8).normal(size=(2, 3, 9, 4, 3)) * 0.02, 2)


@pytest.fixture
def observed(motion: np.ndarray) -> np.ndarray:
    return np.random.default_rng(0).random(motion.shape[:-1]) < 0.95


def test_naive_twin_of_skating(motion: np.ndarray, observed: np.ndarray) -> None:
    feet, ground = [1, 3], [0.01, -0.02]
    for index in np.ndindex(2, 3):
        slides = []
        for t in range(1, 9):
            for foot, level in zip(feet, ground, strict=True):
                if observed[(*index, t, foot)] and observed[(*index, t - 1, foot)]:
                    step, height = (
                        motion[(*index, t, foot)] - motion[(*index, t - 1, foot)],
                        motion[(*index, t, foot, 2)],
                    )
                    weight = min(1.0, max(0.0, 2 - 2 ** ((height - level) / 0.025)))
                    slides.append(np.hypot(step[0], step[1]) * 25 * weight)
        assert foot_skating(motion, feet, ground, 25, observed)[index] == pytest.approx(np.mean(slides))


def test_a_foot_that_stands_or_swings_does_not_skate() -> None:
    still = np.zeros((10, 1, 3))
    assert foot_skating(still, [0], [0.0], 25) == 0
    swing = np.arange(10)[:, None, None] * [0.1, 0, 0] + [0, 0, 0.2]
    assert foot_skating(swing, [0], [0.0], 25) == 0
    assert foot_skating(swing, [0], [0.2], 25) == pytest.approx(2.5)
    assert foot_skating(swing, [0], [0.3], 25) == pytest.approx(2.5)  # under the ground is on it


def test_naive_twin_of_bone_length_drift(motion: np.ndarray) -> None:
    reference = np.random.default_rng(1).normal(size=(2, 3, 4, 3))
    seen = np.random.default_rng(2).random((2, 3, 4)) < 0.9
    drift = bone_length_drift(motion, reference, BONES, seen)
    for index in np.ndindex(2, 3, 9):
        w, p, _ = index
        changes = [
            abs(np.linalg.norm(motion[index][a] - motion[index][b])
                - np.linalg.norm(reference[w, p, a] - reference[w, p, b]))
            for a, b in BONES if seen[w, p, a] and seen[w, p, b]
        ]  # fmt: skip
        if changes:
            assert drift[index] == pytest.approx(np.mean(changes))
        else:
            assert np.isnan(drift[index])


def test_a_body_that_moves_stiffly_keeps_its_bones() -> None:
    pose = np.random.default_rng(3).normal(size=(4, 3))
    turn = np.linalg.qr(np.random.default_rng(4).normal(size=(3, 3)))[0]
    np.testing.assert_allclose(bone_length_drift(np.stack([pose + 3, pose @ turn]), pose, BONES), 0, atol=1e-12)


def test_naive_twin_of_jerk(motion: np.ndarray, observed: np.ndarray) -> None:
    for index in np.ndindex(2, 3):
        jerks = [
            np.linalg.norm(x[t + 3, j] - 3 * x[t + 2, j] + 3 * x[t + 1, j] - x[t, j]) * 25**3
            for x in (motion[index],) for t in range(6) for j in range(4) if observed[index][t : t + 4, j].all()
        ]  # fmt: skip
        assert mean_jerk(motion, 25, observed)[index] == pytest.approx(np.mean(jerks))


def test_steady_acceleration_has_no_jerk() -> None:
    fall = (np.arange(10) / 25)[:, None, None] ** 2 * [0, 0, -4.9]
    assert mean_jerk(fall, 25) == pytest.approx(0, abs=1e-9)


def test_naive_twin_of_the_seam_jump(motion: np.ndarray, observed: np.ndarray) -> None:
    history, forecast = motion[:, :, :5], motion[:, :, 5:]
    for index in np.ndindex(2, 3):
        jumps = [
            np.linalg.norm((x[5, j] - x[4, j]) - (x[4, j] - x[3, j])) * 25
            for x in (motion[index],) for j in range(4) if observed[index][3:5, j].all()
        ]  # fmt: skip
        assert seam_jump(history, forecast, 25, observed[:, :, :5])[index] == pytest.approx(np.mean(jumps))


def test_the_seam_is_one_of_the_moments_of_a_motion(motion: np.ndarray, observed: np.ndarray) -> None:
    changes = velocity_change(motion, 25, observed)
    assert changes.shape == (2, 3, 7)
    for cut in range(2, 9):
        seen = np.where(np.arange(9)[:, None] == cut, True, observed)  # a forecast is always there
        jump = seam_jump(motion[:, :, :cut], motion[:, :, cut:], 25, seen[:, :, :cut])
        whole = observed[:, :, cut - 2 : cut + 1].all((2, 3))
        np.testing.assert_allclose(jump[whole], changes[..., cut - 2][whole])


def test_motion_that_goes_on_steadily_has_no_seam_and_a_held_pose_has_that_of_its_speed() -> None:
    walk = np.arange(6)[:, None, None] * [0.04, 0.03, 0]
    assert seam_jump(walk[:3], walk[3:], 25) == pytest.approx(0, abs=1e-12)
    assert seam_jump(walk[:3], walk[2:3], 25) == pytest.approx(0.05 * 25)


METRICS: dict[str, Callable[[np.ndarray], np.ndarray]] = {
    "skating": lambda motion: foot_skating(motion, [1, 3], [0.0, 0.0], 25),
    "bones": lambda motion: bone_length_drift(motion, motion[..., 0, :, :], BONES),
    "jerk": lambda motion: mean_jerk(motion, 25),
    "changes": lambda motion: velocity_change(motion, 25),
    "seam": lambda motion: seam_jump(motion[..., :4, :, :], motion[..., 4:, :, :], 25),
}


@pytest.mark.parametrize("metric", METRICS.values(), ids=METRICS.keys())
def test_invariances(metric: Callable[[np.ndarray], np.ndarray], motion: np.ndarray) -> None:
    values = metric(motion)
    turn = np.array([[0.6, 0.8, 0], [-0.8, 0.6, 0], [0, 0, 1]])
    np.testing.assert_allclose(metric(motion @ turn + [4, 5, 0]), values, atol=1e-9)
    np.testing.assert_allclose(metric(motion[:, ::-1]), values[:, ::-1])
    np.testing.assert_allclose(metric(motion[1, 2]), values[1, 2])
