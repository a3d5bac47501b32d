"""What a model of goals answers to the questions of cmu-goals."""

from __future__ import annotations

from collections.abc import Callable
from typing import Protocol

import numpy as np

from motioncast.benchmarks.goals.questions import GOALS, PROTOCOL, Questions
from motioncast.core.card import ModelCard
from motioncast.core.goal_poses import GoalPoses
from motioncast.core.scene import Scene
from motioncast.core.skeletons import H36M17

TOGETHER = 10
"""Questions that are asked at once, as people of one scene who have nothing to do with one another."""


class GoalModel(Protocol):
    """A model of goals (``inference.goals.GoalForecaster``)."""

    @property
    def card(self) -> ModelCard:
        """Its card."""
        ...

    def forecast(self, scene: Scene, *, samples: int = GOALS, seed: int = 0) -> GoalPoses:
        """Goals of the people of a scene."""
        ...


def answers(
    model: GoalModel, asked: Questions, goals: int = GOALS, progress: Callable[[float], None] = lambda share: None
) -> np.ndarray:
    """A model's goals, ``(samples, starts, goals, joints, 3)`` metres around the hip, the most likely first.

    Args:
        model: The model.
        asked: The questions.
        goals: Poses asked for.
        progress: Told how much is done.
    """
    histories = asked.histories.reshape(-1, *asked.histories.shape[2:])
    found = []
    for first in range(0, len(histories), TOGETHER):
        some = histories[first : first + TOGETHER].swapaxes(0, 1)
        names = tuple(f"question {first + number}" for number in range(some.shape[1]))
        scene = Scene(some, H36M17, PROTOCOL.fps, people=names)
        found.append(model.forecast(scene, samples=goals, seed=PROTOCOL.seed).poses.swapaxes(0, 1))
        progress(min(first + TOGETHER, len(histories)) / len(histories))
    poses = np.concatenate(found).astype(np.float64)
    poses -= poses[:, :, :1]
    return poses.reshape(*asked.histories.shape[:2], *poses.shape[1:])
