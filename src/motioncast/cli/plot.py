"""``motioncast plot``: the curves of a training run."""

from __future__ import annotations

from pathlib import Path

from motioncast.errors import MissingExtra


def plot(run: Path, /, *, out: Path | None = None) -> None:
    """Draw the curves of a training run.

    Args:
        run: Folder of the run.
        out: Picture to write. Default: RUN/curves.png.
    """
    from motioncast.training.plot import plot as draw

    out = out or run / "curves.png"
    try:
        draw(run, out)
    except ModuleNotFoundError as error:
        if (error.name or "").partition(".")[0] != "matplotlib":
            raise
        raise MissingExtra("plotting", "plot") from None
    print(f"written: {out}")
