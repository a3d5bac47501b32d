"""Learning characteristic poses in two phases: heatmaps (``goals``), then offsets, all else frozen (``goal-offsets``).

A batch learns one stage: the right hand, the left hand or some of the other joints.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import torch
from torch import Tensor

from motioncast.core.skeletons import SKELETONS
from motioncast.core.voxels import across, hip_centred, turned_back
from motioncast.datasets.cmu_goals import GoalSample, goal_samples, windows_of
from motioncast.training.recipe import Recipe

STAGES = ("right hand", "left hand", "rest")

REST_JOINTS = 5
"""Of the other joints so many, drawn anew, are learnt in a batch: more batches for the same time."""

AT_LAST = 0.15
"""Share of histories that end just before the pose; by chance alone hardly any would."""

CHECKED_STARTS = (0.0, 0.5, 1.0)
"""Histories of the validation takes, as shares of the way from the first possible one to the last."""


@dataclass(frozen=True, slots=True, eq=False)
class GoalBatch:
    """Histories and the poses that they led to.

    Attributes:
        history: ``(windows, T, joints, 3)`` float32, metres, hip-centred.
        target: ``(windows, joints, 3)``.
        partner: The partner's last pose around the same hip, ``(windows, joints, 3)``, NaN of who is alone.
        stage: 0, 1 or 2.
        asked: The joints that are learnt, ``(asked,)``.
    """

    history: np.ndarray
    target: np.ndarray
    partner: np.ndarray
    stage: int
    asked: np.ndarray


class GoalsTask:
    """Windows on the way to the characteristic poses of the training takes.

    Args:
        recipe: What is trained.
        model: The model that learns.
        data: Folder with CMU's takes (``datasets.cmu``).
    """

    def __init__(self, recipe: Recipe, model: Any, data: Path) -> None:
        self.recipe, self.config = recipe, model.config
        self.stages = model.stages
        self.skeleton = SKELETONS[self.config.skeleton]
        self.mirror = list(self.skeleton.mirror())
        self.train = list(goal_samples(data, "train"))
        self.checks = list(self.checked(list(goal_samples(data, "validation"))))
        if recipe.task == "goal-offsets":
            model.learn_offsets()

    def batches(self, random: np.random.Generator) -> Iterator[GoalBatch]:
        """Batches without end."""
        while True:
            stage = int(random.integers(len(STAGES)))
            asked = np.array(self.stages[stage])
            if self.config.preset == "light":
                asked = random.permutation(asked)[:REST_JOINTS]
            windows = [self.window(random) for _ in range(self.recipe.batch)]
            history, target, partner = (np.stack(parts) for parts in zip(*windows, strict=True))
            yield GoalBatch(history, target, partner, stage, asked)

    def window(self, random: np.random.Generator) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """A history, its target and its partner, mirrored and enlarged by chance."""
        sample = self.train[random.integers(len(self.train))]
        share = 1.0 if random.random() < AT_LAST else random.random()
        parts = self.seen(sample, share)
        if random.random() < self.recipe.mirror:
            parts = tuple(part[..., self.mirror, :] * np.array([-1, 1, 1], np.float32) for part in parts)
        size = np.float32(random.uniform(*self.recipe.scale))
        history, target, partner = (part * size for part in parts)
        noise = random.normal(0, self.recipe.noise_m, history.shape)
        return (history + noise).astype(np.float32), target, partner

    def seen(self, sample: GoalSample, share: float) -> tuple[np.ndarray, ...]:
        """History, target and partner of a sample, hip-centred; ``share`` says where the history begins."""
        (history,) = windows_of(sample.history, (share,))
        axis = across(history[-1], self.skeleton)
        target = turned_back(sample.target - sample.target[0], axis)
        partner = np.full_like(target, np.nan)
        if sample.partner is not None:
            (others,) = windows_of(sample.partner, (share,))
            partner = turned_back(others[-1] - history[-1, 0], axis)
        return tuple(part.astype(np.float32) for part in (hip_centred(history, axis), target, partner))

    def checked(self, samples: list[GoalSample]) -> Iterator[tuple[np.ndarray, ...]]:
        """The validation histories, targets and partners, a batch at a time."""
        windows = [self.seen(sample, share) for sample in samples for share in CHECKED_STARTS]
        for first in range(0, len(windows), self.recipe.batch):
            yield tuple(np.stack(parts) for parts in zip(*windows[first : first + self.recipe.batch], strict=True))

    def loss(self, model: Any, batch: GoalBatch, place: Callable[[np.ndarray], Tensor]) -> Tensor:
        """The model's own loss of a batch, whose arrays ``place`` brings to the model's device."""
        return model.loss(
            place(batch.history), place(batch.target), batch.stage, place(batch.asked), place(batch.partner)
        )

    @torch.no_grad()
    def scores(self, model: Any) -> dict[str, float]:
        """On the validation takes: each stage's cross entropy at the full number of voxels; in phase two of offsets."""
        device = next(model.parameters()).device
        hands = list(self.config.hands)
        found: dict[str, list[float]] = {name: [] for name in STAGES}
        for arrays in self.checks:
            history, target, partner = (torch.from_numpy(array).to(device) for array in arrays)
            for stage, name in enumerate(STAGES):
                with torch.autocast(device.type, torch.bfloat16):
                    said = model(
                        history, target[:, None, hands], stage, partner=partner, heat_only=not model.only_offsets
                    )
                truth = target[:, self.stages[stage]]
                loss = model.offset_loss(said, truth) if model.only_offsets else model.heat_loss(said, truth)
                found[name].append(float(loss))
        return {name: float(np.mean(values)) for name, values in found.items()}
