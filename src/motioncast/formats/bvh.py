"""BVH (Biovision hierarchy): a skeleton with rest offsets, and a row of channel values a frame.

Reading is strict and names the line of an error. What the format leaves open is read as follows:

- A joint's rotation channels are multiplied in the order in which they are listed (``Zrotation Xrotation
  Yrotation`` is Rz Rx Ry) and turn the joint's children.
- Position channels take the place of the joint's OFFSET, as Blender does; most roots have the OFFSET 0 0 0.
- An End Site becomes a joint named ``PARENT_end``, unless it lies in its parent (OFFSET 0 0 0).
- The file states neither up axis nor unit: both are inferred (``units``), both can be given.

Joints that slide (``core.kinematics``) are written with position channels of their own, which Blender follows.
Written files are y up, in centimetres, in the channel order Z X Y, one person a file.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from decimal import Decimal
from pathlib import Path

import numpy as np

from motioncast.core import rotation
from motioncast.core.kinematics import local_places, sliding
from motioncast.core.scene import Scene
from motioncast.core.skeleton import Skeleton
from motioncast.core.skeletons import recognise
from motioncast.errors import FormatError, SceneError
from motioncast.formats import units
from motioncast.formats.files import atomic_write, person_paths, read_text

suffixes = (".bvh",)

MAX_JOINTS = 2000
"""Most joints of one file."""

MAX_NUMBER = 1e12
"""No coordinate or angle reaches this; what does is taken for damage."""

_CHANNEL = {f"{axis}{kind}".lower(): (kind[0], axis) for axis in "XYZ" for kind in ("position", "rotation")}
_SLIDE_M = 1e-3
_WRITTEN_ORDER = "zxy"


def sniff(head: bytes) -> bool:
    """Whether a file that begins so is BVH."""
    return head.removeprefix(b"\xef\xbb\xbf").lstrip()[:9].upper() == b"HIERARCHY"


@dataclass(slots=True)
class _Joint:
    name: str
    parent: int
    line: int
    end: bool = False
    offset: np.ndarray | None = None
    channels: list[tuple[str, str]] = field(default_factory=list)
    first_column: int = 0

    def columns(self, kind: str) -> tuple[str, list[int]]:
        """Axes and columns of the position ("p") or rotation ("r") channels, in the file's order."""
        found = [(axis, self.first_column + i) for i, (what, axis) in enumerate(self.channels) if what == kind]
        return "".join(axis for axis, _ in found), [column for _, column in found]


def read(
    path: str | Path,
    *,
    up: str | None = None,
    unit: str | None = None,
    fps: float | None = None,
    named: Mapping[str, str] | None = None,
) -> Scene:
    """One person with rotations and rest offsets.

    Args:
        path: The file.
        up: Axis that points up in the file; inferred where not given.
        unit: Unit of length of the file; inferred where not given.
        fps: Frame rate to believe instead of the file's frame time.
        named: Landmarks by joint name, over the recognised ones.

    Raises:
        FormatError: With the line, if the file is damaged.
        SceneError: If no unit makes a person of the body.
    """
    lines = read_text(path).split("\n")
    joints, start = _hierarchy(lines, path)
    header_fps, values = _motion(lines, start, sum(len(joint.channels) for joint in joints), path)
    skeleton = recognise([joint.name for joint in joints], [joint.parent for joint in joints], "bvh", named)
    offsets = np.array([joint.offset for joint in joints])
    rotations, places = _local(joints, values, offsets)
    positions = _forward(skeleton.parents, rotations, places)
    slides = _sliding(skeleton, places)
    rest = _forward(skeleton.parents, np.broadcast_to(rotation.IDENTITY, (1, len(joints), 4)), offsets[None])[0]
    seen = np.ones((len(values), 1, len(joints)), bool)
    world = units.settle(path, positions[:, None], seen, skeleton, up=up, unit=unit, usual_up="y", rest=rest)
    slide = 0.0 if not slides else float(np.ptp(places[:, slides], axis=0).max()) * world.scale
    remarks = (*world.remarks, *_thorax_remark(skeleton, offsets, path))
    rigid = slide < _SLIDE_M
    if not rigid:
        names = ", ".join(skeleton.names[joint] for joint in slides[:3])
        remarks += (f"{Path(path).name}: bones change their length (at {names}); its rotations are left out",)
    roots = np.array(skeleton.parents) < 0
    rigid_offsets = np.where(roots[:, None], 0, places.mean(0))
    return Scene(
        world.points(positions)[:, None],
        skeleton,
        header_fps if fps is None else fps,
        people=(Path(path).stem,),
        rotations=world.rotations(rotations).astype(np.float32)[:, None] if rigid else None,
        offsets=world.points(rigid_offsets).astype(np.float32)[None] if rigid else None,
        source=str(path),
        remarks=remarks,
    )


