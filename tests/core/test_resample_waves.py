"""Another frame rate: against sine waves whose values are known at any moment."""

from __future__ import annotations

import numpy as np
import pytest

from motioncast.core import rotation
from motioncast.core.resample import bridge, resample, sample
from motioncast.core.scene import Scene
from motioncast.core.skeletons import MRT15
from motioncast.errors import SceneError
from motioncast.testing import walkers

RATES = [(30, 25), (120, 15), (60, 25), (30000 / 1001, 30), (15, 30), (25, 60), (100, 30)]


def waves(times_s: np.ndarray, hertz: float = 1.0) -> np.ndarray:
    """A sine of 0.3 m a joint, each with a phase of its own, ``(time, 1, 15, 3)``."""
    phases = np.arange(45).reshape(15, 3) / 7
    return 0.3 * np.sin(2 * np.pi * hertz * times_s[:, None, None, None] + phases)


def moments(scene: Scene, original: Scene) -> np.ndarray:
    """Seconds since the original's first frame at which a resampled scene's frames stand."""
    last = (original.frames - 1) / original.fps
    return last - np.arange(scene.frames - 1, -1, -1) / scene.fps


@pytest.mark.parametrize(("before", "after"), RATES)
def test_sine_waves_keep_their_values(before, after):
    scene = Scene(waves(np.arange(int(4 * before)) / before), MRT15, before)
    changed = resample(scene, after)
    times = moments(changed, scene)
    assert changed.fps == after
    assert 0 <= times[0] < 1 / after
    error = np.abs(changed.positions - waves(times)).max((1, 2, 3))
    settled = (times > 0.5) & (times < times[-1] - 0.5)
    assert error[settled].max() < 0.004
    assert error.max() < 0.03


@pytest.mark.parametrize(("before", "after"), RATES)
def test_the_last_frame_is_exact(before, after):
    scene = walkers(people=2, frames=50, fps=before)
    changed = resample(scene, after)
    np.testing.assert_allclose(changed.positions[-1], scene.positions[-1], atol=1e-6)


@pytest.mark.parametrize(("before", "after"), RATES)
def test_straight_motion_stays_straight_up_to_both_ends(before, after):
    times = np.arange(40) / before
    scene = Scene(np.broadcast_to(1.5 * times[:, None, None, None], (40, 1, 15, 3)), MRT15, before)
    changed = resample(scene, after)
    expected = 1.5 * moments(changed, scene)
    np.testing.assert_allclose(changed.positions[:, 0, 3, 1], expected, atol=1e-5)


def test_what_the_lower_rate_cannot_carry_is_filtered_out():
    fast = Scene(waves(np.arange(480) / 120, hertz=14), MRT15, 120)  # 15 fps carry up to 7.5 Hz; 14 would become 1
    assert np.abs(resample(fast, 15).positions[8:-8]).max() < 0.03


def test_there_and_back():
    scene = walkers(people=1, frames=60, fps=15)
    back = resample(resample(scene, 60), 15)
    np.testing.assert_allclose(back.positions[6:-6], scene.positions[6:-6], atol=0.01)


def test_the_same_rate_changes_nothing():
    scene = walkers(people=1, frames=5)
    assert resample(scene, scene.fps) is scene


@pytest.mark.parametrize("fps", [0, -15, float("nan"), float("inf")])
def test_an_impossible_rate_is_refused(fps):
    with pytest.raises(SceneError, match="frame rate"):
        resample(walkers(people=1, frames=5), fps)


def test_no_frame_before_the_first_is_made_up():
    scene = walkers(people=1, frames=10, fps=30)
    assert resample(scene, 15).frames == 5  # frames 1, 3, 5, 7, 9
    assert resample(scene, 60).frames == 19
    assert resample(scene, 1).frames == 1
    assert resample(scene[:1], 120).frames == 1


@pytest.mark.parametrize("after", [25, 10, 120])
def test_gaps_do_not_smear(after):
    scene = walkers(people=2, frames=90, fps=30)
    still = np.broadcast_to(np.float32(5.0), scene.positions.shape)
    observed = np.ones(scene.observed.shape, bool)
    observed[30:45, 1] = False
    observed[:20, 0, 3] = False
    observed[70:, 0, 5] = False
    changed = resample(Scene(still, MRT15, 30, observed), after)
    assert changed.observed.any(0).all()
    assert not changed.observed.all()
    np.testing.assert_allclose(changed.positions[changed.observed], 5, atol=1e-5)
    assert not changed.positions[~changed.observed].any()


@pytest.mark.parametrize("after", [15, 25, 120])
def test_people_who_come_and_go_keep_their_velocity(after):
    times = np.arange(120) / 60
    path = np.broadcast_to(1.5 * times[:, None, None, None], (120, 1, 15, 3))
    observed = np.zeros((120, 1, 15), bool)
    observed[31:90] = True
    scene = Scene(path, MRT15, 60, observed)
    changed = resample(scene, after)
    seen = changed.observed[:, 0, 0]
    np.testing.assert_allclose(changed.positions[seen, 0, 0, 0], 1.5 * moments(changed, scene)[seen], atol=1e-5)


def test_a_joint_is_seen_where_both_frames_around_it_are():
    observed = np.ones((9, 1, 15), bool)
    observed[4] = False
    scene = Scene(np.ones((9, 1, 15, 3)), MRT15, 30, observed)
    assert resample(scene, 60).observed[:, 0, 0].tolist() == [i not in (7, 8, 9) for i in range(17)]
    assert resample(scene, 15).observed[:, 0, 0].tolist() == [True, True, False, True, True]


def test_somebody_never_seen_stays_unseen():
    scene = Scene(np.ones((9, 2, 15, 3)), MRT15, 30, np.arange(2)[None, :, None] * np.ones((9, 1, 15), bool))
    changed = resample(scene, 25)
    assert not changed.observed[:, 0].any()
    assert changed.observed[:, 1].all()


def test_rotations_turn_evenly():
    turn = rotation.from_axis_angle(np.outer(0.2 * np.arange(31), [0, 0, 1]))
    rotations = np.broadcast_to(turn[:, None, None], (31, 1, 15, 4))
    scene = Scene(np.zeros((31, 1, 15, 3)), MRT15, 30, rotations=rotations, offsets=np.zeros((1, 15, 3)))
    for fps in (25, 60, 7):
        changed = resample(scene, fps)
        angles = 6.0 * moments(changed, scene)
        expected = rotation.from_axis_angle(np.outer(angles, [0, 0, 1]))
        assert changed.rotations is not None
        alike = np.abs((changed.rotations[:, 0, 2] * expected).sum(-1))
        np.testing.assert_allclose(alike, 1, atol=1e-5)


def test_sampling_at_the_frames_gives_the_frames():
    values = np.random.default_rng(0).normal(size=(12, 2))
    np.testing.assert_allclose(sample(values, np.arange(12.0)), values, atol=1e-9)


def test_bridges_are_straight():
    positions = np.zeros((5, 1, 1, 3))
    positions[[0, 4]] = [[[0.0, 0.0, 0.0]]], [[[4.0, -8.0, 2.0]]]
    observed = np.array([True, False, False, False, True])[:, None, None]
    np.testing.assert_allclose(bridge(positions, observed)[:, 0, 0], np.outer(np.arange(5), [1, -2, 0.5]))
