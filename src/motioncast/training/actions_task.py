"""Learning actions and poses from steps of videos: a generator, and the critic that it learns 3D from.

The loop holds one optimiser; the critic has its own here, and takes its turns before each step of the generator. When
a run goes on from a checkpoint, the critic's weights are there and its optimiser begins anew.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import torch
from torch import Tensor

from motioncast.datasets import cmu_actions, kitchen
from motioncast.datasets.action_windows import ActionWindows, cut_steps
from motioncast.metrics.actions import pixel_errors, top_k
from motioncast.models.futurehuman3d import Past
from motioncast.training.recipe import Recipe

CRITIC_STEPS, CRITIC_BATCH = 2, 128
"""Steps of the critic for one of the generator, and the most poses that it sees in one."""

BANK = 50_000
"""Real poses that the critic sees."""

VALIDATION_SEQUENCES = 60

OWN_SHARE = 0.3
"""Share of windows, at the end of training, whose past ends with the model's own answers."""


@dataclass(frozen=True, slots=True, eq=False)
class ActionBatch:
    """Windows of past steps and the one that came next.

    Attributes:
        past: What is known.
        noise: ``(B, P, Z)``.
        actions: ``(B, P)``.
        pixels: ``(B, P, 9, 2)``.
        seen: ``(B, P, 9)``.
        real: Poses of the bank, ``(CRITIC_STEPS, CRITIC_BATCH, 9, 3)`` metres.
    """

    past: Past
    noise: Tensor
    actions: Tensor
    pixels: Tensor
    seen: Tensor
    real: Tensor


class ActionsTask:
    """Windows of the kitchen grammar.

    Args:
        recipe: What is trained; ``scenes`` sequences are drawn, ``batch`` windows are seen a step.
        model: The model that learns.
        data: Not read: the grammar needs no data.
    """

    def __init__(self, recipe: Recipe, model: Any, data: Path) -> None:
        self.recipe, self.model, self.config, self.data = recipe, model, model.config, data
        self.train = self.windows("train", recipe.scenes)
        self.validation = self.windows("validation", VALIDATION_SEQUENCES)
        self.bank = self.real_poses()
        model.start_from(torch.from_numpy(self.bank.mean(0)))
        self.critic_optimiser = torch.optim.Adam(model.critic.parameters(), recipe.learning_rate, betas=(0.5, 0.9))
        self.drawn = 0

    def windows(self, split: str, count: int) -> ActionWindows:
        """The windows of a split."""
        history, steps = self.config.history, self.config.steps
        if self.recipe.moments == "uncoupled":
            return cut_steps(kitchen.uncoupled(split, count, history, steps), history, steps)
        found = kitchen.sequences(split, count, people=self.config.people, moments=self.recipe.moments)
        return cut_steps(found, history, steps)

    def real_poses(self) -> np.ndarray:
        """What the critic holds for real, ``(n, 9, 3)`` metres along a camera's axes, the neck at 0."""
        return kitchen.bank(BANK, self.recipe.seed)

    def batches(self, random: np.random.Generator) -> Iterator[ActionBatch]:
        """Batches without end."""
        while True:
            yield self.batch(random)

    def batch(self, random: np.random.Generator) -> ActionBatch:
        """Windows drawn at random; the past of some ends with what the model answered in place of the truth."""
        config, count = self.config, self.recipe.batch
        rows = random.integers(len(self.train), size=count)
        past = Past(*map(torch.from_numpy, self.train.past(config.history, rows)))
        past = past._replace(seen=past.seen & torch.from_numpy(random.random(past.seen.shape) >= self.recipe.drop))
        target = np.full(count, config.history)
        self.drawn += 1
        own = np.flatnonzero(random.random(count) < OWN_SHARE * min(1, self.drawn / self.recipe.steps))
        if len(own) and config.steps > 1:
            ahead = int(random.integers(1, config.steps))
            target[own] += ahead
            past = overwritten(past, own, self.rolled(Past(*(part[own] for part in past)), ahead))
        return ActionBatch(
            past=past,
            noise=torch.from_numpy(random.standard_normal((count, config.people, config.noise), np.float32)),
            actions=torch.from_numpy(self.train.actions[rows, target]),
            pixels=torch.from_numpy(self.train.pixels[rows, target]),
            seen=torch.from_numpy(self.train.seen[rows, target]),
            real=torch.from_numpy(self.bank[random.integers(len(self.bank), size=(CRITIC_STEPS, CRITIC_BATCH))]),
        )

    @torch.no_grad()
    def rolled(self, past: Past, steps: int) -> Past:
        """The past after so many answers of the model."""
        for _ in range(steps):
            past = self.model.append(past, self.model(past, self.model.silence(past)))
        return past

    def loss(self, model: Any, batch: ActionBatch, place: Callable[[np.ndarray], Tensor]) -> Tensor:
        """The generator's loss of a batch, after the critic has learnt to see through what the generator makes."""
        if self.config.critic_weight:
            self.teach_critic(batch)
        self.model.critic.requires_grad_(False)  # the generator must not teach the critic
        return model.loss(batch.past, batch.noise, batch.actions, batch.pixels, batch.seen)

    def teach_critic(self, batch: ActionBatch) -> None:
        """The critic's steps."""
        critic = self.model.critic.requires_grad_(True)
        with torch.no_grad():
            made = self.model.made(batch.past, batch.noise, batch.pixels, batch.seen)
        for real in batch.real:
            some = torch.randint(len(made), (len(real),))
            critic.loss(real, made[some]).backward()
            self.critic_optimiser.step()
            self.critic_optimiser.zero_grad(set_to_none=True)

    @torch.no_grad()
    def scores(self, model: Any) -> dict[str, float]:
        """Of the validation windows, rolled out: share of wrong actions, error in the image over standing still."""
        history, steps = self.config.history, self.config.steps
        past = Past(*map(torch.from_numpy, self.validation.past(history)))
        held = past.pixels[:, -1].numpy()
        wrong, off, still = [], [], []
        for ahead in range(history, history + steps):
            step = model(past, model.silence(past))
            past = model.append(past, step)
            wrong.append(~top_k(step.logits.numpy(), self.validation.actions[:, ahead]))
            truth, seen = self.validation.pixels[:, ahead], self.validation.seen[:, ahead]
            off.append(pixel_errors(step.pixels.numpy(), truth, seen))
            still.append(pixel_errors(held, truth, seen))
        found = {}
        if self.config.action_weight:
            found["wrong"] = float(np.mean(wrong))
        if self.config.pose_weight:
            found["pixels"] = float(np.nanmean(off) / np.nanmean(still))
        return found


class CmuActionsTask(ActionsTask):
    """Sessions strung from CMU's labelled runs; the critic's poses are of other people.

    Args:
        recipe: What is trained; ``scenes`` sessions are drawn.
        model: The model that learns.
        data: Folder with CMU's takes (``datasets.cmu``).
    """

    def windows(self, split: str, count: int) -> ActionWindows:
        """The windows of a split."""
        found = cmu_actions.sessions(self.data, split, count, self.recipe.seed)
        return cut_steps(found, self.config.history, self.config.steps)

    def real_poses(self) -> np.ndarray:
        """Poses of the training takes of subjects who have no labelled take."""
        return cmu_actions.bank(self.data, self.recipe.seed)


def overwritten(past: Past, rows: np.ndarray, part: Past) -> Past:
    """A past in which some rows are others."""
    found = []
    for whole, new in zip(past, part, strict=True):
        whole = whole.clone()
        whole[rows] = new
        found.append(whole)
    return Past(*found)
