"""C3D, the binary files of motion laboratories, read by the extra ``c3d`` (ezc3d).

Points are joints; invalid points are not observed; angles, forces and other curves that share the table of points
are left out. Labels such as ``Ann:LKNE`` and ``Bob:LKNE`` are two people.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from motioncast.core.scene import Scene
from motioncast.errors import FormatError, MissingExtra
from motioncast.formats.files import read_bytes
from motioncast.formats.points import scene_of_points

suffixes = (".c3d",)

_OTHER_CURVES = ("ANGLES", "FORCES", "MOMENTS", "POWERS", "SCALARS")


def sniff(head: bytes) -> bool:
    """Whether a file that begins so is C3D."""
    return len(head) >= 512 and head[1] == 0x50 and head[0] < 10


def read(
    path: str | Path,
    *,
    up: str | None = None,
    unit: str | None = None,
    fps: float | None = None,
    named: Mapping[str, str] | None = None,
) -> Scene:
    """The points of the people in a file.

    Args:
        path: The file.
        up: Axis that points up, over the file's Y_SCREEN; else inferred.
        unit: Unit of length to believe instead of the file's.
        fps: Frame rate to believe instead of the file's.
        named: Landmarks by point name, over the recognised ones.

    Raises:
        MissingExtra: If ezc3d is not installed.
        FormatError: If the file is damaged.
        SceneError: If the unit makes no person of the body.
    """
    if not sniff(read_bytes(path, 512)):
        raise FormatError(path, "does not begin like a C3D file; is it one?")
    try:
        import ezc3d
    except ImportError:
        raise MissingExtra(f"reading {Path(path).name}", "c3d") from None
    try:
        content = ezc3d.c3d(str(path))
        parameters: Any = content["parameters"]["POINT"]
        points = np.moveaxis(np.asarray(content["data"]["points"])[:3], 0, -1).swapaxes(0, 1)
        residuals = np.asarray(content["data"]["meta_points"]["residuals"])[0].T
        rate = float(content["header"]["points"]["frame_rate"])
    except Exception as error:  # the C++ reader and its binding raise anything on damaged bytes
        raise FormatError(path, f"is damaged ({error}); expected a whole C3D file") from None
    labels = [label.strip() for label in _values(parameters, "LABELS", "LABELS2", "LABELS3")][: points.shape[1]]
    others = set(_values(parameters, *_OTHER_CURVES))
    kept = [index for index, label in enumerate(labels) if label and label[0] != "*" and label not in others]
    if not kept or not len(points):
        raise FormatError(path, "holds no labelled points; export the labelled trajectories")
    valid = (residuals >= 0) & np.isfinite(points).all(-1) & points.any(-1)
    points = np.where(valid[..., None], points, np.nan)
    people, names = _people([labels[index] for index in kept], Path(path).stem)
    table = np.full((len(points), len(people), len(names), 3), np.nan)
    for index in kept:
        person, _, name = labels[index].rpartition(":") if len(people) > 1 else (people[0], "", labels[index])
        table[:, people.index(person), names.index(name)] = points[:, index]
    screen = "".join(_values(content["parameters"]["POINT"], "Y_SCREEN")).lower().strip("+ ")
    return scene_of_points(
        path, names, people, table, fps or rate,
        up=up or screen or None, unit=unit or "".join(_values(parameters, "UNITS")).strip() or None,
        usual_up="z", named=named,
    )  # fmt: skip


def _values(parameters: Any, *names: str) -> list[str]:
    """The texts of some parameters, one after the other; none where they are missing."""
    return [str(value) for name in names if name in parameters for value in parameters[name]["value"]]


def _people(labels: list[str], stem: str) -> tuple[list[str], list[str]]:
    """People and point names: prefixes before a colon are people where there are several."""
    prefixes = list(dict.fromkeys(label.rpartition(":")[0] for label in labels))
    if len(prefixes) > 1 and all(prefixes):
        return prefixes, list(dict.fromkeys(label.rpartition(":")[2] for label in labels))
    return [stem], labels
