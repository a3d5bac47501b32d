"""Human3.6M: one person in a laboratory, 15 kinds of action, 50 frames a second.

Two layouts of the user's own copy:

- ``S1/walking_1.txt``, the *exponential maps* that Jain et al. (CVPR 2016) passed on: 99 numbers a line, of which 96
  turn the joints of a 32-joint body by an axis times an angle. The first six are the root's, as steps from frame to
  frame in the body's own axes: its path cannot be had back. So here, as in all papers on this file, the pelvis stays at
  the origin and the body upright in its own axes. The bones are those of subject 1 for everybody, as in all papers.
  The angles turn row vectors: a joint's turn here is the inverse of the file's.
- ``*.npz`` of positions: arrays ``(frames, joints, 3)`` or ``(frames, joints * 3)`` of 32 or 17 joints, one a take, or
  ``positions_3d`` pickled as {subject: {action: array}} (``data_3d_h36m.npz``). Pickled entries are read as plain data
  and can run nothing. The unit (m or mm) and the up axis are inferred from the body; they are said in the remarks.

Splits: S1, S6, S7, S8, S9 train, S11 validates, S5 tests (angles); positions have other customs: state yours.
The layout of the angle files was checked against one public file; no file of positions was at hand.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from motioncast.core.kinematics import forward
from motioncast.core.rotation import conjugate, from_axis_angle, from_matrix, multiply
from motioncast.core.scene import Scene
from motioncast.core.skeleton import Skeleton
from motioncast.core.skeletons import H36M17
from motioncast.datasets.catalogue import DataSet, below, metric
from motioncast.errors import FormatError, InputError
from motioncast.formats.files import read_text
from motioncast.formats.pickles import read_members
from motioncast.formats.units import axis_turn, settle

FPS = 50.0
SPLITS = {"train": ("S1", "S6", "S7", "S8", "S9"), "validation": ("S11",), "test": ("S5",)}

_JOINTS: tuple[tuple[str, int, str, tuple[float, float, float]], ...] = (
    ("Hips", -1, "pelvis", (0, 0, 0)),
    ("RightUpLeg", 0, "right_hip", (-132.948591, 0, 0)),
    ("RightLeg", 1, "right_knee", (0, -442.894612, 0)),
    ("RightFoot", 2, "right_ankle", (0, -454.206447, 0)),
    ("RightToeBase", 3, "right_foot", (0, 0, 162.767078)),
    ("RightToeEnd", 4, "right_toe", (0, 0, 74.999437)),
    ("LeftUpLeg", 0, "left_hip", (132.948826, 0, 0)),
    ("LeftLeg", 6, "left_knee", (0, -442.894413, 0)),
    ("LeftFoot", 7, "left_ankle", (0, -454.20659, 0)),
    ("LeftToeBase", 8, "left_foot", (0, 0, 162.767426)),
    ("LeftToeEnd", 9, "left_toe", (0, 0, 74.999948)),
    ("Spine", 0, "", (0, 0.1, 0)),
    ("Spine1", 11, "middle_spine", (0, 233.383263, 0)),
    ("Thorax", 12, "neck_base", (0, 257.077681, 0)),
    ("Neck", 13, "nose", (0, 121.134938, 0)),
    ("Head", 14, "head_top", (0, 115.002227, 0)),
    ("LeftShoulder", 12, "", (0, 257.077681, 0)),
    ("LeftArm", 16, "left_shoulder", (0, 151.034226, 0)),
    ("LeftForeArm", 17, "left_elbow", (0, 278.882773, 0)),
    ("LeftHand", 18, "left_wrist", (0, 251.733451, 0)),
    ("LeftThumb", 19, "", (0, 0, 0)),
    ("LeftThumbEnd", 20, "left_thumb", (0, 0, 99.999627)),
    ("LeftWristEnd", 19, "left_hand", (0, 100.000188, 0)),
    ("LeftHandEnd", 22, "", (0, 0, 0)),
    ("RightShoulder", 12, "", (0, 257.077681, 0)),
    ("RightArm", 24, "right_shoulder", (0, 151.031437, 0)),
    ("RightForeArm", 25, "right_elbow", (0, 278.892924, 0)),
    ("RightHand", 26, "right_wrist", (0, 251.72868, 0)),
    ("RightThumb", 27, "", (0, 0, 0)),
    ("RightThumbEnd", 28, "right_thumb", (0, 0, 99.999888)),
    ("RightWristEnd", 27, "right_hand", (0, 137.499922, 0)),
    ("RightHandEnd", 30, "", (0, 0, 0)),
)

SKELETON = Skeleton(
    tuple(name for name, *_ in _JOINTS),
    tuple(parent for _, parent, *_ in _JOINTS),
    tuple(place for *_, place, _ in _JOINTS),
    "h36m32",
)
"""The 32 joints of Human3.6M; several stand at one place. ``Neck`` marks the nose, as in the 17 joints."""

OFFSETS_M = np.array([offset for *_, offset in _JOINTS]) / 1000
"""Rest offset of each joint from its parent, y up, facing +z: subject 1."""


def takes(folder: str | Path) -> list[Path]:
    """The files of angles and of positions."""
    texts = [path for path in below(Path(folder), "S*/*.txt") if path.parent.name.removeprefix("S").isdigit()]
    return [*texts, *below(Path(folder), "*.npz")]


def read(path: str | Path) -> Iterator[Scene]:
    """The scenes of one file: one of a text, any number of an npz file.

    Raises:
        InputError: If there is no such file, or its limbs are no people's.
        FormatError: If it is damaged, of another layout, or holds more than plain data.
    """
    path = Path(path)
    if path.suffix == ".txt":
        yield _angles(path)
        return
    members = read_members(path)
    for name, positions in _flat(members.get("positions_3d", members), ()):
        yield _positions(path, " ".join(name), positions)


def _angles(path: Path) -> Scene:
    """A scene of a file of exponential maps, with rotations."""
    lines = [line for line in read_text(path).split("\n") if line.strip()]
    width = 3 + 3 * len(SKELETON)
    try:
        values = np.array([line.split(",") for line in lines], np.float64)
    except ValueError as error:
        raise FormatError(path, f"is no table of {width} numbers a line ({str(error)[:60]}); get it again") from None
    if values.ndim != 2 or values.shape[1] != width or not np.isfinite(values).all():
        raise FormatError(path, f"has the shape {values.shape}; expected {width} finite numbers a line")
    vectors = values[:, 3:].reshape(len(values), len(SKELETON), 3)
    vectors[:, 0] = 0  # steps, not an orientation
    stand = from_matrix(axis_turn("y"))
    turns = multiply(multiply(stand, conjugate(from_axis_angle(vectors))), conjugate(stand))[:, None]
    offsets = (OFFSETS_M @ axis_turn("y").T)[None]
    positions = forward(turns, np.zeros((len(turns), 1, 3)), offsets, SKELETON.parents)
    source = f"Human3.6M {path.parent.name} {path.stem}"
    remark = f"{path.parent.name}/{path.name}: the pelvis stays at the origin; the file does not hold its path"
    return metric(
        Scene(
            positions,
            SKELETON,
            FPS,
            people=(path.parent.name,),
            rotations=turns.astype(np.float32),
            offsets=offsets.astype(np.float32),
            source=source,
            remarks=(remark,),
        )
    )


def _flat(values: Any, name: tuple[str, ...]) -> Iterator[tuple[tuple[str, ...], Any]]:
    """The arrays of nested dictionaries (two deep: subject, action), each with its names."""
    if isinstance(values, Mapping) and len(name) < 2:
        for key, value in values.items():
            yield from _flat(value, (*name, str(key)))
    else:
        yield name, values


def _positions(path: Path, take: str, values: Any) -> Scene:
    values = np.asarray(values)
    widths = {len(skeleton) * 3: skeleton for skeleton in (SKELETON, H36M17)}
    if values.dtype.kind != "f" or values.ndim not in (2, 3):
        raise FormatError(path, f'has an entry "{take}" that is no array of positions; expected (frames, joints, 3)')
    width = int(np.prod(values.shape[1:]))
    if width not in widths:
        raise FormatError(path, f'has an entry "{take}" of shape {values.shape}; expected 32 or 17 joints')
    if not len(values) or not np.isfinite(values).all():
        raise FormatError(path, f'has an entry "{take}" that is empty or not finite; get the file again')
    skeleton = widths[width]
    points = values.reshape(len(values), 1, len(skeleton), 3).astype(np.float64)
    observed = np.ones(points.shape[:3], bool)
    world = settle(f"{path} {take}", points, observed, skeleton, up=None, unit=None, usual_up="z")
    person = take.split()[0]
    source = f"Human3.6M {take}"
    return metric(Scene(world.points(points), skeleton, FPS, observed, (person,), source=source, remarks=world.remarks))


def split(folder: str | Path, name: str) -> list[Path]:
    """The files of angles of a split.

    Raises:
        InputError: If there is no such split.
    """
    if name not in SPLITS:
        raise InputError(f'there is no split "{name}"; choose one of {", ".join(SPLITS)}')
    return [path for path in takes(folder) if path.suffix == ".txt" and path.parent.name in SPLITS[name]]


DATASET = DataSet(
    "h36m",
    "Human3.6M, one person in a laboratory; 32 or 17 joints, 50 fps, as angles or positions",
    "academic use only, not to be passed on (vision.imar.ro/human3.6m)",
    "7 people, 15 actions, 527,599 frames; 0.4 GB of angles, 0.2 GB of positions",
    "vision.imar.ro/human3.6m; angles as passed on with SRNN, positions made by VideoPose3D's tools",
    ("S*/*.txt or *.npz",),
    takes,
    read,
)
