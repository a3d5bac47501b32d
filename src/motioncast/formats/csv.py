"""Tables: a row a frame and person, three columns a joint; what pandas, R and a spreadsheet expect.

    # fps: 30
    # up: z
    # unit: m
    time_s,person,pelvis_x,pelvis_y,pelvis_z,left_hip_x,...
    0.0,dancer,0.12,0.03,0.95,...

An empty cell means not observed, and so does a missing row. Comment lines are optional: the frame rate then
follows from the times, up axis and unit from the body. ``person`` may be left out where there is one. Forecasts
have the columns ``sample`` and ``weight`` in front, and times count from the last observed frame.
"""

from __future__ import annotations

import csv
import io
from collections.abc import Mapping
from pathlib import Path

import numpy as np

from motioncast.core.forecast import Forecast
from motioncast.core.scene import Scene
from motioncast.core.skeletons import grow, reordered
from motioncast.errors import FormatError
from motioncast.formats import units
from motioncast.formats.files import atomic_write, read_text

suffixes = (".csv",)

MAX_CELLS = 100_000_000
"""Most numbers of one scene: frames times people times joints times 3."""


def sniff(head: bytes) -> bool:
    """Whether a file that begins so is such a table."""
    lines = head.decode("utf-8-sig", "ignore").splitlines()
    return any("time_s" in line and "," in line for line in lines if not line.startswith("#"))


def read(
    path: str | Path,
    *,
    up: str | None = None,
    unit: str | None = None,
    fps: float | None = None,
    named: Mapping[str, str] | None = None,
) -> Scene:
    """The people of a table.

    Args:
        path: The file.
        up: Axis that points up, over the file's comment; else inferred.
        unit: Unit of length, over the file's comment; else inferred.
        fps: Frame rate to believe instead of the file's.
        named: Landmarks by joint name, over the recognised ones.

    Raises:
        FormatError: With the line, if the table is damaged.
        SceneError: If no unit makes a person of the bodies.
    """
    lines = read_text(path).split("\n")
    stated = _comments(lines)
    first = next((index for index, line in enumerate(lines) if line.strip() and not line.startswith("#")), None)
    if first is None:
        raise FormatError(path, "is empty; expected a header time_s,person,JOINT_x,JOINT_y,JOINT_z,...")
    header = [name.strip() for name in next(csv.reader([lines[first]]))]
    joints = _joints(header, path, first + 1)
    times, people, values = _rows(lines, first, header, path)
    rate = fps or _stated_rate(stated, path) or _rate(times, path)
    frames = np.rint((times - times.min()) * rate).astype(np.int64)
    if np.abs((times - times.min()) * rate - frames).max() > 0.25:
        raise FormatError(path, f"the times do not lie on {rate:g} frames a second; resample them or give --fps")
    ids = tuple(dict.fromkeys(people))
    count = int(frames.max()) + 1
    if count * len(ids) * len(joints) * 3 > MAX_CELLS:
        raise FormatError(path, f"its times span {count} frames, more than are read; check the first column and --fps")
    row = np.array([ids.index(person) for person in ids])[np.unique(people, return_inverse=True)[1]] if False else (
        np.array([ids.index(person) for person in people])
    )
    return Scene(values, joints, rate)
