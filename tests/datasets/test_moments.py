from __future__ import annotations

import numpy as np
from scipy.signal import peak_prominences

from motioncast.core.rotation import from_axis_angle, rotate
from motioncast.core.scene import Scene
from motioncast.core.skeletons import MRT15
from motioncast.datasets.moments import extents, moments, prominence


def reacher(times: tuple[float, ...], fps: float = 30.0, seconds: float = 8.0) -> Scene:
    """Somebody who stands and holds the right hand half a metre out at some times."""
    pose = np.zeros((len(MRT15), 3))
    pose[MRT15.index("left_hip")], pose[MRT15.index("right_hip")] = (0, 0.1, 0), (0, -0.1, 0)
    clock = np.arange(round(seconds * fps)) / fps
    out = sum(0.5 * np.exp(-0.5 * ((clock - time) / 0.3) ** 2) for time in times)
    positions = np.tile(pose, (len(clock), 1, 1, 1)).astype(np.float32)
    positions[:, 0, MRT15.index("right_wrist"), 0] += out
    return Scene(positions, MRT15, fps)


def test_a_reach_is_found_where_the_hand_is_farthest() -> None:
    found = moments(reacher((2.0, 5.0)))
    assert [moment.frame for moment in found] == [60, 150]
    assert all(0.4 < moment.extent_m < 0.5 for moment in found)


def test_the_rate_of_the_capture_does_not_matter() -> None:
    times = [moment.frame / 120 for moment in moments(reacher((2.0, 5.0), fps=120))]
    np.testing.assert_allclose(times, [2.0, 5.0], atol=1 / 120)


def test_of_two_close_moments_the_stronger_stays() -> None:
    scene = reacher((2.0, 3.4))
    assert len(moments(scene)) == 2
    close = reacher((2.0,)).positions + 1.3 * reacher((2.6,)).positions
    assert len(moments(Scene(close, MRT15, 30))) == 1


def test_who_stands_still_or_turns_on_the_spot_has_none() -> None:
    still = reacher(())
    turn = from_axis_angle(np.linspace(0, 3, still.frames)[:, None] * np.array([0, 0, 1.0]))
    pose = still.positions + np.array([0.2, 0.3, 0.4], np.float32)
    turned = rotate(turn[:, None, None], pose - pose[:, :, :1]).astype(np.float32)
    for scene in (still, Scene(turned, MRT15, 30)):
        assert moments(scene) == []
        assert extents(scene).max() < 1e-6


def test_a_moment_that_was_not_seen_is_none() -> None:
    scene = reacher((2.0, 5.0))
    seen = scene.observed.copy()
    seen[60, 0, MRT15.index("right_wrist")] = False
    assert 60 not in [moment.frame for moment in moments(Scene(scene.positions, MRT15, 30, seen))]


def test_prominence_is_that_of_scipy() -> None:
    values = np.random.default_rng(0).normal(size=60).cumsum()
    peaks = [frame for frame in range(1, 59) if values[frame - 1] < values[frame] > values[frame + 1]]
    np.testing.assert_allclose([prominence(values, peak) for peak in peaks], peak_prominences(values, peaks)[0])
