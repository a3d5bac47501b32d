"""From noise to a signal: the samplers of a diffusion whose network predicts what is clean.

A noisy signal is ``x = a clean + s n`` with ``a^2 = abar``, ``s^2 = 1 - abar`` and normal noise n. Every sampler here
goes from the noisiest level to the clean one by the same move, :func:`towards`, and differs only in what it takes for
clean: the network's last word (DDIM), that and its trend (DPM-Solver++), or the mean of both ends (UniPC).

Papers: Ho, Jain, Abbeel, "Denoising Diffusion Probabilistic Models", 2020; Song, Meng, Ermon, "Denoising Diffusion
Implicit Models", 2021; Lu et al., "DPM-Solver++", 2022; Zhao et al., "UniPC", 2023.
"""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from motioncast.core.schedule import cosine_abar

Denoise = Callable[[np.ndarray, int], np.ndarray]
"""What a network takes for clean: noisy signal, step of the schedule -> clean signal."""

Noise = Callable[[], np.ndarray]
"""Standard normal numbers of the signal's shape, others at each call."""

LOWEST_LOG_SNR = -10.2
"""No sampler of few steps begins below this: there is nothing left to see, and the last steps of a cosine schedule
are so far apart in log-SNR that a solver's trend over them means nothing."""


@dataclass(frozen=True, slots=True)
class Level:
    """A level of noise.

    Attributes:
        step: Step of the schedule; -1 is clean.
        signal: Share of the clean signal in the noisy one.
        noise: Share of the noise.
    """

    step: int
    signal: float
    noise: float

    @property
    def half_log_snr(self) -> float:
        """The solvers' time, lambda; not of the clean level."""
        return float(np.log(self.signal / self.noise))


CLEAN = Level(-1, 1.0, 0.0)

Estimate = tuple[Level, np.ndarray]
"""A level and what the network took for clean there."""


@dataclass(frozen=True, slots=True, eq=False)
class Schedule:
    """How noisy each step of a diffusion is.

    Attributes:
        abar: Share of the clean signal's variance at each step, ``(steps,)``, falling.
    """

    abar: np.ndarray

    @classmethod
    def cosine(cls, steps: int = 1000, shift: float = 0.0) -> Schedule:
        """The cosine schedule (:func:`motioncast.core.schedule.cosine_abar`)."""
        return cls(cosine_abar(steps, shift))

    @property
    def log_snr(self) -> np.ndarray:
        """Logarithm of signal over noise, in variances, ``(steps,)``."""
        return np.log(self.abar) - np.log1p(-self.abar)

    def levels(self, count: int) -> list[Level]:
        """So many levels, evenly spread over the steps, the noisiest first, and the clean one.

        The last noisy one is a quarter of a stride from clean: what is taken for clean there is the answer, and the
        noisier, the more it is a mean of several.

        Example:
            >>> [level.step for level in Schedule.cosine().levels(5)]
            [995, 759, 522, 286, 50, -1]
        """
        usable = max(count, int((self.log_snr >= LOWEST_LOG_SNR).sum()))
        steps = np.linspace(usable - 1, len(self.abar) / count / 4, count).round().astype(int)
        shares = zip(steps.tolist(), self.abar[steps].tolist(), strict=True)
        return [*(Level(step, share**0.5, (1 - share) ** 0.5) for step, share in shares), CLEAN]


def towards(x: np.ndarray, clean: np.ndarray, now: Level, then: Level) -> np.ndarray:
    """A noisy signal at a cleaner level, with the same noise, if ``clean`` is what it holds."""
    kept = then.noise / now.noise
    return kept * x + (then.signal - now.signal * kept) * clean


def ddpm(levels: Sequence[Level], denoise: Denoise, noise: Noise) -> np.ndarray:
    """The chain as trained: the mean of what may have been, and new noise (Ho et al., Eq. 7)."""
    x = noise()
    for now, then in pairwise(levels):
        clean = denoise(x, now.step)
        share = (now.signal / then.signal) ** 2
        mean = then.signal * (1 - share) * clean + np.sqrt(share) * then.noise**2 * x
        x = mean / now.noise**2 + np.sqrt(1 - share) * then.noise / now.noise * noise()
    return x


