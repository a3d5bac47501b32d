"""Another frame rate: anchored at the last frame, masked, band-limited."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation, Slerp

from motioncast.core import rotation
from motioncast.core.resample import resample, sample
from motioncast.core.scene import Scene
from motioncast.core.skeleton import Skeleton

ONE = Skeleton(("point",), (-1,), ("pelvis",))


def track(values: np.ndarray, fps: float) -> Scene:
    return Scene(np.repeat(np.asarray(values, float)[:, None, None, None], 3, -1), ONE, fps)


@pytest.mark.parametrize(("before", "after"), [(30, 25), (120, 15), (60, 25), (30, 29.97), (15, 120), (25, 30)])
def test_the_last_frame_stays_and_straight_motion_stays_straight(before, after):
    seconds = (np.arange(4 * before) - 4 * before + 1) / before
    result = resample(track(seconds, before), after)
    times = (np.arange(result.frames) - result.frames + 1) / after
    assert abs(result.positions[-1, 0, 0, 0]) < 1e-9
    assert times[0] - 1 / after < seconds[0] <= times[0] + 1e-6
    np.testing.assert_allclose(result.positions[:, 0, 0, 0], times, atol=1e-6)


@pytest.mark.parametrize(("before", "after"), [(30, 25), (120, 15), (60, 25), (15, 60)])
def test_slow_motion_survives(before, after):
    def motion(seconds):
        return 0.3 * np.sin(2 * np.pi * 1.0 * seconds)

    result = resample(track(motion((np.arange(4 * before) - 4 * before + 1) / before), before), after)
    expected = motion((np.arange(result.frames) - result.frames + 1) / after)
    inner = slice(after // 2, -3)
    assert np.abs(result.positions[inner, 0, 0, 0] - expected[inner]).max() < 0.004


def test_fast_motion_is_filtered_out_downwards():
    wave = np.sin(2 * np.pi * 13 * np.arange(480) / 120)
    decimated, filtered = wave[::-1][::8][::-1], resample(track(wave, 120), 15).positions[:, 0, 0, 0]
    assert np.abs(filtered[5:-5]).max() < 0.1 * np.abs(decimated[5:-5]).max()


def test_unseen_joints_stay_unseen_and_do_not_smear():
    seen = np.ones((60, 1, 1), bool)
    seen[20:30] = False
    scene = track(np.where(seen[:, 0, 0], 1.0, 50.0), 60)
    result = resample(replace(scene, observed=seen), 15)
    assert not result.observed.all()
    assert result.observed[-1].all()
    np.testing.assert_allclose(result.positions[result.observed], 1.0, atol=1e-5)


def test_rotations_take_the_shorter_arc():
    keys = Rotation.random(9, random_state=3)
    quaternions = keys.as_quat(scalar_first=True)[:, None, None].astype(np.float32)
    scene = replace(track(np.zeros(9), 10), rotations=quaternions, offsets=np.zeros((1, 1, 3)))
    turned = resample(scene, 25).rotations
    assert turned is not None
    moments = np.arange(8, -1e-9, -10 / 25)[::-1]
    expected = Slerp(np.arange(9), keys)(np.clip(moments, 0, 8)).as_matrix()
    np.testing.assert_allclose(rotation.to_matrix(turned[:, 0, 0]), expected, atol=1e-5)


def test_the_same_rate_is_the_same_scene():
    scene = track(np.arange(5), 30)
    assert resample(scene, 30) is scene


def test_sample_agrees_with_the_dense_sum():
    values, times, step = np.random.default_rng(0).normal(size=(20, 2)), np.array([3.2, 10.0, 18.9]), 2.5
    expected = []
    for time in times:
        total, norm, moment = np.zeros(2), 0.0, 0.0
        for index in range(-12, 33):
            share = (index - time) / step
            weight = np.sinc(share) * np.sinc(share / 3) if abs(share) < 3 else 0.0
            mirror = values[np.clip(index, 0, 19)]
            if index != np.clip(index, 0, 19):
                end = int(np.clip(index, 0, 19))
                mirror = 2 * values[end] - values[np.clip(2 * end - index, 0, 19)]
            total, norm, moment = total + weight * mirror, norm + weight, moment + weight * (index - time)
        floor = int(time)
        expected.append((total - moment * (values[floor + 1] - values[floor])) / norm)
    np.testing.assert_allclose(sample(values, times, step), expected, atol=1e-12)
