"""C3D files of marker systems, read by ezc3d (extra ``c3d``).

Labelled points become joints; a point that the system lost is not observed. Unit and rate are the file's.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np

from motioncast.core.scene import Scene
from motioncast.core.skeletons import grow
from motioncast.errors import FormatError, MissingExtra
from motioncast.formats import units

suffixes = (".c3d",)


def sniff(head: bytes) -> bool:
    """Whether a file that begins so is a C3D file: its second byte is the format's mark."""
    return len(head) > 1 and head[1] == 0x50 and head[0] < 10


def read(
    path: str | Path,
    *,
    up: str | None = None,
    unit: str | None = None,
    fps: float | None = None,
    named: Mapping[str, str] | None = None,
) -> Scene:
    """The person of a C3D file.

    Args:
        path: The file.
        up: Axis that points up; else inferred from the body.
        unit: Unit of length instead of the file's.
        fps: Frame rate to believe instead of the file's.
        named: Landmarks by point label, over the recognised ones.

    Raises:
        MissingExtra: If ezc3d is not installed.
        FormatError: If the file is damaged or holds no points.
        SceneError: If the unit makes no person of the body.
    """
    try:
        import ezc3d
    except ModuleNotFoundError:
        raise MissingExtra(f"reading {Path(path).name}", "c3d") from None
    try:
        file = ezc3d.c3d(str(path))
    except (OSError, RuntimeError, ValueError) as error:
        raise FormatError(path, f"is no readable C3D file ({error})") from None
    point = file["parameters"]["POINT"]
    values = np.moveaxis(np.asarray(file["data"]["points"], float)[:3], 0, -1).swapaxes(0, 1)[:, None]
    labels = [label.strip() for label in point["LABELS"]["value"]][: values.shape[2]]
    if not labels or not len(values):
        raise FormatError(path, "holds no labelled points; motioncast needs markers or joint centres")
    skeleton = grow(list(dict.fromkeys(labels)), Path(path).stem, named)
    values = values[:, :, [labels.index(name) for name in skeleton.names]]
    observed = np.isfinite(values).all(-1)
    values = np.where(observed[..., None], values, 0)
    stated = unit or next(iter(point.get("UNITS", {}).get("value", [])), None)
    world = units.settle(path, values, observed, skeleton, up=up, unit=stated, usual_up="z")
    rate = fps or float(point["RATE"]["value"][0])
    return Scene(
        world.points(values), skeleton, rate, observed, (Path(path).stem,), source=str(path), remarks=world.remarks
    )
