"""From forecasts to figures: errors of each window, means over windows, intervals over takes."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from motioncast.benchmarks.protocol import Protocol
from motioncast.benchmarks.result import Row
from motioncast.core.skeletons import SKELETONS
from motioncast.datasets.windows import COMPOSED, Windows
from motioncast.metrics.alignment import root_joints
from motioncast.metrics.bootstrap import count, draws, units
from motioncast.metrics.position import joint_errors


@dataclass(frozen=True, slots=True, eq=False)
class Figure:
    """A metric of all windows: a sum of errors over a count of what was seen.

    Attributes:
        metric: Name of the metric.
        frame: Forecast frame, from 1, at or until which it is.
        unit: What it is printed in.
        sums: Sum of the errors of each window, ``(windows,)``, in that unit.
        counts: Number of errors in each sum.
    """

    metric: str
    frame: int
    unit: str
    sums: np.ndarray
    counts: np.ndarray

    def mean(self, weights: np.ndarray) -> np.ndarray:
        """The figure where windows count ``(..., windows)`` times."""
        return (weights @ self.sums) / (weights @ self.counts)


def score(protocol: Protocol, windows: Windows, forecasts: np.ndarray) -> list[Row]:
    """The rows of a result.

    Every metric at its moments, then the mean of the summary's moments over that of standing still.

    Args:
        protocol: What is scored.
        windows: The truth.
        forecasts: ``(windows, time, people, joints, 3)`` metres.
    """
    truth, observed = windows.future
    still = np.broadcast_to(windows.positions[:, windows.history - 1 : windows.history], truth.shape)
    figures = figures_of(protocol, forecasts, truth, observed)
    references = figures_of(protocol, still, truth, observed)
    summary = [
        index for index, figure in enumerate(figures)
        if figure.metric == f"{protocol.metric}_at" and figure.frame in protocol.summary
    ]  # fmt: skip
    # one row for the figures as they are, the others for what might have been captured instead
    _, owners = units(sources_of(protocol, windows))
    drawn = draws(owners)
    weights = np.concatenate([np.ones((1, len(windows))), drawn[drawn.any(1)]])
    table = [(figure.metric, figure.frame, figure.unit, figure.mean(weights)) for figure in figures]
    means = [np.mean([group[index].mean(weights) for index in summary], 0) for group in (figures, references)]
    ratio = means[0] / means[1]
    if protocol.metric == "vim":
        frames = [figure.mean(weights) for figure in every_frame(protocol, forecasts, truth, observed)]
        table.append(("vim_mean_of_moments", protocol.horizon, "cm", means[0]))
        table.append(("vim_mean_of_frames", protocol.horizon, "cm", np.mean(frames, 0)))
    table.append(("ratio_to_zero_velocity", protocol.summary[-1], "1", ratio))
    rows = []
    for metric, frame, unit, values in table:
        low, high = np.percentile(values[1:], (2.5, 97.5)).tolist()
        rows.append(Row(metric, frame / protocol.fps, float(values[0]), unit, len(windows), low, high))
    return rows


def figures_of(protocol: Protocol, forecast: np.ndarray, truth: np.ndarray, observed: np.ndarray) -> list[Figure]:
    """The metrics of a protocol at its moments."""
    skeleton = SKELETONS[protocol.skeleton]
    errors = joint_errors(forecast, truth)
    if protocol.metric == "vim":
        return [_vim(errors, observed, moment) for moment in protocol.moments]
    root = list(root_joints(skeleton))
    paths = [positions[:, :, :, root].mean(3) for positions in (forecast, truth)]
    path_seen = np.asarray(observed[..., root].all(-1))
    aligned = joint_errors(forecast - paths[0][..., None, :], truth - paths[1][..., None, :])
    found = [_mm("mpjpe_at", errors, observed, moment) for moment in protocol.moments]
    found += [_mm("mpjpe_until", errors, observed, moment, until=True) for moment in protocol.summary]
    found += [_mm("root_aligned_mpjpe_at", aligned, observed & path_seen[..., None], m) for m in protocol.summary]
    found += [_mm("root_error_at", joint_errors(*paths), path_seen, moment) for moment in protocol.summary]
    return found


def every_frame(protocol: Protocol, forecast: np.ndarray, truth: np.ndarray, observed: np.ndarray) -> list[Figure]:
    """VIM at every frame of the horizon."""
    errors = joint_errors(forecast, truth)
    return [_vim(errors, observed, frame) for frame in range(1, protocol.horizon + 1)]


def _mm(metric: str, errors: np.ndarray, seen: np.ndarray, frame: int, *, until: bool = False) -> Figure:
    frames = slice(0 if until else frame - 1, frame)
    errors, seen = errors[:, frames], seen[:, frames]
    axes = tuple(range(1, errors.ndim))
    return Figure(metric, frame, "mm", 1000 * np.where(seen, errors, 0).sum(axes), seen.sum(axes))


def _vim(errors: np.ndarray, observed: np.ndarray, frame: int) -> Figure:
    whole = observed[:, frame - 1].all(-1)  # a person counts where all joints were seen
    norms = np.sqrt(np.square(errors[:, frame - 1]).sum(-1))
    return Figure("vim_at", frame, "cm", 100 * np.where(whole, norms, 0).sum(1), whole.sum(1))


def sources_of(protocol: Protocol, windows: Windows) -> list[list[tuple[str, float]]]:
    """The takes that each window comes from, and the second of each at which it starts."""
    return [
        [(take, start / protocol.fps) for take, start in zip(names.split(COMPOSED), starts, strict=True)]
        for names, starts in zip(windows.takes, windows.starts, strict=True)
    ]


def independent(protocol: Protocol, windows: Windows) -> str:
    """What intervals are drawn over, in words."""
    what, owners = units(sources_of(protocol, windows))
    return f"{count(owners)} {what}"
