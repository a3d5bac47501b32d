"""Samplers against an independent implementation, and where the perfect network is known.

The golden trajectories are those of diffusers 0.42 in float64 (DDPMScheduler with ``fixed_small``, DDIMScheduler,
DPMSolverMultistepScheduler with ``dpmsolver++``, ``midpoint``, order 2, and UniPCMultistepScheduler with ``bh2``,
order 2, both with ``lower_order_final`` and ``final_sigmas_type="zero"``; all ``squaredcos_cap_v2`` and
``prediction_type="sample"``). Its time steps, ``alphas_cumprod`` and ``sigmas`` were overwritten with ours in float64,
DDIM's fixed stride with that of each step; noise came from ``default_rng(0).standard_normal(3)``, one call a draw, and
``network`` stood for the network.
"""

from __future__ import annotations

from functools import partial

import numpy as np
import pytest
from scipy.stats import norm, qmc

from motioncast.inference.diffusion import CLEAN, SAMPLERS, Schedule, ddim, noise_of

SCHEDULE = Schedule.cosine()

GOLDEN = {
    "ddpm": [
        [0.1566097, -0.570163569, 0.501104708], [1.135427198, 0.218796281, -0.075939404],
        [0.186439516, -0.01628635, -0.094939756], [-0.405465805, -0.101530746, -0.578447171],
        [-0.783157903, -0.296202226, -0.84412617], [-0.961333543, -0.695780058, -0.966711963],
    ],
    "ddim": [
        [0.17306725, -0.181585504, 0.752282079], [0.236945371, -0.24787882, 0.829611536],
        [0.329503599, -0.34272137, 0.869557448], [0.474550001, -0.48842453, 0.878400736],
        [0.729528759, -0.738360823, 0.886028609], [0.954710997, -0.955949862, 0.969430244],
    ],
    "ddim, eta 0.5": [
        [0.207181957, -0.420366726, 0.843308843], [0.748676485, -0.147805887, 0.591847987],
        [0.450301738, -0.37809785, 0.674930135], [0.22388358, -0.565860045, 0.552046314],
        [0.440224852, -0.807105566, 0.767531082], [0.8487456, -0.963679526, 0.959614174],
    ],
    "dpm-solver++": [
        [0.173067244, -0.181585505, 0.752282033], [0.240119185, -0.25115477, 0.83276606],
        [0.353018837, -0.366611615, 0.885624171], [0.551387566, -0.564455858, 0.914776919],
        [0.958145986, -0.957836346, 0.982739383], [0.972780922, -0.972769394, 0.973631776],
    ],
    "unipc": [
        [0.17306725, -0.181585504, 0.752282079], [0.253344372, -0.264805438, 0.845911091],
        [0.388657645, -0.402661881, 0.905971164], [0.599302311, -0.610984473, 0.930021368],
        [0.966270123, -0.964500883, 0.986118105], [0.973075905, -0.973012877, 0.973739218],
    ],
}  # fmt: skip
"""The signal after each of six passes."""


def network(x: np.ndarray, step: int) -> np.ndarray:
    return np.tanh(3 * x) * (1 - step / 2000)


@pytest.mark.parametrize("name", GOLDEN)
def test_samplers_follow_an_independent_implementation(name: str) -> None:
    sampler = partial(ddim, eta=0.5) if name == "ddim, eta 0.5" else SAMPLERS[name]
    path: list[np.ndarray] = []

    def watched(x: np.ndarray, step: int) -> np.ndarray:
        path.append(x)
        return network(x, step)

    source = np.random.default_rng(0)
    path.append(sampler(SCHEDULE.levels(6), watched, lambda: source.standard_normal(3)))
    np.testing.assert_allclose(path[1:], GOLDEN[name], rtol=0, atol=1e-6)


def test_ddim_with_all_its_noise_is_ddpm() -> None:
    answers = []
    for sampler in (SAMPLERS["ddpm"], partial(ddim, eta=1.0)):
        source = np.random.default_rng(3)
        answers.append(sampler(SCHEDULE.levels(40), network, lambda source=source: source.standard_normal(5)))
    np.testing.assert_allclose(*answers, atol=1e-12)


