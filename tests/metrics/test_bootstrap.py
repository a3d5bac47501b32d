from __future__ import annotations

import numpy as np
import pytest

from motioncast.metrics.bootstrap import BLOCK_S, FEWEST_TAKES, interval, units

Source = list[tuple[str, float]]


def many_takes(windows_each: int = 3) -> list[Source]:
    return [[(f"take {take:02}", float(start))] for take in range(12) for start in range(windows_each)]


def test_ten_takes_are_drawn_whole() -> None:
    ten = [[(f"{take}", float(start))] for take in range(FEWEST_TAKES) for start in (0, 100)]
    assert units(ten) == ("takes", [[take] for take in range(FEWEST_TAKES) for _ in range(2)])


def test_fewer_takes_are_drawn_by_blocks_of_eight_seconds() -> None:
    starts = [0.0, BLOCK_S - 0.04, BLOCK_S, 3 * BLOCK_S]
    what, owners = units([[("one", start)] for start in starts] + [[("two", 0.0)]])
    assert what == "blocks of 8 s of 2 takes"
    assert owners == [[0], [0], [1], [2], [3]]


def test_naive_twin() -> None:
    random = np.random.default_rng(1)
    sources = many_takes()
    sums, counts = random.random(len(sources)), random.integers(1, 5, len(sources))
    result = interval(sums, counts, sources, resamples=200, seed=4)
    drawn, figures = np.random.default_rng(4).multinomial(12, np.full(12, 1 / 12), 200), []
    for times in drawn:
        picked = [index for index in range(len(sources)) for _ in range(times[index // 3])]
        figures.append(sums[picked].sum() / counts[picked].sum())
    assert (result.low, result.high) == pytest.approx(np.percentile(figures, [2.5, 97.5]).tolist())
    assert result.figure == pytest.approx(sums.sum() / counts.sum())
    assert (result.n, result.of) == (12, "takes")


def test_windows_of_one_take_are_never_told_apart() -> None:
    values = np.random.default_rng(2).random(12)
    once = interval(values, np.ones(12), many_takes(1))
    copied = interval(np.repeat(values, 50), np.ones(600), many_takes(50))  # as many overlapping windows would be
    assert (copied.low, copied.high) == pytest.approx((once.low, once.high))


def test_the_order_of_the_windows_does_not_matter() -> None:
    values, sources = np.random.default_rng(3).random(36), many_takes()
    order = np.random.default_rng(4).permutation(36)
    mixed = interval(values[order], np.ones(36), [sources[index] for index in order])
    straight = interval(values, np.ones(36), sources)
    assert (mixed.low, mixed.high) == pytest.approx((straight.low, straight.high))


def test_a_composed_window_counts_only_where_both_its_takes_are_drawn() -> None:
    sources: list[Source] = [[("a", 0.0), ("b", 0.0)], [("a", 0.0)], [("b", 0.0)]]
    result = interval(np.array([6.0, 1.0, 2.0]), np.ones(3), sources, resamples=400)
    assert result.n == 2
    assert (result.figure, result.low, result.high) == pytest.approx((3.0, 1.0, 3.0))  # "a" twice, or each once


def test_the_interval_holds_the_true_mean_in_about_nineteen_of_twenty_cases() -> None:
    random = np.random.default_rng(5)
    sources = [[(f"{take:02}", 0.0)] for take in range(40) for _ in range(4)]
    held = 0
    for _ in range(200):
        values = np.repeat(random.normal(size=40), 4) + 0.1 * random.normal(size=160)
        result = interval(values, np.ones(160), sources, resamples=200)
        held += result.low <= 0 <= result.high
    assert 0.88 <= held / 200 <= 0.98


def test_windows_in_which_nobody_was_seen_change_nothing() -> None:
    values, sources = np.random.default_rng(6).random(36), many_takes()
    with_empty = interval(np.append(values, 0.0), np.append(np.ones(36), 0), [*sources, [("take 00", 9.0)]])
    assert with_empty == interval(values, np.ones(36), sources)


def test_it_prints_what_was_drawn() -> None:
    text = str(interval(np.array([1.0, 3.0]), np.ones(2), [[("a", 0.0)], [("a", 8.0)]]))
    assert text == "2 [1, 3] (n = 2 blocks of 8 s of 1 take)"
