"""``motioncast export``: a scene or a forecast in another format."""

from __future__ import annotations

from pathlib import Path
from typing import Literal

from motioncast.cli.reading import AS_THE_FILE_SAYS, Reading, holds_forecast, read_scene
from motioncast.cli.writing import write_forecast
from motioncast.errors import InputError


def export(
    *files: Path,
    to: Literal["npz", "csv", "trc", "bvh", "glb", "html"],
    out: Path | None = None,
    sample: int | None = None,
    reading: Reading = AS_THE_FILE_SAYS,
) -> None:
    """Write a forecast, or a scene, in another format.

    A forecast becomes the motion that was seen, continued by what is foretold.

    Args:
        files: A forecast (npz), or the files of a scene.
        to: Format to write.
        out: File to write. Default: the first file's name with the new suffix, in the current folder.
        sample: Number of the forecast's sample, from 1. Default: the most probable one.
        reading: How to read files whose header lies.
    """
    out = out or Path(f"{files[0].stem if files else 'scene'}.{to}")
    if out.suffix.lower() != f".{to}":
        raise InputError(f"--out {out} does not end in .{to}; let --to and the suffix of --out agree")
    for file in _write(files, out, sample, reading):
        print(f"written: {file}")


def _write(files: tuple[Path, ...], out: Path, sample: int | None, reading: Reading) -> list[Path]:
    from motioncast.formats.load import load_forecast, load_truth, save_scene

    if len(files) == 1 and holds_forecast(files[0]):
        forecast = load_forecast(files[0])
        if sample is not None and not 1 <= sample <= len(forecast.samples):
            raise InputError(f"--sample {sample} came; {files[0]} holds {len(forecast.samples)}, counted from 1")
        return write_forecast(forecast, out, load_truth(files[0]), None if sample is None else sample - 1)
    if out.suffix.lower() == ".html":
        raise InputError("a page shows a forecast; make one first with: motioncast forecast")
    return list(save_scene(read_scene(files, reading), out))
