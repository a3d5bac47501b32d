"""Acclaim skeleton (ASF) and motion (AMC) files, the format of CMU's motion capture database.

A bone has a rest direction, a length, an own coordinate frame ``C`` and up to three degrees of freedom ``R``.
Its world orientation is ``W = W_parent C R C^-1`` and its end is ``end_parent + W direction length``; a joint is
named after the bone that ENDS there, so ``lfemur`` is the knee.

Regular AMC files (each frame lists the same bones in the same order) are read by columns; any other file goes
through a line-by-line reader, which also finds the line of an error.
"""

from __future__ import annotations

import warnings
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from motioncast.core.scene import Scene
from motioncast.core.skeleton import Skeleton
from motioncast.core.skeletons import recognise
from motioncast.errors import FormatError
from motioncast.formats.files import read_text

suffixes = (".amc", ".asf")

DEFAULT_FPS = 120.0
"""AMC files carry no frame rate; most of CMU's are 120 Hz."""

INCH = 0.0254


@dataclass(frozen=True, slots=True)
class Acclaim:
    """The skeleton of an ASF file.

    Attributes:
        names: Bones, the root first, each after its parent.
        parents: Index of each bone's parent, -1 for the root.
        directions: Unit rest direction of each bone in the world of the file, ``(bones, 3)``.
        lengths_m: Length of each bone in metres, ``(bones,)``.
        frames: ``C``, the bone's own coordinate frame, ``(bones, 3, 3)``.
        freedoms: The channels of each bone in the order of the motion file, such as ``("rx", "rz")``.
        origin_m: Position of the root at rest, ``(3,)``.
        scale: Metres per unit of length.
        degrees: Whether angles of the motion are in degrees.
    """

    names: tuple[str, ...]
    parents: tuple[int, ...]
    directions: np.ndarray
    lengths_m: np.ndarray
    frames: np.ndarray
    freedoms: tuple[tuple[str, ...], ...]
    origin_m: np.ndarray
    scale: float
    degrees: bool


def read_asf_amc(asf: str | Path, amc: str | Path, fps: float | None = None) -> Scene:
    """One person from a skeleton and a motion file; y up becomes z up.

    Args:
        asf: Skeleton file.
        amc: Motion file.
        fps: Frames a second; the file has none. Default: 120, with a remark.

    Raises:
        FormatError: With the line, if a file is damaged or the two do not belong together.
    """
    skeleton = parse_asf(read_text(asf), asf)
    values = parse_amc(read_text(amc), skeleton, amc)
    remarks = () if fps else (f"{Path(amc).name} names no frame rate; {DEFAULT_FPS:g} a second assumed (--fps)",)
    return scene_of(skeleton, values, fps or DEFAULT_FPS, Path(amc).stem, str(amc), remarks)


def scene_of(
    skeleton: Acclaim,
    values: Mapping[str, np.ndarray],
    fps: float,
    person: str,
    source: str,
    remarks: tuple[str, ...] = (),
) -> Scene:
    """A scene of one person from the values of each bone."""
    joints = joint_skeleton(skeleton)
    x, y, z = np.moveaxis(bone_ends(skeleton, values), -1, 0)
    positions = np.stack([x, -z, y], -1)[:, None]
    return Scene(positions, joints, fps, people=(person,), source=source, remarks=remarks)


def joint_skeleton(skeleton: Acclaim) -> Skeleton:
    """The bone ends as a skeleton of joints."""
    return recognise(skeleton.names, skeleton.parents, "cmu31" if len(skeleton.names) == 31 else "acclaim")


# --- skeleton -----------------------------------------------------------------------------------------------