# --- hierarchy ----------------------------------------------------------------------------------------------


def _hierarchy(lines: list[str], path: str | Path) -> tuple[list[_Joint], int]:
    """The joints, parents first, and the index of the line ``MOTION``."""
    joints: list[_Joint] = []
    open_joints: list[int] = []
    expect = "HIERARCHY"  # then a joint, "{" after its name, or anything that may stand inside a joint
    columns = 0
    for number, line in enumerate(lines, 1):
        words = line.split()
        if not words:
            continue
        key = words[0].upper()
        if expect == "HIERARCHY":
            if key != "HIERARCHY":
                raise FormatError(
                    path, f'"{line.strip()[:40]}" where "HIERARCHY" was expected; is it a BVH file?', number
                )
            expect = "joint"
        elif expect == "{":
            if words != ["{"]:
                raise FormatError(path, f'"{line.strip()[:40]}" where "{{" was expected', number)
            expect = "joint"
        elif key == "MOTION":
            if open_joints:
                raise FormatError(path, f'MOTION, but joint "{joints[open_joints[-1]].name}" has no "}}" yet', number)
            if not joints:
                raise FormatError(path, "MOTION, but the hierarchy has no joints", number)
            return _named_ends(joints), number - 1
        elif key in ("ROOT", "JOINT", "END"):
            joints.append(_opened(joints, open_joints, key, words, path, number))
            open_joints.append(len(joints) - 1)
            opening = words[-1] == "{" and len(words) > 2
            expect = "joint" if opening else "{"
        elif not open_joints:
            raise FormatError(path, f'"{line.strip()[:40]}" where ROOT or MOTION was expected', number)
        elif key == "OFFSET":
            joints[open_joints[-1]].offset = _offset(words, path, number)
        elif key == "CHANNELS":
            joint = joints[open_joints[-1]]
            joint.channels = _channels(joint, words, path, number)
            joint.first_column = columns
            columns += len(joint.channels)
        elif words == ["}"]:
            joint = joints[open_joints.pop()]
            if joint.offset is None:
                raise FormatError(path, f'joint "{joint.name}" has no OFFSET', joint.line)
        else:
            raise FormatError(
                path, f'"{line.strip()[:40]}" where OFFSET, CHANNELS, JOINT, End Site or "}}" was expected', number
            )
    raise FormatError(path, 'the file ends before "MOTION"; it seems cut off', len(lines))


def _opened(
    joints: list[_Joint], open_joints: list[int], key: str, words: list[str], path: str | Path, line: int
) -> _Joint:
    name = " ".join(word for word in words[1:] if word != "{")
    if (key == "ROOT") == bool(open_joints):
        where = "inside a joint" if open_joints else "outside of a joint"
        raise FormatError(path, f'"{" ".join(words)[:40]}" stands {where}', line)
    parent = open_joints[-1] if open_joints else -1
    if parent >= 0 and joints[parent].end:
        raise FormatError(path, "an End Site has no children", line)
    if len(joints) >= MAX_JOINTS:
        raise FormatError(path, f"has more than {MAX_JOINTS} joints; is it a motion file?", line)
    if key == "END":
        return _Joint("", parent, line, end=True)
    if not name:
        raise FormatError(path, f"{key} has no name", line)
    if any(joint.name == name for joint in joints):
        raise FormatError(path, f'the joint "{name}" comes twice; names must be unique', line)
    return _Joint(name, parent, line)


