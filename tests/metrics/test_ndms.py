from __future__ import annotations

import numpy as np
import pytest

from motioncast.core.rotation import from_axis_angle, rotate
from motioncast.metrics import neighbours
from motioncast.metrics.ndms import Dictionary, dictionary, ndms, similarity
from motioncast.metrics.neighbours import prepare
from motioncast.metrics.words import motion_words, with_seam

HIPS = (0, 1)


def walk(seed: int, frames: int = 60, joints: int = 5) -> np.ndarray:
    """Someone who strolls about and swings, ``(time, joints, 3)``."""
    random = np.random.default_rng(seed)
    seconds = np.arange(frames)[:, None, None] / 25
    rhythm = np.sin(2 * np.pi * seconds * random.uniform(0.5, 1.5, (joints, 1)) + random.uniform(0, 6, (joints, 3)))
    place = random.normal(size=(joints, 3)) * 0.3
    place[:2] = [[-0.1, 0, 1], [0.1, 0, 1]]
    motion = place + 0.2 * rhythm + seconds * [0.5, 0.2, 0]
    return rotate(from_axis_angle(np.array([0, 0, seed])), motion).astype(np.float32)


def words_of(*seeds: int) -> np.ndarray:
    return np.concatenate([motion_words(walk(seed), HIPS) for seed in seeds])


@pytest.fixture(scope="module")
def real() -> Dictionary:
    return dictionary(words_of(1, 2, 3, 4))


def brute(queries: np.ndarray, points: np.ndarray) -> np.ndarray:
    queries, points = (array.reshape(len(array), -1).astype(np.float64) for array in (queries, points))
    return np.array([np.square(query - points).sum(-1).argmin() for query in queries])


def test_a_word_is_seen_from_its_first_frame() -> None:
    words = motion_words(walk(1), HIPS)
    assert words.shape == (53, 8, 5, 3)
    np.testing.assert_allclose(words[:, 0, :2].mean(1), 0, atol=1e-6)
    np.testing.assert_allclose(words[:, 0, 1, 1], 0, atol=1e-6)
    assert (words[:, 0, 1, 0] > 0).all()


def test_words_do_not_know_where_they_were_said() -> None:
    moved = rotate(from_axis_angle(np.array([0, 0, 2.0])), walk(1)) + np.array([5, -3, 0.4])
    np.testing.assert_allclose(motion_words(moved, HIPS), motion_words(walk(1), HIPS), atol=1e-5)


def test_words_of_many_people_at_once_are_those_of_each() -> None:
    both = motion_words(np.stack([walk(1), walk(2)]), HIPS, length=10, hop=3)
    np.testing.assert_array_equal(both[1], motion_words(walk(2), HIPS, length=10)[::3])


def test_someone_who_lies_on_the_side_has_words_without_a_heading() -> None:
    lying = np.zeros((8, 2, 3))
    lying[:, 1, 2] = 0.2
    np.testing.assert_allclose(motion_words(lying, HIPS)[0, 0], [[0, 0, -0.1], [0, 0, 0.1]])


def test_neighbours_are_exact(real: Dictionary) -> None:
    random = np.random.default_rng(0)
    queries = np.concatenate([
        words_of(1, 7, 8),  # words that are there, and words of others
        np.repeat(words_of(9)[:5, :1], 8, 1),  # held poses
        random.normal(size=(30, 8, 5, 3)),  # nothing that anyone did
        words_of(7) * 40,  # far away
    ])  # fmt: skip
    np.testing.assert_array_equal(real.nearest(queries), brute(queries, real.words))


