from __future__ import annotations

import numpy as np
import pytest

from motioncast.metrics.calibration import coverage_at, energy_score, rank_histogram, unevenness


def test_naive_twin_of_coverage() -> None:
    random = np.random.default_rng(0)
    errors, radius = random.random((6, 4, 2, 3)), random.random((4, 3))
    observed = random.random(errors.shape) < 0.7
    for frame in range(4):
        inside = [
            errors[w, frame, p, j] <= radius[frame, j]
            for w in range(6) for p in range(2) for j in range(3) if observed[w, frame, p, j]
        ]  # fmt: skip
        assert coverage_at(errors, radius, observed)[frame] == pytest.approx(np.mean(inside))


def test_what_was_not_seen_does_not_count() -> None:
    errors = np.array([0.1, np.nan, 9.0]).reshape(3, 1, 1, 1)
    seen = np.array([True, False, False]).reshape(3, 1, 1, 1)
    assert coverage_at(errors, np.array([[0.2]]), seen)[0] == 1
    assert np.isnan(coverage_at(errors, np.array([[0.2]]), np.zeros_like(seen))[0])


def test_radii_at_a_quantile_hold_that_share() -> None:
    errors = np.random.default_rng(1).random((500, 3, 2, 4))
    radius = np.quantile(errors, 0.9, axis=(0, 2))
    assert coverage_at(errors, radius) == pytest.approx(0.9, abs=0.002)


@pytest.mark.parametrize(("spread", "least", "most"), [(1.0, 0.0, 0.04), (0.2, 0.3, 1.0), (5.0, 0.3, 1.0)])
def test_only_samples_that_spread_as_the_truth_have_a_flat_histogram(spread: float, least: float, most: float) -> None:
    random = np.random.default_rng(2)
    histogram = rank_histogram(spread * random.normal(size=(9, 4000)), random.normal(size=4000))
    assert histogram.shape == (10,)
    assert histogram.sum() == pytest.approx(1)
    assert least <= unevenness(histogram) <= most
    ends = histogram[[0, -1]].mean() > histogram[1:-1].mean()
    assert ends == (spread < 1) or spread == 1


def test_naive_twin_of_the_rank_histogram() -> None:
    random = np.random.default_rng(3)
    samples, truth = random.integers(0, 4, (5, 30)).astype(float), random.integers(0, 4, 30).astype(float)
    shares = np.zeros(6)
    for index, value in enumerate(truth):
        ranks = range((samples[:, index] < value).sum(), (samples[:, index] <= value).sum() + 1)
        shares[list(ranks)] += 1 / len(ranks) / len(truth)
    np.testing.assert_allclose(rank_histogram(samples, truth), shares)


def test_order_of_samples_does_not_matter_and_a_mirror_image_turns_the_histogram_round() -> None:
    random = np.random.default_rng(4)
    samples, truth = random.normal(size=(4, 5, 6)), random.normal(size=(5, 6))
    np.testing.assert_allclose(rank_histogram(samples[::-1], truth), rank_histogram(samples, truth))
    np.testing.assert_allclose(rank_histogram(-samples, -truth), rank_histogram(samples, truth)[::-1])


def test_naive_twin_of_the_energy_score() -> None:
    random = np.random.default_rng(5)
    samples, truth = random.normal(size=(4, 2, 7)), random.normal(size=(2, 7))
    for case in range(2):
        pairs = [np.linalg.norm(a - b) for i, a in enumerate(samples[:, case]) for b in samples[:i, case]]
        expected = np.mean([np.linalg.norm(a - truth[case]) for a in samples[:, case]]) - np.mean(pairs) / 2
        assert energy_score(samples, truth)[case] == pytest.approx(expected)


def test_the_energy_score_turns_and_moves_and_scales_with_the_world() -> None:
    random = np.random.default_rng(6)
    samples, truth = random.normal(size=(4, 3)), random.normal(size=3)
    turn = np.linalg.qr(random.normal(size=(3, 3)))[0]
    before = energy_score(samples, truth)
    assert energy_score(samples @ turn + 5, truth @ turn + 5) == pytest.approx(before)
    assert energy_score(3 * samples, 3 * truth) == pytest.approx(3 * before)


def test_the_true_distribution_has_the_best_energy_score_whatever_the_number_of_samples() -> None:
    random = np.random.default_rng(7)
    truth = random.normal(size=(4000, 2))
    scores = {
        (count, spread): energy_score(spread * random.normal(size=(count, 4000, 2)), truth).mean()
        for count in (2, 8) for spread in (0.3, 1.0, 2.0)
    }  # fmt: skip
    for count in (2, 8):
        assert scores[count, 1.0] < min(scores[count, 0.3], scores[count, 2.0])
    assert scores[2, 1.0] == pytest.approx(scores[8, 1.0], abs=0.05)
