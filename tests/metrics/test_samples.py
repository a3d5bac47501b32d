from __future__ import annotations

import numpy as np
import pytest

from motioncast.metrics.multimodal import mmade, mmfde, similar_pasts
from motioncast.metrics.samples import ade, apd, best_of, fde


@pytest.fixture
def drawn() -> tuple[np.ndarray, np.ndarray]:
    """Samples ``(windows 3, samples 4, time 5, people 2, joints 6, 3)`` and the truth."""
    random = np.random.default_rng(6)
    return random.normal(size=(3, 4, 5, 2, 6, 3)), random.normal(size=(3, 5, 2, 6, 3))


def test_naive_twins_of_ade_and_fde(drawn: tuple[np.ndarray, np.ndarray]) -> None:
    samples, truth = drawn
    observed = np.random.default_rng(0).random(truth.shape[:-1]) < 0.95
    for w, s, p in np.ndindex(3, 4, 2):
        norms = [
            np.linalg.norm((samples[w, s, f, p] - truth[w, f, p]).reshape(-1))
            for f in range(5) if observed[w, f, p].all()
        ]  # fmt: skip
        assert ade(samples, truth, observed)[w, s, p] == pytest.approx(np.mean(norms))
        last = np.linalg.norm((samples[w, s, -1, p] - truth[w, -1, p]).reshape(-1))
        mine = fde(samples, truth, observed)[w, s, p]
        assert mine == pytest.approx(last) if observed[w, -1, p].all() else np.isnan(mine)


def test_of_the_path_alone_they_are_errors_of_trajectories() -> None:
    truth = np.zeros((1, 3, 1, 1, 3))
    samples = truth[:, None] + [3.0, 4.0, 0.0]
    assert ade(samples, truth).item() == fde(samples, truth).item() == 5.0


def test_naive_twin_of_best_of(drawn: tuple[np.ndarray, np.ndarray]) -> None:
    errors = ade(*drawn)
    scenes = [min(errors[w, s].sum() for s in range(3)) for w in range(3)]
    people = [min(errors[w, s, p] for s in range(3)) for w in range(3) for p in range(2)]
    assert best_of("ade_m", errors, 3, "scene")["ade_m_best_of_3_per_scene"] == pytest.approx(sum(scenes) / 6)
    assert best_of("ade_m", errors, 3, "person")["ade_m_best_of_3_per_person"] == pytest.approx(np.mean(people))
    assert best_of("ade_m", errors, 3, "person")["ade_m_k1"] == pytest.approx(errors[:, 0].mean())


def test_the_freer_the_choice_the_better_it_looks(drawn: tuple[np.ndarray, np.ndarray]) -> None:
    errors = ade(*drawn)
    one, scene = best_of("e", errors, 4, "scene").values()
    _, person = best_of("e", errors, 4, "person").values()
    assert person < scene < one
    assert len(set(best_of("e", errors, 1, "scene").values())) == 1


def test_people_who_were_not_seen_choose_nothing() -> None:
    errors = np.array([[[1.0, np.nan], [2.0, np.nan]], [[5.0, 3.0], [4.0, 1.0]]])
    assert list(best_of("e", errors, 2, "scene").values()) == pytest.approx([3.0, 2.0])
    assert list(best_of("e", errors, 2, "person").values()) == pytest.approx([3.0, 2.0])


def test_more_samples_than_there_are_cannot_be_chosen_from(drawn: tuple[np.ndarray, np.ndarray]) -> None:
    with pytest.raises(ValueError, match="best of 5 was asked for; 4 samples came"):
        best_of("e", ade(*drawn), 5, "scene")


def test_naive_twin_of_apd(drawn: tuple[np.ndarray, np.ndarray]) -> None:
    samples, _ = drawn
    for w, p in np.ndindex(3, 2):
        apart = [
            np.linalg.norm((samples[w, a, :, p] - samples[w, b, :, p]).reshape(-1)) for a in range(4) for b in range(a)
        ]
        assert apd(samples)[w, p] == pytest.approx(np.mean(apart))
    assert apd(samples[:, :1]).tolist() == apd(np.repeat(samples[:, :1], 3, 1)).tolist() == [[0.0, 0.0]] * 3


def test_invariances(drawn: tuple[np.ndarray, np.ndarray]) -> None:
    samples, truth = drawn
    for metric in (ade, fde):
        np.testing.assert_allclose(metric(samples[:, :, :, ::-1], truth[:, :, ::-1]), metric(samples, truth)[..., ::-1])
        np.testing.assert_allclose(metric(samples[1:2], truth[1:2]), metric(samples, truth)[1:2])
        np.testing.assert_allclose(metric(samples + 7, truth + 7), metric(samples, truth))
        assert metric(truth[:, None], truth).max() == 0
    errors = ade(samples, truth)
    for level in ("scene", "person"):
        wanted = best_of("e", errors, 4, level)
        assert best_of("e", np.repeat(errors[..., ::-1], 64, 0), 4, level) == pytest.approx(wanted)


def test_naive_twins_of_the_multimodal_errors(drawn: tuple[np.ndarray, np.ndarray]) -> None:
    samples, truth = (array[..., 0, :, :] for array in drawn)
    similar = np.array([[True, True, False], [True, True, True], [False, True, True]])
    for window in range(3):
        average, final = [], []
        for other in np.flatnonzero(similar[window]):
            norms = np.array([
                [np.linalg.norm(samples[window, s, f] - truth[other, f]) for f in range(5)] for s in range(4)
            ])  # fmt: skip
            average.append(norms.mean(1).min())
            final.append(norms[:, -1].min())
        assert mmade(samples, truth, similar)[window] == pytest.approx(np.mean(average))
        assert mmfde(samples, truth, similar)[window] == pytest.approx(np.mean(final))


def test_with_no_other_future_the_multimodal_errors_are_those_of_the_best_sample(
    drawn: tuple[np.ndarray, np.ndarray],
) -> None:
    samples, truth = drawn[0][..., :1, :, :], drawn[1][..., :1, :, :]
    alone = np.eye(3, dtype=bool)
    best = ade(samples, truth).min(1)[:, 0]
    np.testing.assert_allclose(mmade(samples[..., 0, :, :], truth[..., 0, :, :], alone), best)


def test_every_window_resembles_itself() -> None:
    poses = np.random.default_rng(0).normal(size=(4, 5, 3))
    assert (similar_pasts(poses, 0.0) == np.eye(4, dtype=bool)).all()
    assert (similar_pasts(poses) == similar_pasts(poses).T).all()
