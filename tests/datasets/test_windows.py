from __future__ import annotations

import numpy as np
import pytest

from motioncast.core.scene import Scene
from motioncast.core.skeletons import MRT15
from motioncast.datasets.windows import cut, every


def scene(frames: int, fps: float = 15) -> Scene:
    positions = np.broadcast_to(np.arange(frames, dtype=np.float32)[:, None, None, None], (frames, 1, 15, 3))
    return Scene(positions, MRT15, fps, source="a take")


def test_every_takes_exact_samples() -> None:
    np.testing.assert_array_equal(every(scene(17, 120), 15, MRT15).positions[:, 0, 0, 0], [0, 8, 16])
    with pytest.raises(ValueError, match="multiple"):
        every(scene(17, 100), 15, MRT15)


def test_windows_never_cross_takes() -> None:
    windows = cut([scene(70), scene(65)], 15, 45)
    assert windows.starts == ((0,), (5,), (10,), (0,), (5,))
    steps = np.diff(windows.positions[:, :, 0, 0, 0], axis=1)
    np.testing.assert_array_equal(steps, np.ones_like(steps))


def test_a_window_without_the_person_at_now_is_left_out() -> None:
    observed = np.ones((65, 1, 15), bool)
    observed[14] = False
    gap = Scene(scene(65).positions, MRT15, 15, observed)
    assert cut([gap], 15, 45).starts == ((5,),)


def test_the_past_holds_nothing_of_the_future() -> None:
    first = scene(60)
    changed = first.positions.copy()
    changed[15:] += 100
    second = Scene(changed, MRT15, 15)
    for one, other in zip(cut([first], 15, 45).past, cut([second], 15, 45).past, strict=True):
        np.testing.assert_array_equal(one, other)
