"""Answers as plain objects for JSON; their schemas stand in docs/schemas."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from motioncast.core.forecast import Forecast
from motioncast.core.scene_object import SceneObject


def forecast_answer(forecast: Forecast, files: Sequence[Path] = ()) -> dict[str, Any]:
    """A forecast in the shape of ``motioncast.forecast/1``; its arrays are still NumPy's.

    Args:
        forecast: The forecast.
        files: Files that were written from it.
    """
    things = [_thing(thing.at(-1)) for thing in forecast.history.objects]
    return {
        "schema": "motioncast.forecast/1",
        "model": forecast.card.name,
        "fps": forecast.fps,
        "horizon_s": forecast.horizon_s,
        "seed": forecast.seed,
        "skeleton": list(forecast.skeleton.names),
        "people": list(forecast.people),
        **({"objects": things} if things else {}),
        "times_s": forecast.times_s,
        "samples": [
            {"weight": float(weight), "positions": positions}
            for weight, positions in zip(forecast.weights, forecast.samples, strict=True)
        ],
        "radius_m": dict(forecast.radius_m),
        "files": [str(file) for file in files],
        "warnings": list(forecast.warnings),
    }


def _thing(thing: SceneObject) -> dict[str, Any]:
    """An object that stands; of points and meshes, how large they are."""
    return {
        "name": thing.name,
        "category": thing.category,
        "shape": thing.shape,
        "size": thing.size,
        "position": thing.position,
        "rotation": thing.rotation,
    }
