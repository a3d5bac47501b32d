"""``motioncast train`` : a model from a recipe and data."""

from __future__ import annotations

from pathlib import Path


def train(recipe: str, /, *, data: Path, out: Path | None = None) -> None:
    """Train a model by a recipe; an interrupted run goes on where it stopped.

    Args:
        recipe: Name of a shipped recipe, or a TOML file.
        data: Folder that holds the data sets.
        out: Folder of the run. Default: runs/RECIPE.
    """
    from motioncast.training.loop import train as run

    run(recipe, data, out or Path("runs") / Path(recipe).stem)
