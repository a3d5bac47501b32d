"""Answers as plain objects for JSON; their schemas stand in docs/schemas."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from motioncast.core.action_steps import ActionSteps
from motioncast.core.forecast import Forecast
from motioncast.core.goal_poses import GoalPoses
from motioncast.core.scene_object import SceneObject
from motioncast.core.skeletons import UPPER9


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


def goals_answer(goals: GoalPoses, files: Sequence[Path] = ()) -> dict[str, Any]:
    """Goal poses in the shape of ``motioncast.goals/1``; its arrays are still NumPy's.

    Args:
        goals: The goal poses.
        files: Files that were written from them.
    """
    things = [_thing(thing.at(-1)) for thing in goals.history.objects]
    return {
        "schema": "motioncast.goals/1",
        "model": goals.card.name,
        "seed": goals.seed,
        "skeleton": list(goals.skeleton.names),
        "people": list(goals.people),
        **({"objects": things} if things else {}),
        "goals": [
            {"weights": weights, "positions": positions}
            for weights, positions in zip(goals.weights, goals.poses, strict=True)
        ],
        "heat": {
            "side_m": goals.heat_side_m,
            "origin": goals.heat_origin,
            "across": goals.heat_across,
            **{hand: goals.heat[hand] for hand in goals.heat},
        },
        "files": [str(file) for file in files],
        "warnings": list(goals.warnings),
    }


def actions_answer(steps: ActionSteps, files: Sequence[Path] = ()) -> dict[str, Any]:
    """Steps in the shape of ``motioncast.actions/1``; its arrays are still NumPy's.

    Args:
        steps: The steps.
        files: Files that were written from them.
    """
    camera = steps.camera
    return {
        "schema": "motioncast.actions/1",
        "model": steps.card.name,
        "seed": steps.seed,
        "skeleton": list(UPPER9.names),
        "people": list(steps.people),
        "labels": list(steps.labels),
        "camera": {
            "focal_px": camera.focal_px,
            "centre_px": camera.centre_px,
            "size_px": camera.size_px,
            "position": camera.position,
            "rotation": camera.rotation,
        },
        "past": [[steps.labels[action] for action in step] for step in steps.past_actions],
        "samples": [
            {
                "weight": float(weight),
                "steps": [
                    {
                        "actions": [steps.labels[action] for action in actions],
                        "probabilities": probabilities,
                        "positions": positions,
                        "pixels": pixels,
                    }
                    for actions, probabilities, positions, pixels in zip(*parts, strict=True)
                ],
            }
            for weight, *parts in zip(
                steps.weights, steps.actions, steps.probabilities, steps.poses, steps.pixels, strict=True
            )
        ],
        "files": [str(file) for file in files],
        "warnings": list(steps.warnings),
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
