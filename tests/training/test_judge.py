from __future__ import annotations

import numpy as np
import pytest

torch = pytest.importorskip("torch")

from motioncast.benchmarks.rooms.windows import PROTOCOL, RoomWindow  # noqa: E402
from motioncast.testing import walkers  # noqa: E402
from motioncast.training import judge as judging  # noqa: E402

pytestmark = pytest.mark.torch


@pytest.fixture(scope="module")
def windows() -> list[RoomWindow]:
    """Two walkers a room; the second leaves after 4 s."""
    found = []
    for seed in range(6):
        scene = walkers(people=2, frames=275, fps=25, seed=seed)
        seen = np.ones((250, 2), bool)
        seen[100:, 1] = False
        history = scene[: PROTOCOL.history]
        found.append(
            RoomWindow(history, scene.positions[PROTOCOL.history :], seen, np.zeros(2, bool), f"room {seed}", 0)
        )
    return found


def test_only_who_stayed_is_judged(windows: list[RoomWindow]) -> None:
    motion = judging.stayed(windows, [window.future[None] for window in windows])
    assert motion.shape == (6, 250, 15, 3)
    np.testing.assert_array_equal(motion[2], windows[2].future[:, 0])


def test_snippets_are_drawn_without_return(windows: list[RoomWindow]) -> None:
    motion = judging.stayed(windows, [window.future[None] for window in windows])
    drawn = judging.some(motion, 50, seed=1)
    assert drawn.shape == (50, 50, 15, 3)
    assert len(torch.unique(drawn.flatten(1), dim=0)) == 50
    assert len(judging.some(motion, 10_000, seed=1)) == 6 * 41  # all there are


def test_a_judge_tells_walkers_from_statues_and_says_so_at_every_second(
    windows: list[RoomWindow], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(judging, "SNIPPETS", 120)
    real = [window.future[None] for window in windows]
    frozen = [np.repeat(future[:, :1], 250, 1) for future in real]
    known = judging.judge(judging.stayed(windows, real), {"statues": judging.stayed(windows, frozen)})
    ones = np.ones((1, len(windows)))
    for samples, right in ((real, lambda score: score > 0.8), (frozen, lambda score: score < 0.2)):
        figures = judging.realism(known, windows, samples)
        assert [figure.frame for figure in figures] == [25 * second for second in range(2, 11)]
        assert all(right(figure.mean(ones)[0]) for figure in figures)
        assert figures[0].counts.tolist() == [1] * 6
