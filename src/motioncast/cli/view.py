"""``motioncast view``: a scene or a forecast as an interactive page."""

from __future__ import annotations

from pathlib import Path

from motioncast.cli.writing import open_page, write_forecast


def view(file: Path, /, *, out: Path | None = None, no_browser: bool = False) -> None:
    """Show a forecast as an interactive page.

    Args:
        file: A forecast (npz).
        out: Page to write. Default: the file's name with .html, beside it.
        no_browser: Write the page and do not open it.
    """
    from motioncast.formats.load import load_forecast, load_truth

    page = out or file.with_suffix(".html")
    write_forecast(load_forecast(file), page, load_truth(file))
    print(f"written: {page}")
    if not no_browser:
        open_page(page)