def ddim(levels: Sequence[Level], denoise: Denoise, noise: Noise, eta: float = 0.0) -> np.ndarray:
    """Fewer steps, with a share of new noise: none at eta 0, that of DDPM at eta 1 (Song et al., Eq. 12 and 16)."""
    x = noise()
    for now, then in pairwise(levels):
        clean = denoise(x, now.step)
        new = eta * then.noise / now.noise * np.sqrt(1 - (now.signal / then.signal) ** 2)
        old = Level(then.step, then.signal, np.sqrt(then.noise**2 - new**2))
        x = towards(x, clean, now, old) + (new * noise() if new else 0.0)
    return x


def dpm_solver(levels: Sequence[Level], denoise: Denoise, noise: Noise) -> np.ndarray:
    """DPM-Solver++(2M): the estimate's trend is carried on to the middle of the next step (Lu et al., Alg. 2)."""
    x = noise()
    known: list[Estimate] = []
    for now, then in pairwise(levels):
        known = [(now, denoise(x, now.step)), *known[:1]]
        x = towards(x, carried_on(known, then), now, then)
    return x


def unipc(levels: Sequence[Level], denoise: Denoise, noise: Noise) -> np.ndarray:
    """UniPC-2 with B2(h): as DPM-Solver++(2M), and each estimate also corrects the step that led to it (Alg. 1-2)."""
    x = noise()
    start, known = x, list[Estimate]()
    for now, then in pairwise(levels):
        estimate = now, denoise(x, now.step)
        if known:
            start = towards(start, corrected(known, estimate), known[0][0], now)
        known = [estimate, *known[:1]]
        x = towards(start, carried_on(known, then), now, then)
    return x


def carried_on(known: Sequence[Estimate], then: Level) -> np.ndarray:
    """What holds for clean on the way to a level, from the last one or two estimates, the newest first."""
    now, clean = known[0]
    if len(known) == 1 or then is CLEAN:
        return clean
    before, last = known[1]
    ratio = (then.half_log_snr - now.half_log_snr) / (now.half_log_snr - before.half_log_snr)
    return clean + ratio / 2 * (clean - last)


def corrected(known: Sequence[Estimate], estimate: Estimate) -> np.ndarray:
    """The same for a step already made, with the estimate at its end: the solution of UniPC's two equations."""
    (before, last), (now, clean) = known[0], estimate
    if len(known) == 1:
        return (last + clean) / 2
    earlier, oldest = known[1]
    step = before.half_log_snr - now.half_log_snr
    phi = np.expm1(step) / step - 1
    first, second = phi / np.expm1(step), 2 * (phi / step - 0.5) / np.expm1(step)
    ratio = (before.half_log_snr - earlier.half_log_snr) / step
    trend = (first - second) / (1 - ratio)
    return last + trend / ratio * (oldest - last) + (first - trend) * (clean - last)


Sampler = Callable[[Sequence[Level], Denoise, Noise], np.ndarray]

SAMPLERS: dict[str, Sampler] = {"ddpm": ddpm, "ddim": ddim, "dpm-solver++": dpm_solver, "unipc": unipc}
"""Samplers by name. Each asks the network once a level."""


def noise_of(people: Sequence[str], shape: tuple[int, ...], seed: int, sample: int) -> Noise:
    """Each person's own noise ``(people, *shape)``, whoever else is there and in whatever order.

    Args:
        people: Their ids.
        shape: Shape of one person's signal.
        seed: Seed of the samples.
        sample: Number of the sample.

    Example:
        >>> pair, alone = noise_of(["ada", "bea"], (2,), 0, 0), noise_of(["bea"], (2,), 0, 0)
        >>> bool((pair()[1] == alone()[0]).all()), bool((pair()[1] == alone()[0]).all())
        (True, True)
    """
    seeds = [hashlib.sha256(f"{seed} {sample} {person}".encode()).digest() for person in people]
    sources = [np.random.default_rng(int.from_bytes(digest)) for digest in seeds]
    return lambda: np.stack([source.standard_normal(shape) for source in sources])
