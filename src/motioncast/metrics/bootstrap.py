"""Intervals of a figure: what might it have been, had other takes been captured?

Windows of one take overlap and resemble one another, so windows are never drawn: takes are, or, where there are fewer
than ten, blocks of 8 s of them.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

FEWEST_TAKES = 10
"""With fewer takes, blocks of them are drawn instead."""

BLOCK_S = 8.0
"""Length of a block in seconds."""


@dataclass(frozen=True, slots=True)
class Interval:
    """A figure and the 95 % interval of it.

    Attributes:
        figure: The mean over all windows.
        low: 2.5th percentile of the figures of resampled units.
        high: 97.5th percentile.
        n: Number of units that were drawn.
        of: What the units are.
    """

    figure: float
    low: float
    high: float
    n: int
    of: str

    def __str__(self) -> str:
        return f"{self.figure:.4g} [{self.low:.4g}, {self.high:.4g}] (n = {self.n} {self.of})"


def interval(
    sums: np.ndarray,
    counts: np.ndarray,
    sources: Sequence[Sequence[tuple[str, float]]],
    resamples: int = 1000,
    seed: int = 0,
) -> Interval:
    """The mean error of windows with its 95 % bootstrap interval over the takes that they come from.

    A window composed of several takes counts as often as the product of theirs is drawn (Owen, The pigeonhole
    bootstrap, Annals of Applied Statistics 1 (2007) 386).

    Args:
        sums: Sum of the errors of each window, ``(windows,)``.
        counts: Number of errors in each sum.
        sources: For each window the takes that it comes from, each with the second at which it starts there.
        resamples: How often the units are drawn.
        seed: Seed of the draws.

    Example:
        >>> two_takes = [[("a", 0.0)], [("a", 1.0)], [("a", 9.0)], [("b", 0.0)]]
        >>> print(interval(np.ones(4), np.ones(4), two_takes))
        1 [1, 1] (n = 3 blocks of 8 s of 2 takes)
    """
    of, owners = units(sources)
    weights = draws(owners, resamples, seed)
    weights = weights[(weights @ counts) > 0]  # with a handful of units a draw may hold no window
    low, high = np.percentile((weights @ sums) / (weights @ counts), (2.5, 97.5)).tolist()
    return Interval(float(np.sum(sums) / np.sum(counts)), low, high, count(owners), of)


def count(owners: Sequence[Sequence[int]]) -> int:
    """Number of units."""
    return 1 + max(unit for window in owners for unit in window)


def draws(owners: Sequence[Sequence[int]], resamples: int = 1000, seed: int = 0) -> np.ndarray:
    """How often each window counts in each resampling of the units, ``(resamples, windows)``.

    Args:
        owners: For each window the numbers of the units that it comes from (:func:`units`).
        resamples: How often the units are drawn.
        seed: Seed of the draws.

    Example:
        >>> draws([[0], [1], [0, 1]], resamples=3).tolist()
        [[1.0, 1.0, 1.0], [1.0, 1.0, 1.0], [0.0, 2.0, 0.0]]
    """
    n = count(owners)
    drawn = np.random.default_rng(seed).multinomial(n, np.full(n, 1 / n), resamples)
    return np.stack([drawn[:, window].prod(1) for window in owners], 1).astype(float)


def units(sources: Sequence[Sequence[tuple[str, float]]]) -> tuple[str, list[list[int]]]:
    """What is drawn, in words, and for each window the numbers of the units that it comes from.

    Example:
        >>> units([[("a", 0.0)], [("b", 1.0), ("a", 8.0)]])
        ('blocks of 8 s of 2 takes', [[0], [1, 2]])
    """
    takes = sorted({take for window in sources for take, _ in window})
    if len(takes) >= FEWEST_TAKES:
        return "takes", [sorted({takes.index(take) for take, _ in window}) for window in sources]
    blocks = [{(take, int(start // BLOCK_S)) for take, start in window} for window in sources]
    known = sorted({block for window in blocks for block in window})
    return (
        f"blocks of {BLOCK_S:g} s of {len(takes)} take{'s' * (len(takes) > 1)}",
        [sorted(map(known.index, window)) for window in blocks],
    )
