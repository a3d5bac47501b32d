"""``motioncast doctor``: what is installed here."""

from __future__ import annotations

import platform
import sys
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

from motioncast.cli.say import table

PACKAGES = {
    "base": ("numpy", "onnxruntime", "cyclopts", "rich"),
    "extra train": ("torch", "lightning-fabric", "onnx"),
    "extra c3d": ("ezc3d",),
    "extra plot": ("matplotlib",),
}


def doctor() -> None:
    """Say which versions, extras, models and devices are here."""
    rows = [
        ("motioncast", found("motioncast"), str(Path(__file__).parents[1])),
        ("Python", platform.python_version(), sys.executable),
        ("system", platform.machine(), platform.platform()),
    ]
    rows += [(package, found(package), part) for part, packages in PACKAGES.items() for package in packages]
    table(("what", "version", "where"), rows)

    from motioncast.inference.registry import list_models

    print(f"\nmodels: {', '.join(card.name for card in list_models())}")


def found(package: str) -> str:
    """Version of an installed package, or "not installed"."""
    try:
        return version(package)
    except PackageNotFoundError:
        return "not installed"
