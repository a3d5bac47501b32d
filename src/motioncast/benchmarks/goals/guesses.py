"""Simple guesses of characteristic poses: each answers questions by a rule, with nothing trained.

Answers are ``(samples, starts, goals, joints, 3)`` metres around the hip in the directions of the world, the likeliest
first. What is learned from training poses is seen from where somebody stands, and turned to where they face.
"""

from __future__ import annotations

import numpy as np

from motioncast.benchmarks.goals.questions import GOALS, Questions
from motioncast.core.voxels import CELLS, corner_of

PACE_WEIGHT, PACE_FRAMES = 3.0, 3
"""How much the way of the last frames counts beside the last pose where neighbours are sought."""


def zero_velocity(asked: Questions) -> np.ndarray:
    """The last pose: one goal."""
    last = asked.histories[:, :, -1]
    return (last - last[:, :, :1])[:, :, None]


def average_pose(asked: Questions, train: Questions) -> np.ndarray:
    """The mean of the training poses: one goal."""
    mean = train.own_targets.mean((0, 1))
    return asked.to_world(np.broadcast_to(mean, (*asked.histories.shape[:2], 1, *mean.shape)))


def nearest_neighbours(asked: Questions, train: Questions, goals: int = GOALS) -> np.ndarray:
    """The poses that the most similar training histories led to, the most similar first, each moment once."""
    known, sought, targets = described(train), described(asked), train.own_targets
    answers = np.empty((*asked.histories.shape[:2], goals, *train.targets.shape[1:]))
    for sample, start in np.ndindex(*asked.histories.shape[:2]):
        apart = np.linalg.norm(known - sought[sample, start], axis=-1)  # samples, starts
        order = apart.min(1).argsort(kind="stable")[:goals]
        answers[sample, start] = targets[order, apart[order].argmin(1)]
    return asked.to_world(answers)


def random_voxels(asked: Questions, goals: int = GOALS, seed: int = 0) -> np.ndarray:
    """Every joint in the middle of a voxel of the cube that is drawn for it, all alike."""
    shape = (*asked.histories.shape[:2], goals, *asked.targets.shape[1:])
    drawn = np.random.default_rng(seed).integers(CELLS, size=shape)
    return asked.to_world(corner_of(drawn + 0.5))


def described(asked: Questions) -> np.ndarray:
    """What neighbours have in common: the last pose and how it came, ``(samples, starts, features)``."""
    around = asked.own - asked.own[..., :1, :]
    last, before = around[:, :, -1], around[:, :, -1 - PACE_FRAMES]
    return np.concatenate([last, PACE_WEIGHT * (last - before)], 2).reshape(*last.shape[:2], -1)
