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
from collections.abc import Callable, Sequence
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any, Literal

import numpy as np
import torch
from lightning_fabric import Fabric
from torch import Tensor, nn

from motioncast.benchmarks import open_cmu
from motioncast.core.scene import Scene
from motioncast.core.skeleton import Skeleton
from motioncast.core.skeletons import SKELETONS
from motioncast.datasets.windows import Windows, cut
from motioncast.errors import InputError
from motioncast.metrics.position import mpjpe_at
from motioncast.models import build
from motioncast.training.batches import STORED_FPS, Sampler
from motioncast.training.recipe import Recipe, read_run
from motioncast.training.weights import load_weights


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
    config = raw.config
    skeleton = SKELETONS[config.skeleton]

    sampler = Sampler(*training_takes(recipe, data, skeleton), recipe, config.history, config.horizon, config.fps)
    checks = validation(data, skeleton, config.history, config.horizon, config.fps, recipe.people)
    if hasattr(raw, "fit_statistics"):
        raw.fit_statistics(torch.from_numpy(_whole_windows(sampler, recipe, config.history)))
    if hasattr(raw, "fit"):
        return _solve(recipe, raw, sampler, checks, out, say)
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
    mean = fabric.to_device(mean)
    batches = sampler.batches(np.random.default_rng([recipe.seed, start, fabric.global_rank]))
    began, losses = time.perf_counter(), []
    for step in range(start + 1, recipe.steps + 1):
        batch = next(batches)
        for group in optimiser.param_groups:
            group["lr"] = recipe.learning_rate * pace(step, recipe)
        seen, observed, truth = (
            fabric.to_device(torch.from_numpy(array)) for array in (batch.seen, batch.observed, batch.positions)
        )
        h = config.history
        loss = raw.loss(model(seen, observed[:, :h]), truth[:, h:], observed[:, h:])
        fabric.backward(loss)
        fabric.clip_gradients(model, optimiser, max_norm=1.0)
        optimiser.step()
        optimiser.zero_grad()
        follow(mean, raw, min(recipe.average, step / (step + 10)))
        losses.append(loss.item())
        if step % recipe.validate_every == 0 or step == recipe.steps:
            scores = {name: ratio(mean, windows, config.fps) for name, windows in checks.items()}
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


def _solve(
    recipe: Recipe,
    model: Any,
    sampler: Sampler,
    checks: dict[str, Windows],
    out: Path,
    say: Callable[[str], None],
) -> Path:
    """Fit a model that has a closed solution to as many scenes as a recipe has steps and scenes a step."""
    began, config, random = time.perf_counter(), model.config, np.random.default_rng(recipe.seed)
    people = max(recipe.people)
    scenes = [sampler.scene(people, random)[0] for _ in range(recipe.steps * recipe.batch)]
    positions = torch.from_numpy(np.stack(scenes).astype(np.float32))
    model.fit(positions[:, : config.history], positions[:, config.history :])
    scores = {name: ratio(model, windows, config.fps) for name, windows in checks.items()}
    entry = {
        "step": recipe.steps, "validation": scores, "score": float(np.mean(list(scores.values()))),
        "seconds": time.perf_counter() - began, "device": f"{torch.get_num_threads()} CPU threads",
    }  # fmt: skip
    (out / "recipe.json").write_text(json.dumps(asdict(recipe), indent=1), encoding="utf-8")
    (out / "metrics.jsonl").write_text(json.dumps(entry) + "\n", encoding="utf-8")
    _save({name: value.half() for name, value in model.state_dict().items()}, out / "best.pt")
    say(f"{recipe.name} {json.dumps(entry)}")
    return out / "best.pt"


def _whole_windows(sampler: Sampler, recipe: Recipe, history: int) -> np.ndarray:
    """Histories of some training batches in which everything was seen, one person each."""
    random = np.random.default_rng(recipe.seed)
    windows = [window[:history] for window, mask in (sampler.window(1, random) for _ in range(1000)) if mask.all()]
    return np.stack(windows).astype(np.float32)


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
