"""A recipe: everything that decides a trained model, in one TOML file."""

from __future__ import annotations

import json
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass, field, fields
from importlib import resources
from pathlib import Path
from typing import Any

from motioncast.errors import InputError


@dataclass(frozen=True, slots=True)
class Recipe:
    """How a model is trained.

    Attributes:
        name: Name of the trained model.
        model: Name of the file in ``models`` that defines it.
        sizes: Arguments of the model's configuration.
        steps: Optimiser steps.
        batch: Scenes a step; of rooms, people a step.
        learning_rate: Highest rate; it rises over ``warmup`` steps and falls along a cosine to a hundredth.
        warmup: Steps of the rise.
        weight_decay: Of AdamW.
        average: Decay of the running mean of the weights; that mean is what is shipped.
        couple_share: Share of scenes in which the couple dances.
        people: Numbers of people in a scene; a batch has one of them.
        speed: Range of the factor by which time is stretched.
        scale: Range of the factor by which people are enlarged.
        reverse: Share of scenes that run backwards.
        mirror: Share of scenes that are mirrored.
        yaw: Whether scenes are turned at random (for models that do not see through it).
        hide: Share of people that are taken out of a scene.
        late: Share of people who enter the scene within the first half of the history.
        drop: Share of joints of the history that are not seen.
        noise_m: Standard deviation of the noise on seen positions.
        scenes: If above 0, so many scenes are drawn once and seen again and again; else each is a new one.
        validate_every: Steps between two looks at the validation takes.
        start: Weights to begin from (a run's ``best.pt``); empty: from scratch.
        folds: If above 0, the run serves error radii: train and validation takes are split into so many parts by
            actor (the couple by take), and one part is left out.
        fold: The part that is left out.
        task: What it learns from: ``windows`` of takes, composed ``rooms`` with their furniture, or ``room-windows``,
            the people of such rooms alone, or ``actions`` of the kitchen grammar.
        rooms: Number of rooms that are built for it.
        moments: Of actions: which pose stands for a step (``datasets/kitchen``).
        card: What the model's card says of source, limits and exceptions.
        seed: Seed of everything.
    """

    name: str
    model: str
    sizes: dict[str, Any] = field(default_factory=dict)
    steps: int = 8000
    batch: int = 64
    learning_rate: float = 1e-3
    warmup: int = 200
    weight_decay: float = 0.05
    average: float = 0.998
    couple_share: float = 0.4
    people: tuple[int, ...] = (2, 3)
    speed: tuple[float, float] = (0.8, 1.25)
    scale: tuple[float, float] = (0.9, 1.1)
    reverse: float = 0.3
    mirror: float = 0.5
    yaw: bool = False
    hide: float = 0.1
    late: float = 0.1
    drop: float = 0.02
    noise_m: float = 0.002
    scenes: int = 0
    validate_every: int = 500
    seed: int = 0
    start: str = ""
    folds: int = 0
    fold: int = 0
    task: str = "windows"
    rooms: int = 200
    moments: str = "characteristic"
    card: dict[str, Any] = field(default_factory=dict)


def read_recipe(name_or_path: str | Path) -> Recipe:
    """A shipped recipe by name, or any by path.

    Raises:
        InputError: If there is none, or it has unknown entries.
    """
    path = Path(name_or_path)
    folder = resources.files("motioncast.training") / "recipes"
    shipped = folder / f"{name_or_path}.toml"
    if path.suffix == ".toml" and path.is_file():
        text = path.read_text(encoding="utf-8")
    elif shipped.is_file():
        text = shipped.read_text(encoding="utf-8")
    else:
        names = sorted(entry.name.removesuffix(".toml") for entry in folder.iterdir() if entry.name.endswith(".toml"))
        raise InputError(f'there is no recipe "{name_or_path}"; use one of {", ".join(names)} or the path of a .toml')
    try:
        values = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise InputError(f'recipe "{name_or_path}" is not TOML: {error}') from None
    known = {entry.name for entry in fields(Recipe)}
    if not {"name", "model"} <= set(values) <= known:
        odd = ", ".join(sorted(set(values) - known)) or "name and model are needed"
        raise InputError(
            f'recipe "{name_or_path}" has unknown or missing entries ({odd}); known: {", ".join(sorted(known))}'
        )
    return recipe_of(values)


def recipe_of(entries: Mapping[str, Any]) -> Recipe:
    """A recipe from entries as TOML and JSON hold them, with lists for tuples."""
    arguments: dict[str, Any] = {
        key: tuple(value) if isinstance(value, list) else value for key, value in entries.items()
    }
    return Recipe(**arguments)


def read_run(run: Path) -> Recipe:
    """The recipe that a run was begun with.

    Raises:
        InputError: If the folder holds no run.
    """
    path = run / "recipe.json"
    if not path.is_file():
        raise InputError(f"{run} holds no recipe.json; give the folder of a training run")
    return recipe_of(json.loads(path.read_text(encoding="utf-8")))
