"""Eq. 3.2: its slopes, and that lowering it makes poses whole."""

from __future__ import annotations

import numpy as np
import pytest

from motioncast.core.skeletons import H36M17
from motioncast.inference.refine import ANGLES, CLOSENESS, PoseEnergy, interpolated, lowered
from motioncast.testing import walkers

HANDS = (16, 13)
BONES = [list(side) for side in zip(*H36M17.bones, strict=True)]


def last_poses(count: int = 4) -> np.ndarray:
    motion = walkers(people=1, frames=40).on(H36M17).positions[:: 40 // count, 0].astype(np.float64)
    return motion - motion[:, :1]


def energy_of(
    last: np.ndarray, sampled: np.ndarray, angles: float = ANGLES, closeness: float = CLOSENESS
) -> PoseEnergy:
    heat = np.random.default_rng(0).random((len(last), 17, 16, 16, 16)) * 0.2
    return PoseEnergy(H36M17, last, HANDS, sampled[:, HANDS], heat, angles=angles, closeness=closeness)


def lengths(pose: np.ndarray) -> np.ndarray:
    return np.linalg.norm(pose[:, BONES[0]] - pose[:, BONES[1]], axis=-1)


@pytest.mark.parametrize("term", ["_hands", "_bones", "_angles", "_closeness", "_heat"])
def test_slopes_written_by_hand_are_those_of_finite_differences(term: str) -> None:
    random, last = np.random.default_rng(1), last_poses()
    pose = last + random.normal(0, 0.05, last.shape)
    part = getattr(energy_of(last, last + 0.1), term)
    slope = np.zeros_like(pose)
    value = part(pose, slope)
    assert value.shape == (4,)
    for joint, axis in ((16, 0), (15, 2), (8, 1), (3, 2), (9, 0)):
        step = np.zeros_like(pose)
        step[:, joint, axis] = 1e-6
        ahead, behind = (part(pose + sign * step, np.zeros_like(pose)) for sign in (1, -1))
        np.testing.assert_allclose(slope[:, joint, axis], (ahead - behind) / 2e-6, atol=1e-6)


def test_a_shaken_pose_gets_its_bones_back() -> None:
    random, last = np.random.default_rng(0), np.repeat(last_poses(1), 10, 0)
    shaken = last + random.normal(0, 0.03, last.shape)
    energy = energy_of(last, shaken, 0.02, 0.0)
    whole = lowered(energy, shaken)
    before, after = (np.abs(lengths(pose) - lengths(last)) for pose in (shaken, whole))
    assert before.mean() > 0.02
    assert after.mean() < 0.003
    assert after.max() < 0.01
    assert (energy(whole)[0] < energy(shaken)[0]).all()


def test_poses_are_lowered_at_once_as_one_by_one() -> None:
    random, last = np.random.default_rng(0), last_poses()
    shaken = last + random.normal(0, 0.03, last.shape)
    energy = energy_of(last, shaken)
    together = lowered(energy, shaken, 30)
    for row in range(len(last)):
        alone = PoseEnergy(H36M17, last[[row]], HANDS, shaken[[row]][:, HANDS], energy.heat[[row]])
        np.testing.assert_allclose(lowered(alone, shaken[[row]], 30)[0], together[row], atol=1e-6)


def test_a_bowl_is_lowered_to_its_bottom_and_a_pose_at_rest_stays() -> None:
    bottom, steepness = np.ones((3, 2, 3)), np.array([1.0, 30.0, 900.0])

    def bowl(pose: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        apart = pose - bottom
        return (steepness * apart**2).sum((1, 2)) / 2, steepness * apart

    np.testing.assert_allclose(lowered(bowl, np.zeros((3, 2, 3)), 40), bottom, atol=1e-6)
    np.testing.assert_array_equal(lowered(bowl, bottom, 5), bottom)


def test_heat_draws_towards_it_and_is_flat_outside() -> None:
    heat = np.zeros((1, 1, 16, 16, 16))
    heat[..., 8, 8, 8] = 1
    middle = np.full((1, 1, 3), 0.0625)
    value, slope = interpolated(heat, middle - [0.04, 0, 0])
    assert value[0, 0] == pytest.approx(1 - 0.04 / 0.125)
    assert slope[0, 0, 0] == pytest.approx(8)
    value, slope = interpolated(heat, middle + 3.0)
    assert value[0, 0] == 0
    assert not slope.any()
