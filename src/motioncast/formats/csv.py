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
from collections.abc import Iterable, Mapping
from pathlib import Path

import numpy as np

from motioncast.core.forecast import Forecast
from motioncast.core.scene import Scene
from motioncast.core.skeletons import grow
from motioncast.errors import FormatError
from motioncast.formats import units
from motioncast.formats.files import atomic_write, read_text

suffixes = (".csv",)

AXES = ("x", "y", "z")
MAX_FRAMES = 10_000_000
"""Most frames that the times of a table may span: a wrong time must not fill the memory."""


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
    times, people, values = _rows(lines, first, header, joints, path)
    rate = fps or _number(stated.get("fps", ""), path) or _rate(times, path)
    place = (times - times.min()) * rate
    frames = np.rint(place).astype(np.int64)
    if np.abs(place - frames).max() > 0.25:
        raise FormatError(path, f"the times do not lie on {rate:g} frames a second; resample them or give --fps")
    count, ids = int(frames.max()) + 1, tuple(dict.fromkeys(people))
    if count * len(ids) > MAX_FRAMES:
        raise FormatError(path, f"the times span {count} frames, more than are read; check time_s and --fps")
    columns = np.array([ids.index(person) for person in people])
    skeleton = grow(joints, Path(path).stem, named)
    order = [joints.index(name) for name in skeleton.names]
    positions = np.full((count, len(ids), len(joints), 3), np.nan)
    positions[frames, columns] = values[:, order]
    observed = np.isfinite(positions).all(-1)
    positions = np.where(observed[..., None], positions, 0)
    world = units.settle(
        path, positions, observed, skeleton,
        up=up or stated.get("up"), unit=unit or stated.get("unit"), usual_up="z",
    )  # fmt: skip
    return Scene(world.points(positions), skeleton, rate, observed, ids, source=str(path), remarks=world.remarks)


def write(scene: Scene, path: str | Path) -> tuple[Path, ...]:
    """Writes a scene as a table: metres, z up.

    Raises:
        OutputError: If it cannot be written.
    """
    times = np.arange(scene.frames) / scene.fps
    rows = (
        [f"{times[frame]:.6g}", person, *_cells(scene.positions[frame, column], scene.observed[frame, column])]
        for frame in range(scene.frames)
        for column, person in enumerate(scene.people)
        if scene.observed[frame, column].any()
    )
    return _write(path, scene.fps, ["time_s", "person", *_columns(scene.skeleton.names)], rows)


def write_forecast(forecast: Forecast, path: str | Path) -> tuple[Path, ...]:
    """Writes all samples of a forecast as a table; times count from the last observed frame.

    Raises:
        OutputError: If it cannot be written.
    """
    seen = np.ones(len(forecast.skeleton), bool)
    rows = (
        [str(number), f"{forecast.weights[number]:.6g}", f"{time:.6g}", person, *_cells(sample[frame, column], seen)]
        for number, sample in enumerate(forecast.samples)
        for frame, time in enumerate(forecast.times_s)
        for column, person in enumerate(forecast.people)
    )
    header = ["sample", "weight", "time_s", "person", *_columns(forecast.skeleton.names)]
    return _write(path, forecast.fps, header, rows)


def _write(path: str | Path, fps: float, header: list[str], rows: Iterable[list[str]]) -> tuple[Path, ...]:
    with atomic_write(path) as temporary, temporary.open("w", encoding="utf-8", newline="") as file:
        file.write(f"# fps: {fps:.10g}\n# up: z\n# unit: m\n")
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(header)
        writer.writerows(rows)
    return (Path(path),)


def _columns(names: Iterable[str]) -> list[str]:
    return [f"{name}_{axis}" for name in names for axis in AXES]


def _cells(pose: np.ndarray, seen: np.ndarray) -> list[str]:
    """The cells of one person in one frame, to a hundredth of a millimetre."""
    return [f"{value:.5f}" if known else "" for joint, known in zip(pose, seen, strict=True) for value in joint]


def _comments(lines: list[str]) -> dict[str, str]:
    """What the comment lines state: ``# fps: 30``."""
    stated = {}
    for line in lines:
        if line.startswith("#") and ":" in line:
            name, _, value = line[1:].partition(":")
            stated[name.strip().lower()] = value.strip()
    return stated


def _joints(header: list[str], path: str | Path, line: int) -> list[str]:
    """Joint names of the columns, each with its three axes side by side."""
    if "time_s" not in header:
        raise FormatError(path, f'the header "{",".join(header)[:60]}" has no column time_s', line)
    if "sample" in header:
        raise FormatError(path, "holds a forecast, not a scene; forecast files are read as .npz", line)
    columns = [name for name in header if name not in ("time_s", "person")]
    joints = [name[:-2] for name in columns[::3]]
    if columns != _columns(joints) or not joints:
        raise FormatError(path, "expected three columns a joint, JOINT_x, JOINT_y and JOINT_z, side by side", line)
    if len(set(joints)) != len(joints):
        raise FormatError(path, "two joints have one name", line)
    return joints


def _rows(
    lines: list[str], first: int, header: list[str], joints: list[str], path: str | Path
) -> tuple[np.ndarray, list[str], np.ndarray]:
    """Times ``(rows,)``, people, and positions ``(rows, joints, 3)`` with NaN for empty cells."""
    time, person = header.index("time_s"), header.index("person") if "person" in header else None
    cells = [column for column in range(len(header)) if column not in (time, person)]
    times, people, values = [], [], []
    seen: set[tuple[str, str]] = set()
    for number, line in enumerate(lines[first + 1 :], first + 2):
        if not line.strip() or line.startswith("#"):
            continue
        try:
            row = next(csv.reader([line], strict=True))
        except (csv.Error, StopIteration) as error:
            raise FormatError(path, f"is no row of a table ({error})", number) from None
        if len(row) != len(header):
            raise FormatError(path, f"{len(row)} cells; the header has {len(header)}", number)
        who = row[person].strip() if person is not None else Path(path).stem
        if (row[time], who) in seen:
            raise FormatError(path, f'"{who}" has a second row at {row[time]} s', number)
        seen.add((row[time], who))
        try:
            times.append(float(row[time]))
            values.append([float(row[cell]) if row[cell].strip() else np.nan for cell in cells])
        except ValueError as error:
            raise FormatError(path, f"{error}; expected a number", number) from None
        if not np.isfinite(times[-1]):
            raise FormatError(path, f'time "{row[time]}" is not a finite number', number)
        people.append(who)
    if not times:
        raise FormatError(path, "has a header and no rows")
    return np.array(times), people, np.array(values).reshape(len(times), len(joints), 3)


def _number(text: str, path: str | Path) -> float | None:
    if not text:
        return None
    try:
        value = float(text)
    except ValueError:
        value = 0.0
    if not 0 < value < 1e6:
        raise FormatError(path, f'states "{text}" frames a second; expected a positive number')
    return value


def _rate(times: np.ndarray, path: str | Path) -> float:
    """Frame rate from the times: a whole number where they lie close to one."""
    moments = np.unique(times)
    if len(moments) < 2:
        raise FormatError(path, "has one frame and states no rate; give it by --fps")
    rate = 1 / float(np.median(np.diff(moments)))
    return float(round(rate)) if abs(rate - round(rate)) < 0.02 * rate and round(rate) else rate
