"""From a run to the files that ship: the graph, and the card with its error radii."""

from __future__ import annotations

import json
from pathlib import Path

from motioncast.core.card import ModelCard
from motioncast.models import build
from motioncast.training.export import export, load_weights
from motioncast.training.recipe import Recipe

DATA = (
    "CMU motion capture (mocap.cs.cmu.edu, created with funding from NSF EIA-0196217): the training takes of "
    "datasets/cmu.py; one couple, single people composed into scenes of up to three"
)
LICENCE = "Apache-2.0; trained on CMU's data, which is free for research and products but not to be resold"


def ship(run: Path, folder: Path | None = None) -> ModelCard:
    """Write the graph and the card of a run's best weights.

    Args:
        run: Folder of the run.
        folder: Where the files go. Default: the run's folder.
    """
    recipe = Recipe(**json.loads((run / "recipe.json").read_text(encoding="utf-8")))
    model = build(recipe.model, recipe.sizes)
    load_weights(model, run / "best.pt")
    config = model.config
    lines = (run / "metrics.jsonl").read_text(encoding="utf-8").splitlines()
    best = min(map(json.loads, lines), key=lambda entry: entry["score"])
    card = ModelCard(
        name=recipe.name,
        system="SoMoFormer",
        task="forecast",
        skeleton=config.skeleton,
        history=config.history,
        horizon=config.horizon,
        fps=config.fps,
        data=DATA,
        licence=LICENCE,
        figures={
            "validation_ratio_to_zero_velocity": {name: round(value, 4) for name, value in best["validation"].items()},
            "chosen_at_step": best["step"],
        },
        recipe=recipe.name,
        **recipe.card,
    )
    return export(model, card, folder or run)
