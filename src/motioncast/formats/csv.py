"""Tables: a row a frame and person, three columns a joint; what pandas, R and a spreadsheet expect.

    # fps: 30
    # up: z
    # unit: m
    time_s,person,pelvis_x,pelvis_y,pelvis_z,left_hip_x,...
    0.0,dancer,0.12,0.03,0.95,...

An empty cell (or NA, or NaN) means not observed, and so does a missing row. Comment lines are optional: the frame
rate then follows from the times, up axis and unit from the body. ``person`` may be left out where there is one.
Forecasts have the columns ``sample`` and ``weight`` in front, and their times count from the last observed frame.
"""

from __future__ import annotations

import csv
from collections.abc import Iterator, Mapping
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from motioncast.core.forecast import Forecast
from motioncast.core.scene import Scene
from motioncast.errors import FormatError
from motioncast.formats.files import atomic_write, read_text
from motioncast.formats.points import scene_of_points

suffixes = (".csv",)

MAX_CELLS = 100_000_000
"""Most numbers of one scene: frames times people times joints times 3."""

_BLANK = {"", "na", "nan"}


def sniff(head: bytes) -> bool:
    """Whether a file that begins so is such a table."""
    lines = head.decode("utf-8-sig", "ignore").splitlines()
    header = next((line for line in lines if line.strip() and not line.startswith("#")), "")
    return "time_s" in [name.strip().strip('"') for name in header.split(",")]


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
    start = next((index for index, line in enumerate(lines) if line.strip() and not line.startswith("#")), None)
    if start is None:
        raise FormatError(path, "has no header; expected time_s,person,JOINT_x,JOINT_y,JOINT_z,...")
    stated = _comments(lines[:start])
    _, cells = next(_cells(lines[start : start + 1], path, start + 1), (0, []))
    header = [name.strip() for name in cells]
    joints = _joints(header, path, start + 1)
    times, people, values = _rows(lines, start, header, path)
    frames, rate = _frames(times, fps or _stated_rate(stated, path), path)
    ids = {person: row for row, person in enumerate(dict.fromkeys(people))}
    count = int(frames.max()) + 1
    if count * len(ids) * len(joints) * 3 > MAX_CELLS:
        raise FormatError(path, f"its times span {count} frames of {len(ids)} people, more than are read; check time_s")
    rows = np.array([ids[person] for person in people])
    place = frames * len(ids) + rows
    if len(np.unique(place)) != len(place):
        twice = int(np.flatnonzero(np.bincount(place)[place] > 1)[0])
        raise FormatError(path, f'person "{people[twice]}" has two rows at {times[twice]:g} s; give one a frame')
    points = np.full((count, len(ids), len(joints), 3), np.nan)
    points[frames, rows] = values.reshape(len(values), -1, 3)
    return scene_of_points(
        path, joints, list(ids), points, rate,
        up=up or stated.get("up"), unit=unit or stated.get("unit"), usual_up="z", named=named,
    )  # fmt: skip


def _comments(lines: list[str]) -> dict[str, str]:
    """The entries of comment lines such as ``# fps: 30``."""
    pairs = (line.removeprefix("#").partition(":") for line in lines if line.startswith("#"))
    return {key.strip().lower(): value.strip() for key, _, value in pairs}


def _stated_rate(stated: Mapping[str, str], path: str | Path) -> float | None:
    if "fps" not in stated:
        return None
    rate = _number(stated["fps"], path, 1)
    if not 1e-3 <= rate <= 1e5:
        raise FormatError(path, f'the comment "fps: {stated["fps"]}" is no frame rate; expected one such as 30')
    return rate


def _cells(lines: list[str], path: str | Path, first: int) -> Iterator[tuple[int, list[str]]]:
    """Line numbers and cells of the lines that are not blank."""
    reader = csv.reader(lines, strict=True)
    try:
        for cells in reader:
            if any(cells):
                yield first + reader.line_num - 1, cells
    except csv.Error as error:
        line = first + reader.line_num
        raise FormatError(path, f"is not a table of comma-separated values ({error})", line) from None


def _joints(header: list[str], path: str | Path, line: int) -> list[str]:
    """Joint names from the columns; each has its x, y, z side by side."""
    if "sample" in header:
        raise FormatError(path, "holds a forecast, not a scene; load the forecast's .npz file", line)
    if "time_s" not in header:
        raise FormatError(path, 'has no column "time_s"; expected time_s,person,JOINT_x,JOINT_y,JOINT_z,...', line)
    columns = [name for name in header if name not in ("time_s", "person")]
    joints = [name[:-2] for name in columns[::3]]
    wanted = [f"{joint}_{axis}" for joint in joints for axis in "xyz"]
    if not joints or columns != wanted or header.count("time_s") + header.count("person") + len(columns) > len(header):
        odd = next((have for have, want in zip(columns, wanted, strict=False) if have != want), "the end")
        raise FormatError(path, f'a joint needs the columns JOINT_x,JOINT_y,JOINT_z; "{odd}" breaks this order', line)
    return joints


