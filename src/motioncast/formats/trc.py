"""TRC, the marker files of OpenSim: tab-separated, five lines of header, one person a file.

The header states rate and unit, not the up axis, which is y in OpenSim's world; it is inferred where the body tells.
Blank cells are markers that were not observed.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np

from motioncast.core.scene import Scene
from motioncast.errors import FormatError
from motioncast.formats import units
from motioncast.formats.files import atomic_write, person_paths, read_text
from motioncast.formats.points import scene_of_points

suffixes = (".trc",)


def sniff(head: bytes) -> bool:
    """Whether a file that begins so is TRC."""
    return head.removeprefix(b"\xef\xbb\xbf").lstrip().startswith(b"PathFileType")


def read(
    path: str | Path,
    *,
    up: str | None = None,
    unit: str | None = None,
    fps: float | None = None,
    named: Mapping[str, str] | None = None,
) -> Scene:
    """The markers of one person.

    Args:
        path: The file.
        up: Axis that points up in the file; inferred where not given.
        unit: Unit of length to believe instead of the header's.
        fps: Frame rate to believe instead of the header's.
        named: Landmarks by marker name, over the recognised ones.

    Raises:
        FormatError: With the line, if the file is damaged.
        SceneError: If the unit makes no person of the body.
    """
    lines = read_text(path).split("\n")
    if len(lines) < 6 or not lines[0].lstrip().startswith("PathFileType"):
        raise FormatError(path, 'does not begin with "PathFileType" and a header of five lines; is it a TRC file?', 1)
    header = dict(zip(lines[1].split(), lines[2].split(), strict=False))
    for entry in ("DataRate", "NumFrames", "NumMarkers", "Units"):
        if entry not in header:
            raise FormatError(path, f'the header has no value for "{entry}"', 3)
    rate = _number(header["DataRate"], path, 3)
    frames, markers = _count(header["NumFrames"], path), _count(header["NumMarkers"], path)
    if not 1e-3 <= rate <= 1e5:
        raise FormatError(path, f"the data rate is {rate:g} a second; expected one such as 100", 3)
    names = [name.strip() for name in lines[3].split("\t")[2:] if name.strip()]
    if len(names) != markers:
        raise FormatError(path, f"names {len(names)} markers; the header declares {markers}", 4)
    rows = [index for index in range(5, len(lines)) if lines[index].strip()]
    if len(rows) != frames or not frames:
        raise FormatError(path, f"declares {frames} frames but has {len(rows)}; the file seems cut off", 3)
    points = np.array([_row(lines[index], markers, path, index + 1) for index in rows]).reshape(frames, 1, markers, 3)
    return scene_of_points(
        path, names, [Path(path).stem], points, fps or rate,
        up=up, unit=unit or header["Units"], usual_up="y", named=named,
    )  # fmt: skip


def _row(line: str, markers: int, path: str | Path, number: int) -> list[float]:
    cells = line.split("\t") if "\t" in line else line.split()
    while len(cells) > 2 + 3 * markers and not cells[-1].strip():
        cells.pop()
    if len(cells) > 2 + 3 * markers:
        raise FormatError(path, f"{len(cells)} cells; expected frame, time and {3 * markers} coordinates", number)
    cells += [""] * (2 + 3 * markers - len(cells))  # editors strip blanks at the end of a line
    return [_number(cell, path, number, blank=True) for cell in cells[2:]]


def _number(text: str, path: str | Path, line: int, blank: bool = False) -> float:
    if blank and text.strip().lower() in ("", "nan"):
        return np.nan
    try:
        value = float(text)
    except ValueError:
        value = np.inf
    if not np.isfinite(value):
        raise FormatError(path, f'"{text[:40]}" where a finite number was expected', line)
    return value


def _count(text: str, path: str | Path) -> int:
    if not (text.isascii() and text.isdigit() and len(text) < 10):
        raise FormatError(path, f'"{text[:40]}" where a number of frames or markers was expected', 3)
    return int(text)


def write(scene: Scene, path: str | Path) -> tuple[Path, ...]:
    """Writes one file a person, y up, in metres, six decimals; blank where not observed.

    Raises:
        OutputError: If a file cannot be written.
    """
    turned = units.World(units.axis_turn("y").T, 1.0).points(scene.positions.astype(np.float64)) + 0.0
    targets = person_paths(path, scene.people)
    for person, target in enumerate(targets):
        text = _text(scene, turned[:, person], scene.observed[:, person], target.name)
        with atomic_write(target) as temporary:
            temporary.write_text(text, encoding="utf-8", newline="\n")
    return targets


def _text(scene: Scene, points: np.ndarray, observed: np.ndarray, name: str) -> str:
    names, rate = scene.skeleton.names, f"{scene.fps:.12g}"
    axes = [f"{axis}{number}" for number in range(1, len(names) + 1) for axis in "XYZ"]
    lines = [
        f"PathFileType\t4\t(X/Y/Z)\t{name}",
        "DataRate\tCameraRate\tNumFrames\tNumMarkers\tUnits\tOrigDataRate\tOrigDataStartFrame\tOrigNumFrames",
        f"{rate}\t{rate}\t{scene.frames}\t{len(names)}\tm\t{rate}\t1\t{scene.frames}",
        "Frame#\tTime\t" + "\t".join(f"{marker}\t\t" for marker in names),
        "\t\t" + "\t".join(axes),
    ]
    for frame in range(scene.frames):
        cells = [
            "\t".join(f"{value:.6f}" for value in point) if seen else "\t\t"
            for point, seen in zip(points[frame].tolist(), observed[frame].tolist(), strict=True)
        ]
        lines.append("\t".join([str(frame + 1), f"{frame / scene.fps:.6f}", *cells]))
    return "\n".join(lines) + "\n"
