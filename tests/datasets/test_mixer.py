from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from motioncast.datasets.mixer import PERSONAL_SPACE_M, arrange, entries, turned


def walk(frames: int, people: int, seed: int) -> np.ndarray:
    random = np.random.default_rng(seed)
    steps = random.normal(0, 0.03, (frames, people, 1, 3)).cumsum(0)
    return (steps + random.normal(0, 0.3, (people, 15, 3)) + [5, -3, 1]).astype(np.float32)


@given(st.integers(0, 1000))
def test_strangers_keep_their_distance_and_couples_stay_together(seed: int) -> None:
    couple, single = walk(40, 2, seed), walk(40, 1, seed + 1)
    arrangement = arrange([single, couple], 14, np.random.default_rng(seed))
    if arrangement is None:
        return
    scene = arrangement.positions
    between = np.linalg.norm(couple[:, 0] - couple[:, 1], axis=-1)
    np.testing.assert_allclose(np.linalg.norm(scene[:, 1] - scene[:, 2], axis=-1), between, atol=1e-5)
    for other in (1, 2):
        apart = np.linalg.norm(scene[:, 0, 0, :2] - scene[:, other, 0, :2], axis=-1)
        assert apart.min() >= PERSONAL_SPACE_M - 1e-5
    np.testing.assert_allclose(scene[..., 2], np.concatenate([single, couple], 1)[..., 2], atol=1e-5)


def test_the_place_depends_on_nothing_after_now() -> None:
    one, two = walk(40, 1, 1), walk(40, 1, 2)
    changed = one.copy()
    changed[15:, ..., 2] += 1.0  # jumps up later on; nobody comes closer on the floor
    first = arrange([one, two], 14, np.random.default_rng(7))
    second = arrange([changed, two], 14, np.random.default_rng(7))
    assert first is not None
    assert second is not None
    np.testing.assert_array_equal(first.positions[:15], second.positions[:15])
    assert first.places == second.places


def test_no_arrangement_in_too_small_a_place() -> None:
    one = np.zeros((20, 1, 15, 3), np.float32)
    assert arrange([one, one], 9, np.random.default_rng(0), radius_m=0.1) is None


def test_turning_keeps_the_vertical() -> None:
    points = np.random.default_rng(0).normal(size=(10, 3)).astype(np.float32)
    turned_points = turned(points, 1.0)
    np.testing.assert_array_equal(turned_points[:, 2], points[:, 2])
    np.testing.assert_allclose(np.linalg.norm(turned_points, axis=1), np.linalg.norm(points, axis=1), rtol=1e-5)


def test_sixteen_people_find_room() -> None:
    groups = [walk(60, 1 + seed % 2, seed) for seed in range(11)]
    scene = arrange(groups, 14, np.random.default_rng(0))
    assert scene is not None
    assert scene.positions.shape[1] == 16


def test_a_scene_can_be_set_down_again_from_its_places() -> None:
    groups = [walk(40, 1, 3), walk(40, 2, 4)]
    arrangement = arrange(groups, 14, np.random.default_rng(1))
    assert arrangement is not None
    again = []
    for group, (x, y, angle) in zip(groups, arrangement.places, strict=True):
        middle = group[14, :, 0].mean(0) * [1, 1, 0]
        again.append(turned(group - middle.astype(np.float32), angle) + np.array([x, y, 0], np.float32))
    np.testing.assert_allclose(np.concatenate(again, 1), arrangement.positions, atol=1e-5)


def test_late_people_enter_in_the_first_half_of_the_history() -> None:
    entry = entries((2000, 3), 15, 0.5, np.random.default_rng(0))
    assert 0.45 < (entry > 0).mean() < 0.55
    assert entry.max() == 7
