"""What a fresh interpreter loads, and what it must not."""

from __future__ import annotations

import subprocess
import sys

import pytest

HEAVY = ("numpy", "onnxruntime", "torch", "lightning_fabric", "matplotlib", "cyclopts", "rich", "scipy")


def loaded_after(code: str) -> set[str]:
    """Names of all modules that a fresh interpreter has loaded after this code, warnings being errors."""
    probe = f"import sys\n{code}\nprint('\\n' + ' '.join(sys.modules))"
    done = subprocess.run([sys.executable, "-W", "error", "-c", probe], capture_output=True, text=True, check=True)
    return set(done.stdout.splitlines()[-1].split())


@pytest.mark.parametrize(
    ("code", "light"),
    [
        ("import motioncast", HEAVY),
        ("import motioncast; motioncast.Scene", ("onnxruntime", "torch", "cyclopts", "rich", "scipy")),
        ("import motioncast; motioncast.load_scene", ("onnxruntime", "torch", "cyclopts", "rich", "scipy")),
        ("import motioncast.inference", ("torch", "scipy")),
        ("import motioncast; motioncast.load", ("torch", "scipy")),
        ("import motioncast.cli", HEAVY),
        ("from motioncast.cli.app import build; build()", ("torch", "onnxruntime", "scipy")),
        ("sys.argv = ['motioncast', '--version']; from motioncast.cli import main; main()", HEAVY),
    ],
)
def test_loads_only_what_it_needs(code: str, light: tuple[str, ...]) -> None:
    assert not loaded_after(code) & set(light)