@pytest.mark.parametrize("kept", [1, 4, 200])
def test_neighbours_are_exact_however_loose_the_bounds(kept: int, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(neighbours, "MANY", 1)  # both kinds of bounds are used
    # and blocks that do not come out even
    for name, size in (("PAIRS", 5), ("TILE", 64), ("ROWS", 16), ("QUERIES", 50)):
        monkeypatch.setattr(neighbours, name, size)
    points = np.random.default_rng(1).normal(size=(500, 12)).astype(np.float32)
    queries = np.random.default_rng(2).normal(size=(130, 12)) * 2 + 0.5
    np.testing.assert_array_equal(prepare(points, kept).nearest(queries), brute(queries, points))


def test_of_equally_near_words_the_first_is_found() -> None:
    points = np.tile(np.random.default_rng(1).normal(size=(40, 9)), (30, 1))
    np.testing.assert_array_equal(prepare(points, 3).nearest(points), np.tile(np.arange(40), 30))
    still = np.zeros((700, 6), np.float32)  # a dictionary of people who all stand
    assert prepare(still).nearest(np.ones((3, 6))).tolist() == [0, 0, 0]


def test_a_far_origin_costs_no_exactness() -> None:
    points = np.random.default_rng(1).normal(size=(300, 6)) * 0.01 + 1000
    queries = points[::3] + 1e-4
    np.testing.assert_array_equal(prepare(points, 3).nearest(queries), brute(queries, points))


def test_an_empty_dictionary_is_refused_and_no_query_is_answered_by_none(real: Dictionary) -> None:
    with pytest.raises(ValueError, match="give at least one"):
        prepare(np.zeros((0, 5)))
    assert real.nearest(np.zeros((0, 8, 5, 3))).shape == (0,)
    assert ndms(np.zeros((0, 8, 5, 3)), real).shape == (0,)


def test_naive_twin_of_ndms(real: Dictionary) -> None:
    words = words_of(5)[:6].astype(np.float64)
    scores = ndms(words, real)
    for word, score in zip(words, scores, strict=True):
        match = min(real.words.astype(np.float64), key=lambda other, word=word: float(np.square(other - word).sum()))
        terms = []
        for t in range(7):
            for j in range(5):
                a, b = match[t + 1, j] - match[t, j], word[t + 1, j] - word[t, j]
                long, short = max(np.linalg.norm(a), np.linalg.norm(b)), min(np.linalg.norm(a), np.linalg.norm(b))
                terms.append((a @ b / (long * short) + 1) / 2 * short / long)
        assert score == pytest.approx(np.mean(terms))


def test_real_motion_scores_one_and_a_held_pose_beside_it_almost_none(real: Dictionary) -> None:
    np.testing.assert_allclose(ndms(real.words[::7], real), 1)
    held = np.repeat(real.words[:40, :1], 8, 1)
    assert ndms(held, real).max() < 0.05


def test_people_who_stand_beside_people_who_stand_score_a_half() -> None:
    held = np.repeat(words_of(1)[:3, :1], 8, 1)
    np.testing.assert_allclose(ndms(held, dictionary(held)), 0.5)


def test_order_of_people_size_of_batch_and_place_change_nothing(real: Dictionary) -> None:
    motion = np.stack([walk(seed) for seed in (5, 6, 7)])
    words = motion_words(motion, HIPS)
    scores = ndms(words, real)
    assert scores.shape == (3, 53)
    np.testing.assert_allclose(ndms(words[[2, 0, 1]], real), scores[[2, 0, 1]])
    np.testing.assert_allclose(ndms(words[1, 4], real), scores[1, 4])
    moved = rotate(from_axis_angle(np.array([0, 0, -1.0])), motion) + np.array([9, 8, 7])
    np.testing.assert_allclose(ndms(motion_words(moved, HIPS), real), scores, atol=1e-3)


def test_a_jump_at_the_seam_costs_the_words_that_hold_it(real: Dictionary) -> None:
    motion = walk(2)
    smooth, jump = (with_seam(motion[:20], motion[20:] + np.array([0, step, 0])) for step in (0.0, 0.5))
    scores = [ndms(motion_words(motion, HIPS), real) for motion in (smooth, jump)]
    assert len(scores[0]) == 40  # a word for each forecast frame
    assert (scores[1][:7] < scores[0][:7]).all()
    np.testing.assert_allclose(scores[1][7:], scores[0][7:], atol=1e-3)


def test_likeness_has_no_direction() -> None:
    one, other = words_of(1)[:10], words_of(2)[:10]
    np.testing.assert_allclose(similarity(one, other), similarity(other, one))
    np.testing.assert_allclose(similarity(one, one), 1)
