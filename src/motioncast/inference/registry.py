"""Models by name: simple guesses, shipped weights, the user's cache, third parties, or a path."""

from __future__ import annotations

import difflib
import os
import sys
from collections.abc import Iterator
from importlib import metadata, resources
from pathlib import Path
from typing import Any

from motioncast.core.card import ModelCard
from motioncast.core.forecaster import LiveForecaster
from motioncast.errors import InputError, ModelNotFound
from motioncast.inference.baselines import RULES, SimpleGuess

DEFAULT_MODEL = "somoformer-fast"

GROUP = "motioncast.models"
"""Entry points of this group name functions that return a forecaster."""


def load(name: str | Path) -> Any:
    """A model by name or path; what it answers is its card's ``task``: ``forecast``, ``goals`` or ``actions``.

    Args:
        name: A simple guess, a shipped model, a model in the user's folder (``MOTIONCAST_HOME``), a third party's,
            or the path of an ONNX file with its card beside it.

    Raises:
        ModelNotFound: If there is none, naming the closest.
        InputError: If the card is missing or damaged.
    """
    if name in RULES:
        return SimpleGuess(str(name))
    cards = dict(_shipped())
    if str(name) in cards:
        return _graph(cards[str(name)])
    path = Path(name)
    if path.suffix == ".onnx":
        if not path.is_file():
            raise ModelNotFound(f"there is no file {path}; give the path of a model that training exported")
        return _graph(path)
    for entry in metadata.entry_points(group=GROUP):
        if entry.name == name:
            return entry.load()()
    known = [*cards, *RULES, *(entry.name for entry in metadata.entry_points(group=GROUP))]
    close = difflib.get_close_matches(str(name), known, 1, 0.3)
    advice = f'did you mean "{close[0]}"?' if close else f"known: {', '.join(known)}"
    raise ModelNotFound(f'there is no model "{name}"; {advice} (motioncast models lists all)')


def load_forecaster(name: str | Path) -> LiveForecaster:
    """A model that answers with futures, by name or path.

    Raises:
        ModelNotFound: If there is none, naming the closest.
        InputError: If it answers with something else, or its card is missing or damaged.
    """
    model = load(name)
    if model.card.task != "forecast":
        raise InputError(f'model "{model.card.name}" answers with {model.card.task}, not with futures; take another')
    return model


def at_paper_size(name: str) -> Path:
    """The graph of a model at the size of its paper, whose weights are made up: for timing.

    Raises:
        ModelNotFound: If there is none.
    """
    folder = _package() / "paper-size"
    path = folder / f"{name}.onnx"
    if not path.is_file():
        known = ", ".join(sorted(card.stem for card in folder.glob("*.json")))
        raise ModelNotFound(f'there is no "{name}" at paper size; there is: {known}')
    return path


def list_models(task: str | None = None) -> list[ModelCard]:
    """The cards of all models that :func:`load` finds by name, the default first.

    Args:
        task: Only those that answer this; ``forecast`` for futures.
    """
    cards = [_card(path) for _, path in _shipped()]
    cards.sort(key=lambda card: (card.name != DEFAULT_MODEL, card.name))
    guesses = [SimpleGuess(name).card for name in RULES]
    found = [*cards, *(entry.load()().card for entry in metadata.entry_points(group=GROUP)), *guesses]
    return [card for card in found if task in (None, card.task)]


def home() -> Path:
    """The user's folder of models."""
    if "MOTIONCAST_HOME" in os.environ:
        return Path(os.environ["MOTIONCAST_HOME"])
    if sys.platform == "win32":
        return Path(os.environ.get("LOCALAPPDATA", Path.home())) / "motioncast"
    if sys.platform == "darwin":
        return Path.home() / "Library" / "Caches" / "motioncast"
    return Path(os.environ.get("XDG_CACHE_HOME", Path.home() / ".cache")) / "motioncast"


def _shipped() -> Iterator[tuple[str, Path]]:
    """Name and weights of each model in the package and in the user's folder."""
    for folder in (_package(), home()):
        if folder.is_dir():
            graphs = sorted(folder.glob("*.onnx"))
            yield from ((path.stem, path) for path in graphs if not path.name.endswith(".scene.onnx"))


def _package() -> Path:
    """The folder of shipped weights."""
    return Path(str(resources.files("motioncast"))) / "weights"


def _card(weights: Path) -> ModelCard:
    path = weights.with_suffix(".json")
    if not path.is_file():
        raise InputError(f"{weights} has no card {path.name} beside it; training writes both, keep them together")
    return ModelCard.from_json(path.read_text(encoding="utf-8"))


def _graph(weights: Path) -> Any:
    # onnxruntime only where a graph is run
    from motioncast.inference.actions import ActionForecaster
    from motioncast.inference.denoiser import DiffusionForecaster
    from motioncast.inference.goals import GoalForecaster
    from motioncast.inference.session import GraphForecaster

    card = _card(weights)
    if card.task == "goals":
        return GoalForecaster(card, weights)
    if card.task == "actions":
        return ActionForecaster(card, weights)
    return DiffusionForecaster(card, weights) if card.diffusion else GraphForecaster(card, weights)
