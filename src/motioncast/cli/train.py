"""``motioncast train``: a model from a recipe and data."""

from __future__ import annotations

import sys
from pathlib import Path

from motioncast.errors import MissingExtra


def train(recipe: str, /, *, data: Path, out: Path | None = None) -> None:
    """Train a model by a recipe; the same command goes on with an interrupted run.

    Args:
        recipe: Name of a shipped recipe, or a TOML file.
        data: Folder that holds the data sets.
        out: Folder of the run. Default: runs/NAME.
    """
    from motioncast.training.recipe import read_recipe

    plan = read_recipe(recipe)
    try:
        from motioncast.training.loop import train as run
        from motioncast.training.ship import ship
    except ModuleNotFoundError as error:
        if (error.name or "").partition(".")[0] not in ("torch", "lightning_fabric", "onnx"):
            raise
        raise MissingExtra("training", "train") from None
    folder = out or Path("runs") / plan.name
    run(plan, data, folder, say=lambda line: print(line, file=sys.stderr))
    card = ship(folder)
    print(f"trained: {folder / f'{card.name}.onnx'}")
    print(f"try it:  motioncast demo --model {folder / f'{card.name}.onnx'}")