def parse_asf(text: str, path: str | Path) -> Acclaim:
    """The skeleton in the text of an ASF file.

    Raises:
        FormatError: With the line, if the text is not a whole ASF file.
    """
    sections = _sections(text)
    for needed in ("units", "root", "bonedata", "hierarchy"):
        if needed not in sections:
            raise FormatError(path, f'no section ":{needed}"; expected a whole Acclaim skeleton file')
    units = {words[0]: words[1] for _, words in sections["units"] if len(words) > 1}
    unit = _number(units.get("length", "1"), path, sections["units"][0][0] if sections["units"] else 1)
    if unit <= 0:
        raise FormatError(path, f"the unit of length is {unit:g}; expected a positive number")
    scale = INCH / unit
    root = {words[0].lower(): (line, words[1:]) for line, words in sections["root"]}
    bones = _bones(sections["bonedata"], path)
    parents = _hierarchy(sections["hierarchy"], bones, path)
    names = ("root", *parents)
    for name in bones:
        if name not in parents:
            raise FormatError(path, f'bone "{name}" is not in the hierarchy')
    directions, lengths, frames, freedoms = [np.zeros(3)], [0.0], [_root_frame(root, path)], [_root_order(root, path)]
    for name in parents:
        bone = bones[name]
        direction = bone["direction"]
        directions.append(direction / max(float(np.linalg.norm(direction)), 1e-12))
        lengths.append(float(bone["length"]) * scale)
        frames.append(bone["frame"])
        freedoms.append(bone["dof"])
    line, words = root.get("position", (1, ["0", "0", "0"]))
    origin = np.array([_number(word, path, line) for word in words]) * scale
    return Acclaim(
        names,
        (-1, *(names.index(parent) for parent in parents.values())),
        np.array(directions),
        np.array(lengths),
        np.array(frames),
        tuple(freedoms),
        origin,
        scale,
        units.get("angle", "deg").lower().startswith("deg"),
    )


_Line = tuple[int, list[str]]


def _sections(text: str) -> dict[str, list[_Line]]:
    """Lines, with their numbers and words, under each ``:keyword``."""
    sections: dict[str, list[_Line]] = {}
    current: list[_Line] = []
    for number, line in enumerate(text.splitlines(), 1):
        words = line.partition("#")[0].split()
        if not words:
            continue
        if words[0].startswith(":"):
            current = sections.setdefault(words[0][1:].lower(), [])
        else:
            current.append((number, words))
    return sections


def _number(word: str, path: str | Path, line: int) -> float:
    try:
        value = float(word)
    except ValueError:
        raise FormatError(path, f'"{word}" stands where a number was expected', line) from None
    if not np.isfinite(value):
        raise FormatError(path, f'"{word}" is not a finite number', line)
    return value


def _axes(angles_deg: np.ndarray, order: str) -> np.ndarray:
    """Product of the axis rotations; the first axis of ``order`` acts first."""
    matrix = np.eye(3)
    for axis in order.lower():
        matrix = _turn("xyz".index(axis), np.radians(angles_deg["xyz".index(axis)])) @ matrix
    return matrix


def _turn(axis: int, angle: np.ndarray | float) -> np.ndarray:
    """Rotation matrices ``(..., 3, 3)`` about a coordinate axis."""
    angle = np.asarray(angle)
    matrix = np.zeros((*angle.shape, 3, 3))
    i, j = (axis + 1) % 3, (axis + 2) % 3
    matrix[..., axis, axis] = 1
    matrix[..., i, i] = matrix[..., j, j] = np.cos(angle)
    matrix[..., j, i] = np.sin(angle)
    matrix[..., i, j] = -matrix[..., j, i]
    return matrix


def _frame(words: list[str], path: str | Path, line: int) -> np.ndarray:
    """``C`` from the words of an ``axis`` line."""
    if len(words) != 4 or sorted(words[3].upper()) != ["X", "Y", "Z"]:
        raise FormatError(path, f'axis "{" ".join(words)}"; expected three angles and an order such as XYZ', line)
    return _axes(np.array([_number(word, path, line) for word in words[:3]]), words[3])


def _root_frame(root: dict[str, _Line], path: str | Path) -> np.ndarray:
    line, order = root.get("axis", (1, ["XYZ"]))
    return _frame([*root.get("orientation", (line, ["0", "0", "0"]))[1], *order], path, line)


