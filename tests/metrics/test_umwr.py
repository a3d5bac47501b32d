from __future__ import annotations

import numpy as np
import pytest

from motioncast.metrics.ndms import dictionary
from motioncast.metrics.umwr import umwr, umwr_of_second
from motioncast.metrics.words import motion_words, with_seam

HIPS = (0, 1)


def test_naive_twin() -> None:
    neighbours = np.random.default_rng(0).integers(0, 40, (3, 2, 50))
    for index in np.ndindex(3, 2):
        assert umwr(neighbours)[index] == len(set(neighbours[index].tolist())) / 50


def test_names_and_order_of_the_real_words_do_not_matter() -> None:
    random = np.random.default_rng(1)
    neighbours = random.integers(0, 20, (4, 60))
    np.testing.assert_array_equal(umwr(random.permutation(20)[neighbours]), umwr(neighbours))
    np.testing.assert_array_equal(umwr(random.permuted(neighbours, axis=1)), umwr(neighbours))


def test_a_held_pose_is_one_word_and_real_motion_many() -> None:
    random = np.random.default_rng(2)
    real = np.cumsum(random.normal(scale=0.01, size=(60, 4, 3)), 0) + random.normal(size=(4, 3))
    words = motion_words(real, HIPS)
    found = dictionary(words).nearest(words)
    assert umwr(found) == 1
    held = motion_words(with_seam(real[:25], np.broadcast_to(real[24], (250, 4, 3)))[7:], HIPS)
    assert umwr(dictionary(words).nearest(held)) == 1 / 243


def test_a_second_holds_its_own_words_only() -> None:
    neighbours = np.zeros((2, 250), int)
    neighbours[0, 25:43] = np.arange(18)  # the 18 words whole within the second second
    seconds = [umwr_of_second(neighbours, second, fps=25) for second in (1, 2, 3)]
    np.testing.assert_allclose(np.array(seconds)[:, 0], [1 / 18, 1, 1 / 18])
    np.testing.assert_allclose(np.array(seconds)[:, 1], 1 / 18)


@pytest.mark.parametrize("second", [1, 10])
def test_naive_twin_of_a_second(second: int) -> None:
    neighbours = np.random.default_rng(3).integers(0, 9, 250)
    whole = [word for word in range(250) if 25 * (second - 1) <= word and word + 8 <= 25 * second]
    assert umwr_of_second(neighbours, second, fps=25) == len(set(neighbours[whole].tolist())) / len(whole)
    assert len(whole) == 18
