"""Learning from composed rooms as other models do: a history in, one future out, furniture unseen.

SAST's rivals learn from the rooms that it learns from (``training/rooms_task.py``), not from the takes of CMU's own
split, which hold takes of the rooms that are measured.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import torch

from motioncast.core.skeletons import SKELETONS
from motioncast.datasets.mixer import turned
from motioncast.datasets.windows import Windows
from motioncast.training.ahead import ahead
from motioncast.training.batches import Batch
from motioncast.training.recipe import Recipe
from motioncast.training.rooms_task import VALIDATION_ROOMS, VALIDATION_SEED, Kept, draw, keep
from motioncast.training.windows_task import WindowsTask

VALIDATION_WINDOWS = 400


class RoomWindowsTask(WindowsTask):
    """Windows of rooms built from the training takes, as long as the model reads and answers.

    Args:
        recipe: What is trained; ``rooms`` of them are built by its seed, and a window has at most as many people as the
            largest of ``people``.
        model: The model that learns; its configuration says what a window is.
        data: Folder with CMU's takes (``datasets.cmu``).
    """

    def __init__(self, recipe: Recipe, model: Any, data: Path) -> None:
        self.recipe, self.config, self.own_loss = recipe, model.config, model.loss
        skeleton = SKELETONS[self.config.skeleton]
        self.mirror = list(skeleton.mirror())
        self.train = empty(keep(data, "train", recipe.rooms, recipe.seed, skeleton))
        held_out = empty(keep(data, "validation", VALIDATION_ROOMS, VALIDATION_SEED, skeleton))
        checks = self.batch(held_out, VALIDATION_WINDOWS, np.random.default_rng(VALIDATION_SEED), mirror=0.0)
        unnamed = ("rooms",) * VALIDATION_WINDOWS, ((0,),) * VALIDATION_WINDOWS
        self.checks = {"rooms": Windows(checks.positions, checks.observed, *unnamed, self.config.history)}
        if hasattr(model, "fit_statistics"):
            drawn = self.batch(self.train, 1000, np.random.default_rng(recipe.seed), recipe.mirror)
            history = drawn.positions[:, : self.config.history, 0]
            whole = drawn.observed[:, : self.config.history, 0].all((1, 2))
            model.fit_statistics(torch.from_numpy(history[whole]))

    def batches(self, random: np.random.Generator) -> Iterator[Batch]:
        """Batches without end, the next ones prepared beside the training."""

        def endless() -> Iterator[Batch]:
            while True:
                yield self.batch(self.train, self.recipe.batch, random, self.recipe.mirror)

        return ahead(endless())

    def batch(self, built: list[Kept], scenes: int, random: np.random.Generator, mirror: float) -> Batch:
        """So many windows of at most so many people; who is not there is an empty slot."""
        config, most = self.config, max(self.recipe.people)
        shape = (scenes, config.history + config.horizon, most, len(self.mirror))
        positions, observed = np.zeros((*shape, 3), np.float32), np.zeros(shape, bool)
        for row in range(scenes):
            whole, mask, _ = draw(built, config.history, shape[1], self.mirror, mirror, random)
            chosen = random.permutation(whole.shape[1])[:most]
            if self.recipe.yaw:
                whole = turned(whole, random.uniform(0, 2 * np.pi))
            positions[row, :, : len(chosen)] = whole[:, chosen]
            observed[row, :, : len(chosen)] = mask[:, chosen, None]
        return Batch(positions, observed, positions[:, : config.history])


def empty(rooms: list[Kept]) -> list[Kept]:
    """The rooms without their furniture, which would be mirrored for nobody."""
    return [(positions, present, ()) for positions, present, _ in rooms]
