"""``motioncast plot``: the curves of a training run."""

from __future__ import annotations

from pathlib import Path


def plot(run: Path, /, *, out: Path | None = None) -> None:
    """Draw the curves of a training run.

    Args:
        run: Folder of the run.
        out: Picture to write. Default: RUN/curves.png.
    """
    from motioncast.training.plot import plot as draw

    out = out or run / "curves.png"
    draw(run, out)
    print(f"written: {out}")