def _named_ends(joints: list[_Joint]) -> list[_Joint]:
    """The joints without End Sites that lie in their parents; the others get their names."""
    taken = {joint.name for joint in joints}
    kept: list[_Joint] = []
    place: dict[int, int] = {-1: -1}
    for index, joint in enumerate(joints):
        if joint.end and joint.offset is not None and not joint.offset.any():
            continue
        if joint.end:
            joint.name = f"{joints[joint.parent].name}_end"
            while joint.name in taken:
                joint.name += "_end"
            taken.add(joint.name)
        place[index] = len(kept)
        joint.parent = place[joint.parent]
        kept.append(joint)
    return kept


def _number(word: str, path: str | Path, line: int) -> float:
    try:
        value = float(word) if word.isascii() and "_" not in word else np.nan
    except ValueError:
        value = np.nan
    if not abs(value) < MAX_NUMBER:
        raise FormatError(path, f'"{word[:40]}" where a finite number was expected', line)
    return value


def _offset(words: list[str], path: str | Path, line: int) -> np.ndarray:
    if len(words) != 4:
        raise FormatError(path, f"OFFSET has {len(words) - 1} values; expected 3", line)
    return np.array([_number(word, path, line) for word in words[1:]])


def _channels(joint: _Joint, words: list[str], path: str | Path, line: int) -> list[tuple[str, str]]:
    names = [word.lower() for word in words[2:]]
    if joint.end or joint.channels:
        raise FormatError(path, "CHANNELS in an End Site or a second time in a joint", line)
    if len(words) < 2 or words[1] != str(len(names)):
        raise FormatError(path, f"CHANNELS declares {' '.join(words[1:2])} channels but names {len(names)}", line)
    if not set(names) <= set(_CHANNEL) or len(set(names)) != len(names):
        raise FormatError(path, f'CHANNELS names "{" ".join(words[2:])[:80]}"; expected Xposition ... Zrotation', line)
    return [_CHANNEL[name] for name in names]


# --- motion -------------------------------------------------------------------------------------------------


def _motion(lines: list[str], start: int, columns: int, path: str | Path) -> tuple[float, np.ndarray]:
    """Frames a second and the channel values ``(frames, columns)``; ``start`` is the index of ``MOTION``."""
    filled = [index for index in range(start + 1, len(lines)) if lines[index].strip()]
    if len(filled) < 2:
        raise FormatError(path, 'the file ends before "Frames:" and "Frame Time:"; it seems cut off', len(lines))
    frames_line, time_line = filled[0], filled[1]
    declared = re.fullmatch(r"\s*Frames\s*:\s*(\d{1,18})\s*", lines[frames_line], re.IGNORECASE | re.ASCII)
    if declared is None:
        raise FormatError(path, f'"{lines[frames_line].strip()[:40]}" where "Frames: N" was expected', frames_line + 1)
    interval = re.fullmatch(r"\s*Frame\s+Time\s*:\s*(\S+)\s*", lines[time_line], re.IGNORECASE)
    if interval is None:
        raise FormatError(
            path, f'"{lines[time_line].strip()[:40]}" where "Frame Time: seconds" was expected', time_line + 1
        )
    seconds = _number(interval[1], path, time_line + 1)
    if not 1e-5 <= seconds <= 100:
        raise FormatError(path, f"the frame time is {seconds:g} s; expected something like 0.0083333", time_line + 1)
    rows = filled[2:]
    count = int(declared[1])
    if count == 0 or columns == 0:
        raise FormatError(path, f"has {count} frames of {columns} channels; expected at least one", frames_line + 1)
    if len(rows) != count:
        advice = "the file seems cut off" if len(rows) < count else "lines were added or the number is wrong"
        raise FormatError(path, f"declares {count} frames but has {len(rows)}; {advice}", frames_line + 1)
    try:
        values = np.loadtxt([lines[row] for row in rows], np.float64, comments=None, ndmin=2)
    except ValueError:
        values = None
    if values is None or values.shape != (count, columns) or not (np.abs(values) < MAX_NUMBER).all():
        _find_bad_row(lines, rows, columns, path)
    assert values is not None
    return _rate(interval[1], seconds), values


