"""The trained baselines of cmu-goals: small, each in minutes on one core, all from the same windows by the same loop.

Every model sees people from where they stand: around the hip of the last frame of history, the right along +x. What
follows after the characteristic pose is not asked: a future ends there.
"""

from __future__ import annotations

import copy
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import torch
from torch import Tensor

from motioncast.benchmarks.goals.questions import Questions
from motioncast.core.skeletons import H36M17
from motioncast.core.voxels import across, turned_back
from motioncast.datasets.cmu_goals import HISTORY, GoalSample
from motioncast.formats.files import atomic_write
from motioncast.metrics.goals import mpjpe_of_best
from motioncast.models import build
from motioncast.training.weights import load_weights

HORIZON = 100
"""Frames of a future; a history that is farther from the pose is not learned from."""

MIRROR = 0.5
"""Share of windows that are mirrored."""

BATCH, LEARNING_RATE, CHECK_EVERY = 32, 1e-3, 100

BASELINES: dict[str, tuple[str, dict[str, Any], int]] = {
    "deterministic head": ("goal_head", {}, 600),
    "LTD": ("goal_trajectory", {"system": "ltd"}, 1000),
    "HRI": ("goal_trajectory", {"system": "hisrep"}, 800),
    "DLow": ("dlow", {}, 600),
}
"""Name -> model file, sizes and steps; DLow's autoencoder and its maps take as many each."""


@dataclass(frozen=True, slots=True, eq=False)
class Windows:
    """Histories and what followed, as torch has them.

    Attributes:
        history: ``(B, 10, J, 3)`` metres.
        future: ``(B, 100, J, 3)``; after the pose it stands still.
        seen: Up to and with the pose, ``(B, 100)`` bool.
        step: The frame of the pose, ``(B,)`` from 0.
    """

    history: Tensor
    future: Tensor
    seen: Tensor
    step: Tensor

    @property
    def parts(self) -> tuple[Tensor, Tensor, Tensor, Tensor]:
        """The arguments of a model's loss."""
        return self.history, self.future, self.seen, self.step


def draw(samples: list[GoalSample], count: int, random: np.random.Generator) -> Windows:
    """Windows of samples, all alike in chance, each from anywhere on its way within reach of the pose."""
    mirror = list(H36M17.mirror())
    pieces, steps = [], []
    for _ in range(count):
        sample = samples[random.integers(len(samples))]
        whole = np.concatenate([sample.history, sample.target[None]])
        start = int(random.integers(max(0, len(whole) - HISTORY - HORIZON), len(sample.history) - HISTORY + 1))
        piece = whole[start : start + HISTORY + HORIZON]
        steps.append(len(piece) - HISTORY - 1)
        piece = np.concatenate([piece, np.repeat(piece[-1:], HISTORY + HORIZON - len(piece), 0)])
        last = piece[HISTORY - 1]
        piece = turned_back(piece - last[0], across(last, H36M17))
        if random.random() < MIRROR:
            piece = piece[:, mirror] * np.array([-1, 1, 1])
        pieces.append(piece)
    motion, step = torch.from_numpy(np.stack(pieces).astype(np.float32)), torch.tensor(steps)
    return Windows(motion[:, :HISTORY], motion[:, HISTORY:], torch.arange(HORIZON) <= step[:, None], step)


def fit(
    model: Any, samples: list[GoalSample], validation: Questions, steps: int, seed: int = 0,
    say: Callable[[str], None] = print,
) -> Any:  # fmt: skip
    """A model trained on samples; its weights are those of the lowest error of the best goal on validation."""
    random = np.random.default_rng(seed)
    optimiser = torch.optim.AdamW([p for p in model.parameters() if p.requires_grad], LEARNING_RATE, weight_decay=1e-3)
    schedule = torch.optim.lr_scheduler.CosineAnnealingLR(optimiser, steps)
    best, kept = np.inf, model
    for number in range(1, steps + 1):
        loss = model.train().loss(*draw(samples, BATCH, random).parts)
        optimiser.zero_grad()
        loss.backward()
        torch.nn.utils.clip_grad_norm_(model.parameters(), 1.0)
        optimiser.step()
        schedule.step()
        if number % CHECK_EVERY == 0 or number == steps:
            error = best_error(model, validation)
            say(f"step {number}, loss {loss.item():.4f}, validation {error:.4f} m")
            if error < best:
                best, kept = error, copy.deepcopy(model)
    return kept.eval()


def best_error(model: Any, asked: Questions) -> float:
    """Mean error of the goal that is nearest to the truth, metres."""
    poses, truth = answer(model, asked), np.repeat(asked.targets, asked.histories.shape[1], 0)
    return float(mpjpe_of_best(poses.reshape(-1, *poses.shape[2:]), truth).mean())


@torch.no_grad()
def answer(model: Any, asked: Questions, told: bool = False) -> np.ndarray:
    """A model's answers in the world, ``(samples, starts, goals, joints, 3)`` metres around the hip.

    Args:
        model: A trained baseline.
        asked: The questions.
        told: Whether the model is told the frame of the pose instead of asking its head.
    """
    own = torch.from_numpy(asked.own.reshape(-1, *asked.own.shape[2:]).astype(np.float32))
    ahead = torch.from_numpy(asked.ahead.reshape(-1) - 1)
    model = model.eval()
    parts = [
        model.goals_at(history, step) if told else model.goals(history)
        for history, step in zip(own.split(256), ahead.split(256), strict=True)
    ]
    poses = torch.cat(parts).numpy().astype(np.float64)
    poses -= poses[..., :1, :]  # a network's hip is only nearly in the middle
    return asked.to_world(poses.reshape(*asked.histories.shape[:2], *poses.shape[1:]))


def baseline(
    name: str, samples: list[GoalSample], validation: Questions, folder: Path, seed: int = 0,
    say: Callable[[str], None] = print,
) -> Any:  # fmt: skip
    """A baseline from the folder, or trained and kept there.

    Args:
        name: One of ``BASELINES``.
        samples: Of the training takes.
        validation: Questions of the validation takes, which choose the weights.
        folder: Where weights are kept.
        seed: Of weights and windows.
        say: Receives a line of progress now and then.
    """
    file, sizes, steps = BASELINES[name]
    torch.manual_seed(seed)
    model = build(file, sizes)
    path = folder / f"{name.replace(' ', '-').lower()}.seed{seed}.pt"
    if path.is_file():
        return load_weights(model, path)
    model = fit(model, samples, validation, steps, seed, say)
    if hasattr(model, "learn_sampling"):
        model.learn_sampling()
        model = fit(model, samples, validation, steps, seed, say)
    with atomic_write(path) as temporary:
        torch.save(model.state_dict(), temporary)
    return model
