"""``motioncast view``: a forecast as an interactive page."""

from __future__ import annotations

from pathlib import Path

from motioncast.cli.reading import holds_forecast
from motioncast.cli.writing import open_page, write_forecast
from motioncast.errors import InputError


def view(file: Path, /, *, out: Path | None = None, closed: bool = False) -> None:
    """Show a forecast as an interactive page.

    Args:
        file: A forecast (npz).
        out: Page to write. Default: the file's name with .html, beside it.
        closed: Write the page and do not open it.
    """
    from motioncast.formats.load import load_forecast, load_truth

    if not holds_forecast(file):
        raise InputError(f"{file} holds no forecast; make one with: motioncast forecast {file} --view")
    page = out or file.with_suffix(".html")
    write_forecast(load_forecast(file), page, load_truth(file))
    print(f"written: {page}")
    if not closed:
        open_page(page)
