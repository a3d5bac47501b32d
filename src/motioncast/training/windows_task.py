"""Learning from windows of takes: history in, future out, chosen on the validation takes."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import torch
from torch import Tensor, nn

from motioncast.benchmarks import open_cmu
from motioncast.core.scene import Scene
from motioncast.core.skeleton import Skeleton
from motioncast.core.skeletons import SKELETONS
from motioncast.datasets.windows import Windows, cut
from motioncast.metrics.position import mpjpe_at
from motioncast.training.batches import STORED_FPS, Batch, Sampler
from motioncast.training.recipe import Recipe


class WindowsTask:
    """Scenes composed of windows of the training takes.

    Args:
        recipe: What is trained.
        model: The model that learns; its configuration says what a window is.
        data: Folder with CMU's takes (``datasets.cmu``).
    """

    def __init__(self, recipe: Recipe, model: Any, data: Path) -> None:
        self.own_loss = model.loss
        self.config = config = model.config
        skeleton = SKELETONS[config.skeleton]
        takes = training_takes(recipe, data, skeleton)
        self.sampler = Sampler(*takes, recipe, config.history, config.horizon, config.fps)
        self.checks = validation(data, skeleton, config.history, config.horizon, config.fps, recipe.people)
        if hasattr(model, "fit_statistics"):
            model.fit_statistics(torch.from_numpy(_whole_windows(self.sampler, recipe, config.history)))

    def batches(self, random: np.random.Generator) -> Iterator[Batch]:
        """Batches without end."""
        return self.sampler.batches(random)

    def loss(self, model: Any, batch: Batch, place: Callable[[np.ndarray], Tensor]) -> Tensor:
        """The model's own loss of a batch, whose arrays ``place`` brings to the model's device."""
        seen, observed, truth = map(place, (batch.seen, batch.observed, batch.positions))
        h = self.config.history
        return self.own_loss(model(seen, observed[:, :h]), truth[:, h:], observed[:, h:])

    def scores(self, model: nn.Module) -> dict[str, float]:
        """The ratio to standing still on each kind of validation scenes."""
        return {name: ratio(model, windows, self.config.fps) for name, windows in self.checks.items()}


def _whole_windows(sampler: Sampler, recipe: Recipe, history: int) -> np.ndarray:
    """Histories of some training batches in which everything was seen, one person each."""
    random = np.random.default_rng(recipe.seed)
    windows = [window[:history] for window, mask in (sampler.window(1, random) for _ in range(1000)) if mask.all()]
    return np.stack(windows).astype(np.float32)


def training_takes(recipe: Recipe, data: Path, skeleton: Skeleton) -> tuple[list[Scene], list[Scene]]:
    """Takes of single people and of the couple that a recipe trains on."""
    if not recipe.folds:
        return (
            open_cmu.single_scenes(data, "train", STORED_FPS, skeleton),
            open_cmu.couple_scenes(data, "train", STORED_FPS, skeleton),
        )
    singles, couples = open_cmu.all_but_test(data, STORED_FPS, skeleton)
    kept = [open_cmu.fold_of(scene, recipe.folds) != recipe.fold for scene in (*singles, *couples)]
    return (
        [scene for scene, keep in zip(singles, kept, strict=False) if keep],
        [scene for scene, keep in zip(couples, kept[len(singles) :], strict=True) if keep],
    )


def validation(
    data: Path, skeleton: Skeleton, history: int, horizon: int, fps: float, people: Sequence[int] = (2, 3)
) -> dict[str, Windows]:
    """The windows on which a model is chosen: the couple and composed scenes of three, or single people.

    A model of single people is chosen on single people; its takes start so that "now" is a captured frame.
    """
    singles = open_cmu.single_scenes(data, "validation", fps, skeleton)
    if max(people) == 1:
        return {"single": cut(singles, history, horizon, first=(1 - history) % 5)}
    couples = open_cmu.couple_scenes(data, "validation", fps, skeleton)
    return {
        "couple": cut(couples, history, horizon),
        "crowd": open_cmu.crowd(singles, couples, history, horizon),
    }


@torch.no_grad()
def ratio(model: nn.Module, windows: Windows, fps: float) -> float:
    """Mean error at three moments (1, 2, 3 s, or the thirds of a shorter horizon) over that of standing still."""
    device = next(model.parameters()).device
    answers = []
    for start in range(0, len(windows), 100):
        positions, observed = (torch.from_numpy(array[start : start + 100]).to(device) for array in windows.past)
        answers.append(final(model(positions, observed)).float().cpu().numpy())
    truth, mask = windows.future
    horizon = truth.shape[1]
    moments = [round(horizon * third / 3) - 1 for third in (1, 2, 3)]
    still = np.broadcast_to(windows.past[0][:, -1:], truth.shape)
    errors = [mpjpe_at(forecast, truth, mask)[moments].mean() for forecast in (np.concatenate(answers), still)]
    return float(errors[0] / errors[1])


def final(answer: Tensor | list[Tensor]) -> Tensor:
    """The forecast of the last layer, where a model answers after every layer."""
    return answer[-1] if isinstance(answer, list) else answer
