"""One file a system, in torch, readable like the method section of its paper.

A model file says at its end what it defines: ``MODEL``, the module, and ``CONFIG``, the dataclass of its sizes.
"""

from __future__ import annotations

from collections.abc import Mapping
from importlib import import_module
from pkgutil import iter_modules
from typing import Any

from motioncast.errors import InputError


def model_names() -> list[str]:
    """Names of the model files."""
    return sorted(module.name for module in iter_modules(__path__))


def build(name: str, sizes: Mapping[str, Any]) -> Any:
    """An untrained model.

    Args:
        name: File of the model.
        sizes: Arguments of its configuration.

    Raises:
        InputError: If there is no such file.
    """
    if name not in model_names():
        raise InputError(f'there is no model file "{name}"; use one of {", ".join(model_names())}')
    file = import_module(f"motioncast.models.{name}")
    return file.MODEL(file.CONFIG(**sizes))