@pytest.mark.parametrize("name", SAMPLERS)
def test_each_level_is_asked_once_and_the_last_word_is_the_networks(name: str) -> None:
    asked: list[tuple[int, np.ndarray]] = []

    def watched(x: np.ndarray, step: int) -> np.ndarray:
        asked.append((step, network(x, step)))
        return asked[-1][1]

    levels = SCHEDULE.levels(7)
    answer = SAMPLERS[name](levels, watched, np.random.default_rng(0).standard_normal)  # pyright: ignore[reportArgumentType]
    assert [step for step, _ in asked] == [level.step for level in levels[:-1]]
    np.testing.assert_allclose(answer, asked[-1][1], atol=1e-12)


def test_a_thousand_levels_are_the_schedule_and_few_leave_out_its_blind_end() -> None:
    assert [level.step for level in SCHEDULE.levels(1000)] == [*range(999, -1, -1), -1]
    for count in (1, 5, 20, 100):
        levels = SCHEDULE.levels(count)
        assert len(levels) == count + 1
        assert levels[-1] is CLEAN
        assert SCHEDULE.log_snr[levels[0].step] > -10.2
    assert SCHEDULE.log_snr[996] < -10.2


MEANS = np.random.default_rng(1).standard_normal((5, 8))
SPREAD = 0.3
DIRECTIONS = np.random.default_rng(2).standard_normal((8, 64))
DIRECTIONS /= np.linalg.norm(DIRECTIONS, axis=0)
FLOOR = 0.011
"""How far two draws of 20,000 points of the data are apart."""


def spread_evenly(seed: int) -> np.ndarray:
    """Normal numbers without the luck of the draw, ``(8192, 8)``."""
    return norm.ppf(qmc.Sobol(8, rng=seed).random(8192))


def posterior_mean(x: np.ndarray, step: int) -> np.ndarray:
    """What a perfect network takes for clean: the mean of all that the noisy signal may stand for."""
    abar = SCHEDULE.abar[step]
    variance = abar * SPREAD**2 + 1 - abar
    score = (np.sqrt(abar) * (x @ MEANS.T) - abar / 2 * np.square(MEANS).sum(1)) / variance
    share = np.exp(score - score.max(1, keepdims=True))
    mean = share @ MEANS / share.sum(1, keepdims=True)
    return mean + np.sqrt(abar) * SPREAD**2 / variance * (x - np.sqrt(abar) * mean)


@pytest.mark.parametrize(
    ("name", "count", "most"),
    [("dpm-solver++", 50, 1.5 * FLOOR), ("unipc", 50, 1.5 * FLOOR), ("dpm-solver++", 20, 0.03), ("unipc", 20, 0.03),
     ("ddim", 100, 0.015)],
)  # fmt: skip
def test_with_a_perfect_network_few_steps_draw_from_the_data(name: str, count: int, most: float) -> None:
    """Mean Wasserstein-1 distance along directions, of a mixture of five modes in eight dimensions."""
    drawn = SAMPLERS[name](SCHEDULE.levels(count), posterior_mean, lambda: spread_evenly(3))
    data = MEANS[np.arange(8192) % 5] + SPREAD * spread_evenly(4)
    assert np.abs(np.sort(drawn @ DIRECTIONS, 0) - np.sort(data @ DIRECTIONS, 0)).mean() < most


def test_a_persons_noise_is_its_own() -> None:
    trio, pair = noise_of(["ada", "bea", "cy"], (4, 2), 7, 0), noise_of(["cy", "ada"], (4, 2), 7, 0)
    for _ in range(3):
        np.testing.assert_array_equal(trio()[[2, 0]], pair())
    first = noise_of(["ada"], (50,), 7, 0)()
    for other in (noise_of(["ada"], (50,), 7, 1), noise_of(["ada"], (50,), 8, 0), noise_of(["ida"], (50,), 7, 0)):
        assert np.abs(first - other()).max() > 0.5
