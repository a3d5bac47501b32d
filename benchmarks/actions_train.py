"""Train FutureHuman3D on the kitchen grammar, with what it is compared with: ablations and single tasks.

    python benchmarks/actions_train.py --runs FOLDER [--only NAME …] [--seeds 0 1 2] [--steps N]

Each variant is the recipe futurehuman3d with what ``VARIANTS`` changes. Runs that are there go on, or are left alone;
graphs and cards go into the folder, where ``actions_table.py`` finds them. Choices were made on validation sequences.
"""

from __future__ import annotations

import argparse
from dataclasses import replace
from pathlib import Path
from typing import Any

from motioncast.training.loop import train
from motioncast.training.recipe import Recipe, read_recipe
from motioncast.training.ship import ship

VARIANTS: dict[str, dict[str, Any]] = {
    "joint": {},
    "action only": {"reads_poses": False, "pose_weight": 0.0, "critic_weight": 0.0},
    "pose only": {"reads_actions": False, "action_weight": 0.0},
    "no critic": {"critic_weight": 0.0},
    "lift then predict": {"model": "lift_then_predict"},
    "no objects": {"objects": 0},
    "no noise": {"noise": 0},
    "middle poses": {"moments": "middle"},
    "random poses": {"moments": "random"},
    "uncoupled poses": {"moments": "uncoupled"},
    "pair": {"recipe": "futurehuman3d-pair"},
    "pair, no interaction": {"recipe": "futurehuman3d-pair", "pooled": False},
}
"""What differs from the joint model; a pose-only model is one without action loss, too."""


def recipe_of(variant: str, seed: int, steps: int | None) -> Recipe:
    """The recipe of a variant."""
    change = dict(VARIANTS[variant])
    recipe = read_recipe(change.pop("recipe", "futurehuman3d"))
    model, moments = change.pop("model", recipe.model), change.pop("moments", recipe.moments)
    name = f"{variant} seed{seed}" if seed else variant
    card = {"system": f"FutureHuman3D, {variant}", "limits": "Trained for a comparison only."}
    return replace(
        recipe, name=name.replace(" ", "-").replace(",", ""), model=model, moments=moments, seed=seed,
        steps=steps or recipe.steps, sizes={**recipe.sizes, **change}, card=card,
    )  # fmt: skip


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--runs", type=Path, required=True, help="folder of the runs and of their graphs")
    parser.add_argument("--only", nargs="*", default=list(VARIANTS), choices=VARIANTS, help="variants to train")
    parser.add_argument("--seeds", type=int, nargs="*", default=[0], help="seeds to train them with")
    parser.add_argument("--steps", type=int, help="steps of each. Default: the recipe's")
    asked = parser.parse_args()
    for seed in asked.seeds:
        for variant in asked.only:
            recipe = recipe_of(variant, seed, asked.steps)
            if not (asked.runs / f"{recipe.name}.onnx").is_file():
                train(recipe, Path(), asked.runs / recipe.name, say=lambda line: print(line, flush=True))
                ship(asked.runs / recipe.name, asked.runs)


if __name__ == "__main__":
    main()
