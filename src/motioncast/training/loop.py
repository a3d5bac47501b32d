"""One training loop for all models.

One process here; several processes and nodes by the same command under Fabric's launcher. bf16 where the
hardware multiplies it fast (GPUs, CPUs with AVX-512 BF16: 1.5 times as fast here), else float32. A run that was
killed goes on where its last checkpoint was written.
"""

from __future__ import annotations

import copy
import json
import math
import time
from collections.abc import Callable
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any, Literal

import numpy as np
import torch
from lightning_fabric import Fabric
from torch import Tensor, nn

from motioncast.errors import InputError
from motioncast.models import build
from motioncast.training.actions_task import ActionsTask, CmuActionsTask
from motioncast.training.goals_task import GoalsTask
from motioncast.training.recipe import Recipe, read_run
from motioncast.training.room_windows_task import RoomWindowsTask
from motioncast.training.rooms_task import RoomsTask
from motioncast.training.weights import load_weights
from motioncast.training.windows_task import WindowsTask

TASKS = {
    "windows": WindowsTask, "rooms": RoomsTask, "room-windows": RoomWindowsTask,
    "goals": GoalsTask, "goal-offsets": GoalsTask, "actions": ActionsTask, "cmu-actions": CmuActionsTask,
}  # fmt: skip
"""What a recipe's ``task`` names."""


def train(recipe: Recipe, data: Path, out: Path, say: Callable[[str], None] = print) -> Path:
    """Train a model and keep the best running mean of its weights.

    Writes ``recipe.json``, ``metrics.jsonl``, ``last.pt`` (to go on from) and ``best.pt`` (weights as float16)
    into ``out``.

    Args:
        recipe: What to train.
        data: Folder with CMU's takes (``datasets.cmu``).
        out: Folder of the run; if it holds a checkpoint of the same recipe, training goes on.
        say: Receives a line of progress now and then.

    Returns:
        Path of ``best.pt``.
    """
    out.mkdir(parents=True, exist_ok=True)
    fabric = Fabric(accelerator="auto", devices="auto" if torch.cuda.is_available() else 1, precision=_precision())
    fabric.launch()
    fabric.seed_everything(recipe.seed + fabric.global_rank, verbose=False)
    raw = build(recipe.model, recipe.sizes)
    task = TASKS[recipe.task](recipe, raw, data)
    if isinstance(task, WindowsTask) and hasattr(raw, "fit"):
        return _solve(recipe, raw, task, out, say)
    if recipe.start:
        load_weights(raw, Path(recipe.start)).train()
    optimiser = torch.optim.AdamW(raw.parameters(), recipe.learning_rate, weight_decay=recipe.weight_decay)
    mean = copy.deepcopy(raw).requires_grad_(False).eval()
    start, best, spent = 0, math.inf, 0.0
    last = out / "last.pt"
    if last.exists():
        _same_recipe(recipe, out)
        state = torch.load(last, map_location="cpu", weights_only=True)
        raw.load_state_dict(state["model"])
        mean.load_state_dict(state["mean"])
        optimiser.load_state_dict(state["optimiser"])
        start, best, spent = state["step"], state["best"], state["spent_s"]
        say(f"{recipe.name}: going on from step {start}")
    (out / "recipe.json").write_text(json.dumps(asdict(recipe), indent=1), encoding="utf-8")
    model, optimiser = fabric.setup(raw, optimiser)
    model.mark_forward_method("loss")  # some tasks call it instead, and want precision and several processes too
    mean = fabric.to_device(mean)
    batches = task.batches(np.random.default_rng([recipe.seed, start, fabric.global_rank]))
    began, losses = time.perf_counter(), []

    def place(array: np.ndarray) -> Tensor:
        return fabric.to_device(torch.from_numpy(array))

    for step in range(start + 1, recipe.steps + 1):
        batch = next(batches)
        for group in optimiser.param_groups:
            group["lr"] = recipe.learning_rate * pace(step, recipe)
        loss = task.loss(model, batch, place)
        fabric.backward(loss)
        fabric.clip_gradients(model, optimiser, max_norm=1.0)
        optimiser.step()
        optimiser.zero_grad()
        follow(mean, raw, min(recipe.average, step / (step + 10)))
        losses.append(loss.item())
        if step % recipe.validate_every == 0 or step == recipe.steps:
            scores = task.scores(mean)
            score = float(np.mean(list(scores.values())))
            total = spent + time.perf_counter() - began
            loss_now = float(np.mean(losses))
            entry = {
                "step": step, "loss": loss_now, "validation": scores, "score": score, "seconds": total,
                "device": _device(fabric),
            }  # fmt: skip
            losses = []
            if fabric.is_global_zero:
                with (out / "metrics.jsonl").open("a", encoding="utf-8") as log:
                    log.write(json.dumps(entry) + "\n")
                if score < best or recipe.folds:  # what a fold left out must not choose
                    best = score
                    _save({name: value.half() for name, value in mean.state_dict().items()}, out / "best.pt")
                _save(
                    {
                        "model": raw.state_dict(), "mean": mean.state_dict(), "optimiser": optimiser.state_dict(),
                        "step": step, "best": best, "spent_s": total,
                    },
                    last,
                )  # fmt: skip
            say(f"{recipe.name} {json.dumps(entry)}")
    return out / "best.pt"


