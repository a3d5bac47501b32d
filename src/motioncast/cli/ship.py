"""``motioncast ship``: the graph and the card of a trained run, error radii included."""

from __future__ import annotations

from pathlib import Path

from motioncast.errors import MissingExtra


def ship(run: Path, /, *, data: Path, folds: tuple[Path, ...] = (), out: Path | None = None) -> None:
    """Write the graph and the card of a run, with calibrated error radii.

    Args:
        run: Folder of the run.
        data: Folder that holds the data sets.
        folds: Folders of runs of the same recipe that each left a part of the takes out (recipe entries folds and
            fold); without them the radii come from the run's own validation takes.
        out: Folder for the two files. Default: the run's.
    """
    try:
        from motioncast.training.ship import calibrated
        from motioncast.training.ship import ship as write
    except ModuleNotFoundError as error:
        if (error.name or "").partition(".")[0] not in ("torch", "lightning_fabric", "onnx"):
            raise
        raise MissingExtra("shipping", "train") from None
    from motioncast.inference.registry import load

    folder = out or run
    card = write(run, folder)
    radius = calibrated(folds, data, load(folder / f"{card.name}.onnx"))
    write(run, folder, radius)
    print(f"written: {folder / f'{card.name}.onnx'} and its card; radii {radius['method']}, {radius['n_takes']} takes")
