"""The figures of answers to cmu-goals, with 95 % intervals over takes."""

from __future__ import annotations

from dataclasses import asdict

import numpy as np

from motioncast.benchmarks.goals.guesses import zero_velocity
from motioncast.benchmarks.goals.questions import PROTOCOL, Questions
from motioncast.benchmarks.result import Result, Row, commit
from motioncast.core.card import ModelCard
from motioncast.core.skeletons import H36M17
from motioncast.metrics.bootstrap import draws, units
from motioncast.metrics.goals import (
    PARTS,
    conditional_inception_score,
    diversity,
    diversity_weights,
    mpjpe_of_best,
    mpjpe_of_most_likely,
    part_errors,
)

BEST = f"mpjpe_best_of_{PROTOCOL.goals}"
FIRST = "mpjpe_most_likely"


def score(asked: Questions, poses: np.ndarray, probabilities: np.ndarray | None = None) -> list[Row]:
    """Every figure of answers: means over samples and starts, errors from each start, and last the ratio to stillness.

    Args:
        asked: The questions.
        poses: ``(samples, starts, goals, joints, 3)`` metres around the hip, the most likely goal first.
        probabilities: What a classifier says of each pose, ``(samples, starts, goals, classes)``.
    """
    each = figures(asked, poses, probabilities)
    still = mpjpe_of(zero_velocity(asked), asked)
    owners = units([[(take, 0.0)] for take in asked.takes])[1]
    drawn = np.concatenate([np.ones((1, len(asked))), draws(owners)])
    drawn /= drawn.sum(1, keepdims=True)
    count = len(asked) * len(PROTOCOL.starts)
    rows = [_row(metric, drawn @ values.mean(1), _unit(metric), count) for metric, values in each.items()]
    for metric in (BEST, FIRST):
        if metric in each:
            rows += [
                _row(f"{metric}_from_start_{number}", drawn @ values, "m", len(asked))
                for number, values in enumerate(each[metric].T, 1)
            ]
    error = each.get(BEST, each[FIRST])
    return [*rows, _row("ratio_to_zero_velocity", (drawn @ error.mean(1)) / (drawn @ still.mean(1)), "1", count)]


def figures(asked: Questions, poses: np.ndarray, probabilities: np.ndarray | None) -> dict[str, np.ndarray]:
    """Metric -> value of each sample and start, ``(samples, starts)``. One goal has no best, no diversity, no score."""
    shape, truth = poses.shape[:2], np.repeat(asked.targets, poses.shape[1], 0)
    flat = poses.reshape(-1, *poses.shape[2:])
    found = {FIRST: mpjpe_of_most_likely(flat, truth)}
    if poses.shape[2] == PROTOCOL.goals:
        found[BEST] = mpjpe_of_best(flat, truth)
        found["diversity"] = diversity(flat)
        found["diversity_weighted"] = diversity(flat, diversity_weights(H36M17.landmarks))
        if probabilities is not None:
            found["inception_score"] = conditional_inception_score(probabilities.reshape(-1, *probabilities.shape[2:]))
    parts = part_errors(flat, truth, H36M17.landmarks)
    found |= {f"mpjpe_{part.replace(' ', '_')}": parts[part] for part in PARTS}
    return {metric: values.reshape(shape) for metric, values in found.items()}


def mpjpe_of(poses: np.ndarray, asked: Questions) -> np.ndarray:
    """Error of the most likely pose of each sample and start, ``(samples, starts)`` metres."""
    truth = np.repeat(asked.targets, poses.shape[1], 0)
    return mpjpe_of_most_likely(poses.reshape(-1, *poses.shape[2:]), truth).reshape(poses.shape[:2])


def result_of(card: ModelCard, asked: Questions, rows: list[Row], split: str = "test") -> Result:
    """The result of a model whose figures are known."""
    return Result(
        model=card.name,
        benchmark=PROTOCOL.name,
        protocol=asked.protocol_hash(),
        data=asked.checksum(),
        setting={**asdict(PROTOCOL), "split": split},
        windows=len(asked) * len(PROTOCOL.starts),
        takes=len(set(asked.takes)),
        independent=units([[(take, 0.0)] for take in asked.takes])[0],
        weights=card.checksum,
        parameters=card.parameters,
        training=card.training,
        command="python benchmarks/goals_table.py --data DIR --baselines FOLDER",
        commit=commit(),
        seed=PROTOCOL.seed,
        rows=tuple(rows),
    )


def _row(metric: str, values: np.ndarray, unit: str, count: int) -> Row:
    """The figure, first of the values, with the interval of the others."""
    low, high = np.percentile(values[1:], (2.5, 97.5)).tolist()
    return Row(metric, 0.0, float(values[0]), unit, count, low, high)


def _unit(metric: str) -> str:
    return "1" if metric == "inception_score" else "m"
