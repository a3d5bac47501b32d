"""``motioncast export``: a scene or a forecast in another format."""

from __future__ import annotations

from pathlib import Path

from motioncast.cli.reading import AS_THE_FILE_SAYS, Reading, holds_forecast, read_scene
from motioncast.cli.writing import SUFFIXES, THROUGH_BLENDER, check_suffix, name_of, spare_inputs, write_forecast
from motioncast.errors import InputError


def export(
    *files: Path,
    to: str,
    out: Path | None = None,
    sample: int | None = None,
    reading: Reading = AS_THE_FILE_SAYS,
) -> None:
    """Write a forecast, or a scene, in another format; a file that was given is never overwritten.

    A forecast becomes the motion that was seen, continued by what is foretold; npz and html keep all of it.

    Args:
        files: A forecast (npz), or the files of a scene.
        to: Format to write: npz, csv, trc, bvh, glb, or for forecasts html. FBX goes through Blender, see
            docs/formats.md.
        out: File to write. Default: NAME.forecast.SUFFIX of a forecast, NAME.motioncast.SUFFIX of a scene, in the
            current folder.
        sample: Number of the forecast's sample, from 1. Default: the most probable one.
        reading: How to read files whose header lies.
    """
    if not files:
        raise InputError("no file came; give a forecast, or the files of a scene")
    if f".{to}" not in SUFFIXES:
        known = ", ".join(suffix.removeprefix(".") for suffix in SUFFIXES)
        raise InputError(f"--to {to} is not one of {known} ({THROUGH_BLENDER})")
    if out is not None:
        check_suffix(out)
    if out is not None and out.suffix.lower() != f".{to}":
        raise InputError(f"--out {out} does not end in .{to}; let --to and the suffix of --out agree")
    if len(files) == 1 and holds_forecast(files[0]):
        written = _export_forecast(files[0], to, out, sample)
    else:
        written = _export_scene(files, to, out, reading)
    for file in written:
        print(f"written: {file}")


def _export_forecast(file: Path, to: str, out: Path | None, sample: int | None) -> list[Path]:
    from motioncast.formats.load import load_forecast, load_truth

    forecast = load_forecast(file)
    if sample is not None and not 1 <= sample <= len(forecast.samples):
        raise InputError(f"--sample {sample} came; {file} holds {len(forecast.samples)}, counted from 1")
    out = out or Path(f"{file.stem.removesuffix('.forecast')}.forecast.{to}")
    spare_inputs([file], [out], forecast.people)
    return write_forecast(forecast, out, load_truth(file), None if sample is None else sample - 1)


def _export_scene(files: tuple[Path, ...], to: str, out: Path | None, reading: Reading) -> list[Path]:
    from motioncast.formats.load import save_scene

    if to == "html":
        raise InputError("a page shows a forecast; make one first with: motioncast forecast")
    scene = read_scene(files, reading)
    out = out or Path(f"{name_of(files)}.motioncast.{to}")
    spare_inputs([*files, reading.map], [out], scene.people)
    return list(save_scene(scene, out))
