"""Where an answer goes, and writing it in the format that a file's suffix names."""

from __future__ import annotations

import webbrowser
from collections.abc import Iterable, Sequence
from pathlib import Path

from motioncast.cli.comparing import error_curves
from motioncast.cli.say import note
from motioncast.core.forecast import Forecast
from motioncast.core.scene import Scene
from motioncast.errors import InputError, OutputError

SUFFIXES = (".npz", ".html", ".bvh", ".glb", ".csv", ".trc")
"""What a forecast can be written as."""

THROUGH_BLENDER = "FBX: write .glb or .bvh, import that into Blender and export FBX there, see docs/formats.md"
"""What to do about a format that has no open writer."""

ONE_PERSON_A_FILE = (".bvh", ".trc")


def name_of(files: Sequence[Path], at: float | None = None) -> str:
    """What an answer about these files is called, before its suffix.

    Example:
        >>> name_of([Path("ada.bvh"), Path("ben.bvh")]), name_of([Path("ada.bvh")], at=1.2)
        ('ada+ben', 'ada.at1.2')
    """
    stems = [file.stem for file in files if file.suffix.lower() != ".asf"]
    return "+".join(stems) + ("" if at is None else f".at{at:g}")


def page_beside(file: Path) -> Path:
    """The page that belongs to a forecast file.

    Example:
        >>> page_beside(Path("ada.forecast.npz")).name, page_beside(Path("next.npz")).name
        ('ada.forecast.html', 'next.forecast.html')
    """
    return file.with_name(f"{file.stem.removesuffix('.forecast')}.forecast.html")


def check_suffix(path: Path, known: Sequence[str] = SUFFIXES) -> None:
    """Refuses a file whose suffix names no format, before any work is done.

    Raises:
        InputError: If it is none of ``known``.
    """
    if path.suffix.lower() not in known:
        raise InputError(
            f'cannot write {path}: the suffix "{path.suffix}" is not one of {", ".join(known)} ({THROUGH_BLENDER})'
        )


def spare_inputs(inputs: Iterable[Path | None], outputs: Iterable[Path], people: Sequence[str]) -> None:
    """Refuses to write over a file that was given.

    Args:
        inputs: The files that were read.
        outputs: The files to write, as named by the user.
        people: Ids of the people to write: some formats put each into a file of its own.

    Raises:
        InputError: If a file to write is one of the inputs.
    """
    from motioncast.formats.files import person_paths

    given = [file for file in inputs if file is not None]
    for path in outputs:
        split = path.suffix.lower() in ONE_PERSON_A_FILE
        for target in person_paths(path, people) if split else (path,):
            # the file system knows best whether two names mean one file: links, upper and lower case
            if target.exists() and any(target.samefile(file) for file in given):
                raise InputError(f"{target} is the file you gave; name another with --out")


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

        errors = error_curves(forecast, truth) if truth is not None and _covers(truth, forecast) else {}
        drawn = {name: (forecast.times_s[: len(curve)], curve) for name, curve in errors.items()}
        write_page(forecast, path, truth=truth, curves=drawn)
        return [path]
    from motioncast.formats.load import save_forecast, save_scene

    if suffix == ".npz":
        return list(save_forecast(forecast, path, truth))
    return list(save_scene(forecast.continued(sample), path))


def _covers(truth: Scene, forecast: Forecast) -> bool:
    """Whether a truth, which may come from elsewhere, shows everybody who is forecast, with the same joints."""
    return set(forecast.people) <= set(truth.people) and truth.skeleton.names == forecast.skeleton.names


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
    """Shows a page in the user's browser; says so where there is none."""
    try:
        opened = webbrowser.open(path.resolve().as_uri())
    except webbrowser.Error:
        opened = False
    if not opened:
        note([f"no browser could be opened here; open {path} yourself"])
