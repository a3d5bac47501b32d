"""From a run that learnt steps to the files that ship."""

from __future__ import annotations

from pathlib import Path

from motioncast.core.card import ModelCard
from motioncast.datasets import cmu_actions, kitchen
from motioncast.models import build
from motioncast.training.export_actions import export_actions
from motioncast.training.recipe import Recipe
from motioncast.training.record import best_look, cost, figures
from motioncast.training.weights import load_weights

KITCHEN = (
    "the kitchen grammar of datasets/kitchen, training seeds: synthetic cooks seen as 2D by virtual cameras; 3D poses "
    "of other synthetic cooks for the critic"
)
CMU = (
    "CMU motion capture (mocap.cs.cmu.edu, created with funding from NSF EIA-0196217): labelled takes of subjects 2, "
    "13 and 14, seen as 2D only by virtual cameras, by the split of datasets/cmu_actions.py; 3D poses of other "
    "subjects for the critic. Takes of 13 and 14 are test takes of the other benchmarks: this model is not to be "
    "evaluated on, or carried into, any of them"
)
LICENCES = {
    "actions": "Apache-2.0; trained on synthetic data of this package",
    "cmu-actions": "Apache-2.0; trained on CMU's data, which is free for research and products but not to be resold",
}


def ship_actions(run: Path, recipe: Recipe, folder: Path) -> ModelCard:
    """Write the graph and the card of a run's best weights.

    Args:
        run: Folder of the run.
        recipe: Its recipe.
        folder: Where the two files go.
    """
    model = build(recipe.model, recipe.sizes)
    load_weights(model, run / "best.pt")
    config = model.config
    best = best_look(run)
    of_kitchen = recipe.task == "actions"
    labels, objects = (kitchen.LABELS, kitchen.OBJECTS) if of_kitchen else (cmu_actions.LABELS, ())
    card = ModelCard(
        name=recipe.name,
        task="actions",
        skeleton="upper9",
        history=config.history,
        horizon=config.steps,
        fps=1.0,
        people=config.people,
        stochastic=True,
        needs={"labels": list(labels), "objects": list(objects), "noise": config.noise},
        data=KITCHEN if of_kitchen else CMU,
        licence=LICENCES[recipe.task],
        figures=figures(best, "validation"),
        recipe=recipe.name,
        training=cost(best, recipe),
        **{"system": recipe.model, **recipe.card},
    )
    return export_actions(model, card, folder)
