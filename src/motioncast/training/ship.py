"""From a run to the files that ship: the graph, and the card with its error radii."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from motioncast.benchmarks import open_cmu
from motioncast.benchmarks.calibration import errors_by_take, radii
from motioncast.benchmarks.protocol import Protocol
from motioncast.core.card import ModelCard
from motioncast.core.forecaster import Forecaster
from motioncast.datasets.windows import cut
from motioncast.inference.registry import load
from motioncast.models import build
from motioncast.training.export import export
from motioncast.training.export_diffusion import export_diffusion
from motioncast.training.export_goals import export_goals
from motioncast.training.recipe import read_run
from motioncast.training.record import best_look, cost, figures
from motioncast.training.ship_actions import ship_actions
from motioncast.training.weights import load_weights

DATA = (
    "CMU motion capture (mocap.cs.cmu.edu, created with funding from NSF EIA-0196217): the training takes of "
    "datasets/cmu.py; one couple, single people composed into scenes of up to three"
)
ROOMS = (
    "rooms composed from CMU motion capture (mocap.cs.cmu.edu, created with funding from NSF EIA-0196217) by "
    "datasets/rooms, split as there: real takes stitched together, furniture inferred from what people do, and decoys"
)
GOALS = (
    "characteristic poses found in CMU motion capture (mocap.cs.cmu.edu, created with funding from NSF EIA-0196217): "
    "the training takes of datasets/cmu_goals.py"
)
LICENCE = "Apache-2.0; trained on CMU's data, which is free for research and products but not to be resold"

SAMPLING = {"sampler": "dpm-solver++", "sampling_steps": 20}
"""How a diffusion is sampled where nobody asks otherwise."""

ROUGH_M = 0.02
"""How exactly goals hold their invariances: refinement goes another way where a question is rounded otherwise."""


def ship(run: Path, folder: Path | None = None, radius: Mapping[str, Any] | None = None) -> ModelCard:
    """Write the graph and the card of a run's best weights.

    Args:
        run: Folder of the run.
        folder: Where the files go. Default: the run's folder.
        radius: Error radii for the card (:func:`calibrated`).
    """
    recipe = read_run(run)
    if recipe.task in ("actions", "cmu-actions"):
        return ship_actions(run, recipe, folder or run)
    model = build(recipe.model, recipe.sizes)
    load_weights(model, run / "best.pt")
    config = model.config
    denoises, finds_goals = recipe.task == "rooms", recipe.task in ("goals", "goal-offsets")
    best = best_look(run)
    card = ModelCard(
        name=recipe.name,
        task="forecast",
        skeleton=config.skeleton,
        history=config.history,
        horizon=config.horizon,
        fps=config.fps,
        data=DATA if recipe.task == "windows" else GOALS if finds_goals else ROOMS,
        licence=LICENCE,
        figures=figures(best, "validation_loss" if denoises or finds_goals else "validation_ratio_to_zero_velocity"),
        radius=radius or {},
        recipe=recipe.name,
        training=cost(best, recipe),
        **{"system": recipe.model, **recipe.card},
    )
    if denoises:
        diffusion = {"steps": config.steps, "shift": config.shift, **SAMPLING}
        return export_diffusion(model, replace(card, stochastic=True, diffusion=diffusion), folder or run)
    if finds_goals:
        return export_goals(model, replace(card, task="goals", stochastic=True, tolerance_m=ROUGH_M), folder or run)
    return export(model, card, folder or run)


def calibrated(folds: Sequence[Path], data: Path, model: Forecaster | None = None) -> dict[str, Any]:
    """Error radii from runs that each left some takes out, or from the validation takes of a model.

    Args:
        folds: Folders of runs whose recipes name their fold.
        data: Folder with CMU's takes.
        model: Without folds: the model whose validation takes are used.
    """
    errors: list[np.ndarray] = []
    pairs = [(_fold_forecaster(run), read_run(run)) for run in folds] or [(model, None)]
    for forecaster, recipe in pairs:
        if forecaster is None:
            raise ValueError("radii need the runs of folds, or a model")
        card = forecaster.card
        if recipe is None:
            singles = open_cmu.single_scenes(data, "validation", card.fps, card.joints)
            couples = open_cmu.couple_scenes(data, "validation", card.fps, card.joints)
        else:
            singles, couples = (
                [scene for scene in scenes if open_cmu.fold_of(scene, recipe.folds) == recipe.fold]
                for scenes in open_cmu.all_but_test(data, card.fps, card.joints)
            )
        protocol = Protocol("radii", card.skeleton, card.fps, card.history, card.horizon, (), (), "mpjpe", "", 10)
        for scenes in (singles, couples):
            windows = cut(scenes, card.history, card.horizon, protocol.stride)
            errors += errors_by_take(forecaster, protocol, windows).values()
    method = f"cross-conformal over {len(folds)} folds of actors and takes" if folds else "conformal, validation takes"
    return {"levels": radii(errors), "n_takes": len(errors), "method": method}


def _fold_forecaster(run: Path) -> Forecaster:
    ship(run)
    return load(run / f"{read_run(run).name}.onnx")
