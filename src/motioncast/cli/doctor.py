"""``motioncast doctor``: what is installed here."""

from __future__ import annotations

import os
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
    """Say which versions, extras, models and cores are here, and where ONNX Runtime could compute."""
    rows = [
        ("motioncast", found("motioncast"), str(Path(__file__).parents[1])),
        ("Python", platform.python_version(), sys.executable),
        ("system", platform.machine(), platform.platform()),
        ("cores", str(os.cpu_count()), ""),
    ]
    rows += [(package, found(package), part) for part, packages in PACKAGES.items() for package in packages]
    table(("what", "version", "where"), rows)

    from motioncast.inference.registry import list_models

    print(f"\nmodels: {', '.join(card.name for card in list_models())}")
    print(f"ONNX Runtime's providers: {providers()}; models run on CPUExecutionProvider")


def providers() -> str:
    """What ONNX Runtime could compute on, or why it cannot."""
    try:
        import onnxruntime
    except ImportError as error:  # what is broken here is what a report is about
        return f"none ({error})"
    return ", ".join(onnxruntime.get_available_providers())


def found(package: str) -> str:
    """Version of an installed package, or "not installed"."""
    try:
        return version(package)
    except PackageNotFoundError:
        return "not installed"
