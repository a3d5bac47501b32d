"""``motioncast view``: a forecast as an interactive page."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from motioncast.cli.reading import holds_forecast, put_into
from motioncast.cli.writing import check_suffix, open_page, page_beside, write_forecast
from motioncast.errors import InputError


def view(*files: Path, room: Path | None = None, out: Path | None = None, closed: bool = False) -> None:
    """Show a forecast as an interactive page.

    Motion without a forecast has no page: motioncast forecast FILE --view makes both.

    Args:
        files: A forecast (npz), one.
        room: Furniture to show around the people: a JSON file written by hand, or a GLB whose nodes are named.
        out: Page to write. Default: NAME.forecast.html beside the forecast.
        closed: Write the page and do not open it.
    """
    from motioncast.formats.files import read_bytes
    from motioncast.formats.load import load_forecast, load_truth

    together = " ".join(map(str, files))
    if len(files) != 1:
        came = f"{len(files)} files came" if files else "no file came"
        make = f"motioncast forecast {together or 'FILE'} --view"
        raise InputError(f"{came}; view shows one forecast, and to forecast motion files use: {make}")
    (file,) = files
    read_bytes(file, 1)  # a missing file is the better news than one without a forecast
    if not holds_forecast(file):
        raise InputError(
            f"{file} holds no forecast, and only forecasts can be shown; "
            f"make one with: motioncast forecast {file} --view"
        )
    page = out or page_beside(file)
    check_suffix(page, (".html",))
    answer = load_forecast(file)
    if room is not None:
        answer = replace(answer, history=put_into(answer.history, room))
    write_forecast(answer, page, load_truth(file))
    print(f"written: {page}")
    if not closed:
        open_page(page)