def _root_order(root: dict[str, _Line], path: str | Path) -> tuple[str, ...]:
    line, order = root.get("order", (1, ["TX", "TY", "TZ", "RX", "RY", "RZ"]))
    return _freedom(order, path, line, ("tx", "ty", "tz", "rx", "ry", "rz"))


def _freedom(words: list[str], path: str | Path, line: int, known: tuple[str, ...]) -> tuple[str, ...]:
    freedom = tuple(word.lower() for word in words)
    if not set(freedom) <= set(known) or len(set(freedom)) != len(freedom):
        raise FormatError(path, f'degrees of freedom "{" ".join(words)}"; expected some of {" ".join(known)}', line)
    return freedom


def _bones(lines: list[_Line], path: str | Path) -> dict[str, dict]:
    """The entries of each bone by its name."""
    bones: dict[str, dict] = {}
    bone: dict = {}
    for line, words in lines:
        key, rest = words[0].lower(), words[1:]
        if key == "begin":
            bone = {"dof": (), "frame": np.eye(3)}
        elif key == "end":
            if not {"name", "direction", "length"} <= set(bone):
                raise FormatError(path, "a bone ends without name, direction or length", line)
            if bone["name"] in bones or bone["name"] == "root":
                raise FormatError(path, f'bone "{bone["name"]}" comes twice; names must be unique', line)
            bones[bone["name"]] = bone
            bone = {}
        elif key == "name" and rest:
            bone["name"] = rest[0]
        elif key == "direction" and len(rest) == 3:
            bone["direction"] = np.array([_number(word, path, line) for word in rest])
        elif key == "length" and len(rest) == 1:
            bone["length"] = _number(rest[0], path, line)
        elif key == "axis":
            bone["frame"] = _frame(rest, path, line)
        elif key == "dof":
            bone["dof"] = _freedom(rest, path, line, ("rx", "ry", "rz"))
        elif key in ("name", "direction", "length"):
            raise FormatError(path, f'"{" ".join(words)}" does not have the expected number of values', line)
    if bone:
        raise FormatError(path, 'the last bone has no "end"; the file seems cut off', lines[-1][0])
    return bones


def _hierarchy(lines: list[_Line], bones: dict[str, dict], path: str | Path) -> dict[str, str]:
    """Parent of each bone, parents before children."""
    parents: dict[str, str] = {}
    for line, words in lines:
        if words[0] in ("begin", "end"):
            continue
        if words[0] != "root" and words[0] not in parents:
            raise FormatError(path, f'"{words[0]}" has children before it has a parent', line)
        for child in words[1:]:
            if child not in bones:
                raise FormatError(path, f'the hierarchy names the bone "{child}", which has no bone data', line)
            if child in parents:
                raise FormatError(path, f'bone "{child}" has two parents', line)
            parents[child] = words[0]
    return parents


# --- motion -------------------------------------------------------------------------------------------------


def parse_amc(text: str, skeleton: Acclaim, path: str | Path) -> dict[str, np.ndarray]:
    """The values of each bone, ``(frames, channels)``, from the text of an AMC file.

    Raises:
        FormatError: With the line, if the text is damaged or does not fit the skeleton.
    """
    lines = text.splitlines()
    start = next((i for i, line in enumerate(lines) if line.strip() and line.lstrip()[0] not in "#:"), len(lines))
    if start == len(lines):
        raise FormatError(path, "no frames; expected a frame number and the values of each bone")
    columns = _by_columns(lines[start:], skeleton)
    return _by_lines(lines, start, skeleton, path) if columns is None else columns