def _solve(recipe: Recipe, model: Any, task: WindowsTask, out: Path, say: Callable[[str], None]) -> Path:
    """Fit a model that has a closed solution to as many scenes as a recipe has steps and scenes a step."""
    began, config, random = time.perf_counter(), model.config, np.random.default_rng(recipe.seed)
    people = max(recipe.people)
    scenes = [task.sampler.scene(people, random)[0] for _ in range(recipe.steps * recipe.batch)]
    positions = torch.from_numpy(np.stack(scenes).astype(np.float32))
    model.fit(positions[:, : config.history], positions[:, config.history :])
    scores = task.scores(model)
    entry = {
        "step": recipe.steps, "validation": scores, "score": float(np.mean(list(scores.values()))),
        "seconds": time.perf_counter() - began, "device": f"{torch.get_num_threads()} CPU threads",
    }  # fmt: skip
    (out / "recipe.json").write_text(json.dumps(asdict(recipe), indent=1), encoding="utf-8")
    (out / "metrics.jsonl").write_text(json.dumps(entry) + "\n", encoding="utf-8")
    _save({name: value.half() for name, value in model.state_dict().items()}, out / "best.pt")
    say(f"{recipe.name} {json.dumps(entry)}")
    return out / "best.pt"


def _same_recipe(recipe: Recipe, out: Path) -> None:
    """A run goes on with the recipe that it began with; only its length may change."""
    began = read_run(out)
    if replace(began, steps=recipe.steps) != recipe:
        raise InputError(f"{out} was begun with another recipe; give another folder, or the recipe in its recipe.json")


def _device(fabric: Fabric) -> str:
    """The hardware of a run, in words."""
    return torch.cuda.get_device_name() if fabric.device.type == "cuda" else f"{torch.get_num_threads()} CPU threads"


def _precision() -> Literal["bf16-mixed", "32-true"]:
    fast = torch.cuda.is_available() or torch.cpu._is_avx512_bf16_supported()
    return "bf16-mixed" if fast else "32-true"


def _save(state: dict, path: Path) -> None:
    temporary = path.with_suffix(".part")
    torch.save(state, temporary)
    temporary.replace(path)


def pace(step: int, recipe: Recipe) -> float:
    """Share of the highest learning rate at a step: a linear rise, then a cosine down to a hundredth."""
    if step < recipe.warmup:
        return step / recipe.warmup
    progress = (step - recipe.warmup) / max(1, recipe.steps - recipe.warmup)
    return 0.01 + 0.99 * 0.5 * (1 + math.cos(math.pi * progress))


@torch.no_grad()
def follow(mean: nn.Module, model: nn.Module, decay: float) -> None:
    """Move the running mean of the weights towards the model's; statistics of batches are running means already."""
    for average, value in zip(mean.parameters(), model.parameters(), strict=True):
        average.lerp_(value, 1 - decay)
    for average, value in zip(mean.buffers(), model.buffers(), strict=True):
        average.copy_(value)
