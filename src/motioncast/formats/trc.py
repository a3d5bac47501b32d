"""TRC tables of markers or joint centres, as OpenSim and motion capture programs write them; one person a file.

Three header lines (``PathFileType``, names and values of the entries), two lines of column titles, then a row a
frame with frame number, time and three numbers a marker. Markers that are named like joints are recognised;
an empty cell means not observed. Files are y up by custom; they state their unit.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np

from motioncast.core.scene import Scene
from motioncast.core.skeletons import grow
from motioncast.errors import FormatError, SceneError
from motioncast.formats import units
from motioncast.formats.files import atomic_write, read_text

suffixes = (".trc",)


def sniff(head: bytes) -> bool:
    """Whether a file that begins so is a TRC table."""
    return head.lstrip(b"\xef\xbb\xbf").startswith(b"PathFileType")


def read(
    path: str | Path,
    *,
    up: str | None = None,
    unit: str | None = None,
    fps: float | None = None,
    named: Mapping[str, str] | None = None,
) -> Scene:
    """The person of a TRC file.

    Args:
        path: The file.
        up: Axis that points up; else inferred from the body.
        unit: Unit of length instead of the file's.
        fps: Frame rate to believe instead of the file's.
        named: Landmarks by marker name, over the recognised ones.

    Raises:
        FormatError: With the line, if the file is damaged.
        SceneError: If the unit makes no person of the body.
    """
    lines = read_text(path).split("\n")
    if len(lines) < 6 or not lines[0].startswith("PathFileType"):
        raise FormatError(path, "no TRC header; expected PathFileType and five more lines", 1)
    entries = dict(zip(lines[1].split(), lines[2].split(), strict=False))
    rate = fps or _positive(entries.get("DataRate", ""), "DataRate", path)
    titles = [title.strip() for title in lines[3].rstrip().split("\t")]
    markers = [title for title in titles[2:] if title]
    if titles[:1] != ["Frame#"] or not markers:
        raise FormatError(path, "no marker names; expected Frame#, Time and a name over every third column", 4)
    if len(set(markers)) != len(markers):
        raise FormatError(path, "two markers have one name", 4)
    rows = [
        _row(line.rstrip("\r"), len(markers), path, number)
        for number, line in enumerate(lines[5:], 6)
        if line.strip()
    ]
    if not rows:
        raise FormatError(path, "has a header and no frames", len(lines))
    skeleton = grow(markers, Path(path).stem, named)
    values = np.array(rows).reshape(len(rows), 1, len(markers), 3)
    values = values[:, :, [markers.index(name) for name in skeleton.names]]
    observed = np.isfinite(values).all(-1)
    values = np.where(observed[..., None], values, 0)
    stated = unit or entries.get("Units")
    world = units.settle(path, values, observed, skeleton, up=up, unit=stated, usual_up="y")
    return Scene(
        world.points(values), skeleton, rate, observed, (Path(path).stem,), source=str(path), remarks=world.remarks
    )


def write(scene: Scene, path: str | Path) -> tuple[Path, ...]:
    """Writes a TRC file a person: millimetres, y up; several people's files have their id in the name.

    Raises:
        OutputError: If a file cannot be written.
        SceneError: If the scene has no people.
    """
    if not scene.people:
        raise SceneError("the scene has no people; there is nothing to write")
    path = Path(path)
    files = []
    for column, person in enumerate(scene.people):
        name = "".join(letter if letter.isalnum() or letter in "-_" else "_" for letter in person)
        file = path if len(scene.people) == 1 else path.with_name(f"{path.stem}.{name}{path.suffix}")
        with atomic_write(file) as temporary:
            temporary.write_text(_table(scene, column, file.name), encoding="utf-8", newline="\n")
        files.append(file)
    return tuple(files)


def _table(scene: Scene, column: int, name: str) -> str:
    joints = scene.skeleton.names
    values = np.stack([scene.positions[..., 0], scene.positions[..., 2], -scene.positions[..., 1]], -1) * 1000
    head = [
        f"PathFileType\t4\t(X/Y/Z)\t{name}",
        "DataRate\tCameraRate\tNumFrames\tNumMarkers\tUnits\tOrigDataRate\tOrigDataStartFrame\tOrigNumFrames",
        f"{scene.fps:g}\t{scene.fps:g}\t{scene.frames}\t{len(joints)}\tmm\t{scene.fps:g}\t1\t{scene.frames}",
        "Frame#\tTime\t" + "\t\t\t".join(joints) + "\t\t",
        "\t\t" + "\t".join(f"X{number}\tY{number}\tZ{number}" for number in range(1, len(joints) + 1)),
        "",
    ]
    for frame in range(scene.frames):
        seen = scene.observed[frame, column]
        cells = [
            f"{value:.3f}" if known else ""
            for joint, known in zip(values[frame, column], seen, strict=True)
            for value in joint
        ]
        head.append("\t".join([str(frame + 1), f"{frame / scene.fps:.6f}", *cells]))
    return "\n".join(head) + "\n"


def _positive(text: str, name: str, path: str | Path) -> float:
    try:
        value = float(text)
    except ValueError:
        value = 0.0
    if not 0 < value < 1e6:
        raise FormatError(path, f'{name} is "{text}"; expected a positive number (override with --fps)', 3)
    return value


def _row(line: str, markers: int, path: str | Path, number: int) -> list[float]:
    """The coordinates of one frame; NaN for empty cells."""
    cells = line.split("\t")[2 : 2 + 3 * markers]
    cells += [""] * (3 * markers - len(cells))  # programs leave out empty cells at the end of a row
    try:
        return [float(cell) if cell.strip() else np.nan for cell in cells]
    except ValueError as error:
        raise FormatError(path, f"{error}; expected a number", number) from None
