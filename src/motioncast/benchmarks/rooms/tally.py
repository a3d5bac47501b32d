"""Figures of many windows of unequal size, each of which can say what it were had other rooms been drawn."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Protocol

import numpy as np

from motioncast.benchmarks.result import Row
from motioncast.benchmarks.scoring import Figure
from motioncast.metrics.bootstrap import draws


class Measured(Protocol):
    """A metric of all windows."""

    @property
    def metric(self) -> str:
        """Its name."""
        ...

    @property
    def frame(self) -> int:
        """Forecast frame, from 1, at or until which it is."""
        ...

    @property
    def unit(self) -> str:
        """Its unit."""
        ...

    @property
    def counts(self) -> np.ndarray:
        """How much of it each window holds, ``(windows,)``."""
        ...

    def mean(self, weights: np.ndarray) -> np.ndarray:
        """The figure where windows count ``(draws, windows)`` times, ``(draws,)``."""
        ...


@dataclass(frozen=True, slots=True, eq=False)
class Pooled:
    """A figure of all items of all windows together, such as a percentile.

    Attributes:
        metric: Name of the metric.
        frame: Forecast frame, from 1, until which it is.
        unit: Its unit.
        items: For each window its items, ``(n, ...)``.
        statistic: From items ``(n, ...)`` to the figure.
    """

    metric: str
    frame: int
    unit: str
    items: Sequence[np.ndarray]
    statistic: Callable[[np.ndarray], float]

    @property
    def counts(self) -> np.ndarray:
        """Number of items of each window."""
        return np.array([len(items) for items in self.items])

    def mean(self, weights: np.ndarray) -> np.ndarray:
        """See :class:`Measured`."""
        pool, owners = np.concatenate(list(self.items)), np.repeat(np.arange(len(self.items)), self.counts)
        drawn = (np.repeat(pool, row[owners].astype(int), axis=0) for row in weights)
        return np.array([self.statistic(items) if len(items) else np.nan for items in drawn])


@dataclass(frozen=True, slots=True, eq=False)
class Ratio:
    """One figure over another.

    Attributes:
        metric: Name of the ratio.
        above: What is divided.
        below: By what.
    """

    metric: str
    above: Measured
    below: Measured
    unit: str = "1"

    @property
    def frame(self) -> int:
        """That of the figure above."""
        return self.above.frame

    @property
    def counts(self) -> np.ndarray:
        """Those of the figure above."""
        return self.above.counts

    def mean(self, weights: np.ndarray) -> np.ndarray:
        """See :class:`Measured`."""
        return self.above.mean(weights) / self.below.mean(weights)


@dataclass(frozen=True, slots=True, eq=False)
class Mean:
    """The mean of several figures, such as those of several moments.

    Attributes:
        metric: Name of the mean.
        figures: What is averaged.
    """

    metric: str
    figures: Sequence[Measured]

    @property
    def frame(self) -> int:
        """That of the last figure."""
        return self.figures[-1].frame

    @property
    def unit(self) -> str:
        """That of the figures."""
        return self.figures[-1].unit

    @property
    def counts(self) -> np.ndarray:
        """Those of the figures together."""
        return np.sum([figure.counts for figure in self.figures], 0)

    def mean(self, weights: np.ndarray) -> np.ndarray:
        """See :class:`Measured`."""
        return np.mean([figure.mean(weights) for figure in self.figures], 0)


@dataclass(slots=True)
class Tally:
    """Sums and counts of metrics, window after window.

    Attributes:
        windows: Number of windows.
        horizon: Frame until which a metric is where nothing else is said.
        entries: Metric, frame and unit -> sums and counts, ``(2, windows)``.
    """

    windows: int
    horizon: int
    entries: dict[tuple[str, int, str], np.ndarray] = field(default_factory=dict)

    def add(self, window: int, metric: str, values: np.ndarray, unit: str, frame: int = 0) -> None:
        """Add the values of one window to a metric; NaN does not count."""
        table = self.entries.setdefault((metric, frame or self.horizon, unit), np.zeros((2, self.windows)))
        values = np.asarray(values, np.float64)
        known = ~np.isnan(values)
        table[:, window] += values[known].sum(), known.sum()

    def figures(self) -> dict[str, list[Measured]]:
        """The figures of what was measured anywhere, by the names of their metrics."""
        found: dict[str, list[Measured]] = {}
        for key, table in self.entries.items():
            if table[1].any():
                found.setdefault(key[0], []).append(Figure(*key, *table))
        return found


def rows(figures: Sequence[Measured], rooms: Sequence[str], fps: float, seed: int = 0) -> list[Row]:
    """Figures with 95 % intervals over rooms, which are drawn anew 1,000 times.

    Args:
        figures: The figures; those that no window holds are left out.
        rooms: The room of each window.
        fps: Frames a second.
        seed: Seed of the draws.
    """
    names = sorted(set(rooms))
    drawn = draws([[names.index(room)] for room in rooms], seed=seed)
    weights = np.concatenate([np.ones((1, len(rooms))), drawn])
    found = []
    for figure in figures:
        if not figure.counts.any():
            continue
        with np.errstate(invalid="ignore", divide="ignore"):  # a draw may hold no window in which it is measured
            values = figure.mean(weights)
        low, high = np.nanpercentile(values[1:], (2.5, 97.5)).tolist()
        windows = int((figure.counts > 0).sum())
        found.append(Row(figure.metric, figure.frame / fps, float(values[0]), figure.unit, windows, low, high))
    return found
