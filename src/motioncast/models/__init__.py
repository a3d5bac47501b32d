"""One file a system, in torch, readable like the method section of its paper."""

from __future__ import annotations

from collections.abc import Mapping
from importlib import import_module
from typing import Any

MODELS: dict[str, tuple[str, str]] = {
    "somoformer": ("SoMoFormer", "SoMoFormerConfig"),
    "somoformer_fast": ("SoMoFormerFast", "SoMoFormerFastConfig"),
}
"""Model files, and the names of the model and its configuration in them."""


def build(name: str, sizes: Mapping[str, Any]) -> Any:
    """An untrained model.

    Args:
        name: File of the model.
        sizes: Arguments of its configuration.
    """
    model, config = MODELS[name]
    file = import_module(f"motioncast.models.{name}")
    return getattr(file, model)(getattr(file, config)(**sizes))
