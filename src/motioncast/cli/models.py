"""``motioncast models``: what there is to load."""

from __future__ import annotations

from dataclasses import asdict

from motioncast.cli.say import emit, table


def models(*, json: bool = False) -> None:
    """List the models, trained and simple.

    Args:
        json: Print the cards as one JSON object.
    """
    from motioncast.inference.registry import list_models

    cards = list_models()
    if json:
        emit({"schema": "motioncast.models/1", "models": [asdict(card) for card in cards]})
        return
    table(
        ("model", "system", "skeleton", "reads", "answers", "people", "parameters"),
        [
            (
                card.name,
                card.system,
                card.skeleton,
                f"{card.history} steps" if card.task == "actions" else f"{card.history} at {card.fps:g} fps",
                f"{card.horizon} steps" if card.task == "actions" else f"{card.horizon / card.fps:.1f} s",
                card.people,
                f"{card.parameters:,}" if card.parameters else "none",
            )
            for card in cards
        ],
    )