def _by_columns(lines: list[str], skeleton: Acclaim) -> dict[str, np.ndarray] | None:
    """The values where each frame lists the same bones in the same order; None for any other text."""
    names = []
    for line in lines[1:]:
        if line.strip().isdigit():
            break
        names.append(line.partition(" ")[0])
    stride = len(names) + 1
    while lines and not lines[-1].strip():
        lines = lines[:-1]
    if len(set(names)) != len(names) or len(lines) % stride or set(names) != set(_moving(skeleton)):
        return None
    frames = len(lines) // stride
    if not all(map(str.isdigit, map(str.strip, lines[::stride]))):
        return None
    widths = [len(skeleton.freedoms[skeleton.names.index(name)]) for name in names]
    blocks = []
    for row, name in enumerate(names, 1):
        block = "\n" + "\n".join(lines[row::stride])
        numbers = block.replace("\n" + name + " ", "\n")
        if len(block) - len(numbers) != frames * (len(name) + 1):
            return None
        blocks.append(numbers)
    with warnings.catch_warnings():
        warnings.simplefilter("error", DeprecationWarning)
        try:
            table = [np.fromstring(block, sep=" ") for block in blocks]
        except (DeprecationWarning, ValueError):
            return None
    if any(len(flat) != frames * width for flat, width in zip(table, widths, strict=True)):
        return None
    if not all(np.isfinite(flat).all() for flat in table):
        return None
    return {name: flat.reshape(frames, -1) for name, flat in zip(names, table, strict=True)}


def _moving(skeleton: Acclaim) -> list[str]:
    return [name for name, freedom in zip(skeleton.names, skeleton.freedoms, strict=True) if freedom]


def _by_lines(lines: list[str], start: int, skeleton: Acclaim, path: str | Path) -> dict[str, np.ndarray]:
    """The values line by line; bones that a frame leaves out are at rest there, the root never is."""
    widths = {name: len(freedom) for name, freedom in zip(skeleton.names, skeleton.freedoms, strict=True)}
    frames: list[dict[str, list[float]]] = []
    for number, line in enumerate(lines[start:], start + 1):
        words = line.split()
        if not words:
            continue
        if len(words) == 1 and words[0].isdigit():
            if frames and "root" not in frames[-1]:
                raise FormatError(path, 'a frame ends without a "root" line', number)
            frames.append({})
        elif not frames:
            raise FormatError(path, f'"{line.strip()[:40]}" comes before the first frame number', number)
        elif words[0] not in widths:
            raise FormatError(path, f'bone "{words[0][:40]}" is not in the skeleton', number)
        elif len(words) - 1 != widths[words[0]]:
            raise FormatError(
                path, f'bone "{words[0]}" has {len(words) - 1} values; the skeleton gives it {widths[words[0]]}', number
            )
        elif words[0] in frames[-1]:
            raise FormatError(path, f'bone "{words[0]}" comes twice in one frame', number)
        else:
            frames[-1][words[0]] = [_number(word, path, number) for word in words[1:]]
    last = frames[-1]
    if set(frames[0]) - set(last):
        raise FormatError(path, f"the last frame has only {len(last)} bones; the file seems cut off", len(lines))
    return {name: np.array([frame.get(name, [0.0] * widths[name]) for frame in frames]) for name in _moving(skeleton)}


def bone_ends(skeleton: Acclaim, values: Mapping[str, np.ndarray]) -> np.ndarray:
    """World positions of the bone ends in metres, in the axes of the file, ``(frames, bones, 3)`` float64."""
    frames = len(values["root"])
    ends = np.empty((frames, len(skeleton.names), 3))
    orientations: list[np.ndarray] = []
    for bone, name in enumerate(skeleton.names):
        local = np.broadcast_to(np.eye(3), (frames, 3, 3))
        shift = np.zeros((frames, 3))
        for column, freedom in enumerate(skeleton.freedoms[bone]):
            axis, channel = "xyz".index(freedom[1]), values[name][:, column]
            if freedom[0] == "t":
                shift[:, axis] = channel * skeleton.scale
            else:
                local = _turn(axis, np.radians(channel) if skeleton.degrees else channel) @ local
        frame = skeleton.frames[bone]
        parent = skeleton.parents[bone]
        if parent < 0:
            orientations.append(local @ frame)
            ends[:, bone] = skeleton.origin_m + shift
            continue
        turned = orientations[parent]
        if skeleton.freedoms[bone]:
            turned = turned @ (frame @ local @ frame.T)
        orientations.append(turned)
        ends[:, bone] = ends[:, parent] + turned @ (skeleton.directions[bone] * skeleton.lengths_m[bone])
    return ends