def _find_bad_row(lines: list[str], rows: list[int], columns: int, path: str | Path) -> None:
    """Raises the error of the first row that is not a row of numbers."""
    for row in rows:
        words = lines[row].split()
        if len(words) != columns:
            raise FormatError(path, f"{len(words)} values in a frame; the hierarchy has {columns} channels", row + 1)
        for word in words:
            _number(word, path, row + 1)


def _rate(text: str, seconds: float) -> float:
    """Frames a second: a whole or a broadcast rate (30000 / 1001) where the printed digits allow it.

    Example:
        >>> _rate("0.0333333", 0.0333333), round(_rate("0.033367", 0.033367), 3), _rate("0.0125", 0.0125)
        (30.0, 29.97, 80.0)
    """
    exponent = Decimal(text).as_tuple().exponent
    rounding = 0.5 * 10.0 ** (exponent if isinstance(exponent, int) else 0)
    whole = max(1, round(1 / seconds))
    for rate in (float(whole), whole * 1000 / 1001):
        if abs(1 / rate - seconds) <= min(rounding, 0.01 * seconds):
            return rate
    return 1 / seconds


# --- channels to positions ----------------------------------------------------------------------------------


def _local(joints: list[_Joint], values: np.ndarray, offsets: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Local rotations ``(frames, joints, 4)`` and places in the parent's frame ``(frames, joints, 3)``."""
    rotations = np.broadcast_to(rotation.IDENTITY, (len(values), len(joints), 4)).copy()
    places = np.broadcast_to(offsets, (len(values), len(joints), 3)).copy()
    by_order: dict[str, list[int]] = {}
    for index, joint in enumerate(joints):
        order, _ = joint.columns("r")
        by_order.setdefault(order, []).append(index)
        for axis, column in zip(*joint.columns("p"), strict=True):
            places[:, index, "XYZ".index(axis)] = values[:, column]
    for order, members in by_order.items():
        columns = np.array([joints[index].columns("r")[1] for index in members], int)
        if order:
            rotations[:, members] = rotation.from_euler(np.radians(values[:, columns]), order)
    return rotations, places


def _forward(parents: tuple[int, ...], rotations: np.ndarray, places: np.ndarray) -> np.ndarray:
    """World positions ``(frames, joints, 3)``."""
    positions, world = np.empty_like(places), np.empty_like(rotations)
    for joint, parent in enumerate(parents):
        if parent < 0:
            positions[:, joint], world[:, joint] = places[:, joint], rotations[:, joint]
        else:
            positions[:, joint] = positions[:, parent] + rotation.rotate(world[:, parent], places[:, joint])
            world[:, joint] = rotation.multiply(world[:, parent], rotations[:, joint])
    return positions


def _sliding(skeleton: Skeleton, places: np.ndarray) -> list[int]:
    """Joints other than roots whose place in their parent's frame changes."""
    return [
        joint for joint, parent in enumerate(skeleton.parents) if parent >= 0 and np.ptp(places[:, joint], axis=0).any()
    ]


def _thorax_remark(skeleton: Skeleton, offsets: np.ndarray, path: str | Path) -> tuple[str, ...]:
    """CMU's takes as BVH by cgspeed lack two bones; who measures on them should know."""
    if not {"LHipJoint", "LowerBack", "Neck1", "LThumb"} <= set(skeleton.names):
        return ()
    if "Neck" not in skeleton.names or offsets[skeleton.index("Neck")].any():
        return ()
    return (
        f"{Path(path).name}: this conversion of CMU's data leaves out the thorax and both wrist bones, so head and "
        "arms sit about 11 cm too low and hands are 6 to 10 cm short",
    )


# --- writing ------------------------------------------------------------------------------------------------


def write(scene: Scene, path: str | Path) -> tuple[Path, ...]:
    """Writes one file a person: ``path`` itself, or with the person's id in the name where there are several.

    The clock stays that of the scene: before a person appears, his first pose stands; in gaps the last pose seen
    is held; after his last frame the file ends.

    Raises:
        SceneError: If the scene has no rotations (``core.kinematics.fit_rotations`` finds them).
        OutputError: If a file cannot be written.
    """
    if scene.rotations is None or scene.offsets is None:
        raise SceneError("the scene has joint positions only; fit rotations before it is written as BVH")
    targets = person_paths(path, scene.people)
    texts = [_text(scene, person) for person in range(len(targets))]
    for target, text in zip(targets, texts, strict=True):
        with atomic_write(target) as temporary:
            temporary.write_text(text, encoding="utf-8", newline="\n")
    return targets


def _text(scene: Scene, person: int) -> str:
    assert scene.rotations is not None
    assert scene.offsets is not None
    skeleton = scene.skeleton
    world = units.World(units.axis_turn("y").T, 1 / units.UNITS_M["cm"])
    roots = [joint for joint, parent in enumerate(skeleton.parents) if parent < 0]
    frames = _held(np.all(scene.observed[:, person][:, roots], -1))
    if not len(frames):
        raise SceneError(f'person "{scene.people[person]}" is never seen; there is no motion to write')
    offsets = np.where(np.isin(np.arange(len(skeleton)), roots)[:, None], 0, world.points(scene.offsets[person]))
    lines, order = ["HIERARCHY"], []
    places = local_places(scene)
    placed = sliding(scene, places)
    placed[roots] = True
    for root in roots:
        _write_tree(skeleton, offsets, root, placed, lines, order)
    quaternions = world.rotations(scene.rotations[frames, person].astype(np.float64))
    angles = np.degrees(np.unwrap(rotation.to_euler(quaternions, _WRITTEN_ORDER), axis=0))
    positions = world.points(places[frames, person])
    blocks = [
        np.concatenate([positions[:, joint], angles[:, joint]], 1) if placed[joint] else angles[:, joint]
        for joint in order
    ]
    rows = np.concatenate(blocks, 1) + 0.0
    lines += ["MOTION", f"Frames: {len(frames)}", f"Frame Time: {1 / scene.fps:.12f}"]
    template = " ".join(["%.6f"] * rows.shape[1])
    lines += [template % tuple(row) for row in rows.tolist()]
    return "\n".join(lines) + "\n"


def _held(seen: np.ndarray) -> np.ndarray:
    """For each frame up to the last seen one, the frame whose pose stands there."""
    known = np.flatnonzero(seen)
    if not len(known):
        return known
    frames = np.arange(known[-1] + 1)
    return np.maximum(np.maximum.accumulate(np.where(seen[: len(frames)], frames, -1)), known[0])


def _write_tree(
    skeleton: Skeleton, offsets: np.ndarray, root: int, placed: np.ndarray, lines: list[str], order: list[int]
) -> None:
    """Appends the block of a root and its children; ``order`` collects the joints that have channels."""
    stack: list[tuple[int | None, int]] = [(root, 0)]
    while stack:
        current, level = stack.pop()
        indent = "\t" * level
        if current is None:
            lines.append(f"{indent}}}")
            continue
        children = [child for child, parent in enumerate(skeleton.parents) if parent == current]
        offset = " ".join(f"{value + 0.0:.6f}" for value in offsets[current].tolist())
        parent = skeleton.parents[current]
        if not children and _is_end(skeleton, current) and not placed[current]:
            lines += [f"{indent}End Site", f"{indent}{{", f"{indent}\tOFFSET {offset}", f"{indent}}}"]
            continue
        order.append(current)
        positions = "6 Xposition Yposition Zposition" if placed[current] else "3"
        name = re.sub(r"\s+", "_", skeleton.names[current])
        lines += [
            f"{indent}{'ROOT' if parent < 0 else 'JOINT'} {name}",
            f"{indent}{{",
            f"{indent}\tOFFSET {offset}",
            f"{indent}\tCHANNELS {positions} Zrotation Xrotation Yrotation",
        ]
        if not children:
            inner = indent + "\t"
            lines += [f"{inner}End Site", f"{inner}{{", f"{inner}\tOFFSET 0.000000 0.000000 0.000000", f"{inner}}}"]
        stack.append((None, level))
        stack += [(child, level + 1) for child in reversed(children)]


def _is_end(skeleton: Skeleton, joint: int) -> bool:
    """Whether a leaf came from an End Site: named after its parent, whose only child it is."""
    parent = skeleton.parents[joint]
    alone = skeleton.parents.count(parent) == 1
    return parent >= 0 and alone and skeleton.names[joint] == f"{skeleton.names[parent]}_end"
