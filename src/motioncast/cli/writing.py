"""Writing an answer in the format that a file's suffix names."""

from __future__ import annotations

import webbrowser
from pathlib import Path

from motioncast.core.forecast import Forecast
from motioncast.core.scene import Scene
from motioncast.errors import OutputError


def write_forecast(forecast: Forecast, path: Path, truth: Scene | None = None, sample: int | None = None) -> list[Path]:
    """Writes a forecast: all of it as npz or as a page (html), the continued motion in any other format.

    Args:
        forecast: The forecast.
        path: The file; its suffix tells the format.
        truth: What really happened, if known.
        sample: Sample that continues the motion. Default: the most probable one.

    Returns:
        The files written.
    """
    suffix = path.suffix.lower()
    if suffix == ".html":
        from motioncast.view.page import write_page

        write_page(forecast, path, truth=truth)
        return [path]
    from motioncast.formats.load import save_forecast, save_scene

    if suffix == ".npz":
        return list(save_forecast(forecast, path, truth))
    return list(save_scene(forecast.continued(sample), path))


def make_folder(folder: Path) -> None:
    """Makes a folder for results, and those above it.

    Raises:
        OutputError: If that cannot be.
    """
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise OutputError(f"cannot make the folder {folder} ({error.strerror}); give another one") from None


def open_page(path: Path) -> None:
    """Shows a page in the user's browser."""
    webbrowser.open(path.resolve().as_uri())
