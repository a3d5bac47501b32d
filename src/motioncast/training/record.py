"""What a run says of itself when it ships: its best look at the validation set, and what it cost."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from motioncast.training.recipe import Recipe


def best_look(run: Path) -> dict[str, Any]:
    """The entry of the run's log whose weights were kept."""
    lines = (run / "metrics.jsonl").read_text(encoding="utf-8").splitlines()
    return min(map(json.loads, lines), key=lambda entry: entry["score"])


def figures(best: dict[str, Any], name: str) -> dict[str, Any]:
    """The validation figures of a look for the card, under a name."""
    return {
        name: {part: round(value, 4) for part, value in best["validation"].items()},
        "chosen_at_step": best["step"],
    }


def cost(best: dict[str, Any], recipe: Recipe) -> dict[str, Any]:
    """What the run had cost at a look, for the card."""
    return {
        "scenes": best["step"] * recipe.batch,
        "minutes": round(best["seconds"] / 60, 1),
        "device": best.get("device", "cpu"),
        "seed": recipe.seed,
    }