def _rows(
    lines: list[str], start: int, header: list[str], path: str | Path
) -> tuple[np.ndarray, list[str], np.ndarray]:
    """Times ``(rows,)``, the person of each row, and the coordinates ``(rows, columns)`` with NaN for blanks."""
    time, person = header.index("time_s"), header.index("person") if "person" in header else None
    columns = [index for index in range(len(header)) if index not in (time, person)]
    times, people, values = [], [], []
    for line, cells in _cells(lines[start + 1 :], path, start + 2):
        if len(cells) != len(header):
            raise FormatError(path, f"{len(cells)} cells; the header has {len(header)}", line)
        times.append(_number(cells[time], path, line))
        people.append(cells[person].strip() if person is not None else Path(path).stem)
        try:
            row = [float(cells[index] or "nan") for index in columns]
        except ValueError:
            row = [_number(cells[index], path, line, blank=True) for index in columns]
        values.append(row)
    if not times:
        raise FormatError(path, "has a header but no rows", start + 1)
    array = np.array(values)
    if np.isinf(array).any():
        raise FormatError(path, "holds an infinite number; leave cells blank where a joint was not observed")
    return np.array(times), people, array


def _number(text: str, path: str | Path, line: int, blank: bool = False) -> float:
    if blank and text.strip().lower() in _BLANK:
        return np.nan
    try:
        value = float(text)
    except ValueError:
        value = np.inf
    if not np.isfinite(value):
        raise FormatError(path, f'"{text[:40]}" where a number with a decimal point was expected', line)
    return value


def _frames(times: NDArray[np.float64], fps: float | None, path: str | Path) -> tuple[np.ndarray, float]:
    """The frame of each row and the frame rate: the given one or that of the times."""
    since = times - times.min()
    moments = np.unique(since)
    steps = moments[1:] - moments[:-1]
    if fps is None:
        if not len(steps):
            raise FormatError(path, 'has one moment only and no frame rate; add the comment "# fps: 30" or give --fps')
        rough = 1 / float(np.median(steps))
        rate = float(np.rint(since.max() * rough)) / float(since.max())  # the long span has the smaller error
        rate = next((nice for nice in (round(rate), round(rate) * 1000 / 1001) if abs(nice - rate) < 1e-4 * rate), rate)
    else:
        rate = fps
    if since.max() * rate > MAX_CELLS:
        raise FormatError(path, f"its times span {since.max():g} s, more than are read; check the column time_s")
    frames = np.rint(since * rate).astype(np.int64)
    if np.abs(since * rate - frames).max() > 0.25:
        raise FormatError(path, f"its times do not lie on a clock of {rate:g} frames a second; resample them")
    return frames, float(rate)


# --- writing ------------------------------------------------------------------------------------------------


def write(scene: Scene, path: str | Path) -> tuple[Path, ...]:
    """Writes a table of all people; blank where not observed, six decimals (micrometres).

    Raises:
        OutputError: If the file cannot be written.
    """
    lines = [*_head(scene), ",".join(_escaped(["time_s", "person", *_columns(scene)]))]
    lines += _body(scene.positions, scene.observed, np.arange(scene.frames) / scene.fps, scene.people, "")
    return _save(lines, path)


def write_forecast(forecast: Forecast, path: str | Path) -> tuple[Path, ...]:
    """Writes a table of all samples of a forecast.

    Raises:
        OutputError: If the file cannot be written.
    """
    columns = ["sample", "weight", "time_s", "person", *_columns(forecast.history)]
    lines = [*_head(forecast.history), ",".join(_escaped(columns))]
    for number, (sample, weight) in enumerate(zip(forecast.samples, forecast.weights, strict=True)):
        everything = np.ones(sample.shape[:3], bool)
        lines += _body(sample, everything, forecast.times_s, forecast.people, f"{number},{weight:.6g},")
    return _save(lines, path)


def _head(scene: Scene) -> list[str]:
    return [f"# fps: {scene.fps!r}", "# up: z", "# unit: m"]


def _columns(scene: Scene) -> list[str]:
    return [f"{joint}_{axis}" for joint in scene.skeleton.names for axis in "xyz"]


def _escaped(cells: list[str]) -> list[str]:
    return [f'"{cell.replace(chr(34), chr(34) * 2)}"' if set(cell) & set(',"\n\r') else cell for cell in cells]


def _body(
    positions: np.ndarray, observed: np.ndarray, times_s: np.ndarray, people: tuple[str, ...], prefix: str
) -> Iterator[str]:
    row = ",".join(["%.6f"] * positions.shape[2] * 3)
    names = _escaped(list(people))
    for frame, time in enumerate(times_s.tolist()):
        for person, name in enumerate(names):
            seen = observed[frame, person]
            if seen.all():
                cells = row % tuple((positions[frame, person] + 0.0).ravel().tolist())
            else:
                points = zip(seen.tolist(), positions[frame, person].tolist(), strict=True)
                cells = ",".join(f"{x:.6f},{y:.6f},{z:.6f}" if there else ",," for there, (x, y, z) in points)
            yield f"{prefix}{time:.6f},{name},{cells}"


def _save(lines: list[str], path: str | Path) -> tuple[Path, ...]:
    with atomic_write(path) as temporary:
        temporary.write_text("\n".join(lines) + "\n", encoding="utf-8", newline="\n")
    return (Path(path),)
