"""The curves of a training run."""

from __future__ import annotations

import json
from pathlib import Path

from motioncast.errors import InputError, MissingExtra
from motioncast.formats.files import atomic_write


def plot(run: Path, out: Path) -> None:
    """Draw loss and validation ratios of a run over its steps.

    Args:
        run: Folder of the run, with ``metrics.jsonl``.
        out: Picture to write; its suffix tells the format.

    Raises:
        InputError: If the folder holds no run.
        MissingExtra: If matplotlib is not installed.
    """
    try:
        from matplotlib.figure import Figure
    except ModuleNotFoundError:
        raise MissingExtra("plotting", "plot") from None
    log = run / "metrics.jsonl"
    if not log.is_file():
        raise InputError(f"{run} holds no metrics.jsonl; give the folder of a training run")
    entries = [json.loads(line) for line in log.read_text(encoding="utf-8").splitlines()]
    steps = [entry["step"] for entry in entries]
    figure = Figure(figsize=(9, 4), layout="constrained")
    loss, validation = figure.subplots(1, 2)
    loss.plot(steps, [entry["loss"] for entry in entries], color="black")
    loss.set(title="training loss", xlabel="step")
    for name in entries[0]["validation"]:
        validation.plot(steps, [entry["validation"][name] for entry in entries], label=name)
    validation.set(title="validation error over standing still", xlabel="step")
    validation.legend()
    with atomic_write(out) as temporary:
        figure.savefig(temporary, dpi=150)
