"""GRAB: ten people who grasp 51 objects, 120 frames a second, SMPL-X with each person's own body, z up, metres.

The user's own copy holds ``grab/s1 .. s10/OBJECT_ACTION_N.npz`` and ``tools/subject_meshes/GENDER/sN.ply`` as its
owners' tool unpacks them, and beside them the user's SMPL-X in a folder ``body_models`` (``bodies.smpl.find``). The
entries of the npz files are pickled; they are read as plain data and can run nothing (``formats.pickles``).

A scene has the 22 joints of the body and, for characteristic poses, the points of its skin at the nose, ears, toes and
heels, the eyes, and the last joint of each index finger; ``POINTS`` are the vertices of SMPL-X. The object is not read.

Names and shapes are those of the owners' tools; no file was at hand to check them against. Where a file lacks
``fullpose``, fingers are marked as not observed.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np

from motioncast.bodies import smpl
from motioncast.core.scene import Scene
from motioncast.core.skeleton import Skeleton
from motioncast.core.skeletons import SMPL22
from motioncast.datasets.amass import number, text
from motioncast.datasets.catalogue import DataSet, below, metric
from motioncast.datasets.ply import read_vertices
from motioncast.errors import FormatError
from motioncast.formats.pickles import read_members

TEST_PEOPLE, VALIDATION_PEOPLE = ("s10",), ("s1",)
"""Split by person as characteristic poses use it; everybody else trains."""

POINTS = {
    "nose": 9120, "right_eye": 9929, "left_eye": 9448, "right_ear": 616, "left_ear": 6, "left_big_toe": 5770,
    "left_small_toe": 5780, "left_heel": 8846, "right_big_toe": 8463, "right_small_toe": 8474, "right_heel": 8635,
}  # fmt: skip
"""Vertices of SMPL-X's skin."""

FINGERS = {"left_index3": 27, "right_index3": 42}
"""Joints of SMPL-X."""

_PARENTS = {
    "nose": "head", "right_eye": "head", "left_eye": "head", "right_ear": "head", "left_ear": "head",
    **{f"{side}_{place}": f"{side}_ankle" for side in ("left", "right") for place in ("big_toe", "small_toe", "heel")},
    "left_index3": "left_wrist", "right_index3": "right_wrist",
}  # fmt: skip

_LANDMARKS = {
    "left_big_toe": "left_toe", "right_big_toe": "right_toe", "left_small_toe": "", "right_small_toe": "",
    "left_index3": "left_fingers", "right_index3": "right_fingers",
}  # fmt: skip

SKELETON = Skeleton(
    (*SMPL22.names, *POINTS, *FINGERS),
    (*SMPL22.parents, *(SMPL22.index(_PARENTS[name]) for name in (*POINTS, *FINGERS))),
    (*SMPL22.landmarks, *(_LANDMARKS.get(name, name) for name in (*POINTS, *FINGERS))),
    "grab35",
)

BODY_POSES = 55 * 3


def takes(folder: str | Path, split: str | None = None) -> list[Path]:
    """The takes of everybody, or of the people of one split."""
    found = below(Path(folder), "s[0-9]/*.npz", "s10/*.npz")
    return [path for path in found if split in (None, _split(path.parent.name))]


def _split(person: str) -> str:
    return "test" if person in TEST_PEOPLE else "validation" if person in VALIDATION_PEOPLE else "train"


def read(path: str | Path) -> Iterator[Scene]:
    """The scene of one take.

    Raises:
        InputError: If there is no such file, no SMPL-X of the gender, or not the person's body.
        FormatError: If it is damaged, of another layout, or holds more than plain data.
    """
    path = Path(path)
    data = read_members(path, ("gender", "framerate", "body"))
    body = data.get("body")
    params = body.get("params") if isinstance(body, dict) else None
    rate = number(data.get("framerate"))
    if not isinstance(params, dict) or "gender" not in data or rate is None:
        raise FormatError(path, "has no gender, framerate or body with params; expected a take of GRAB")
    known = "fullpose" in params
    if known:
        poses = _numbers(path, params, "fullpose", BODY_POSES)
    else:
        parts = [_numbers(path, params, name, width) for name, width in (("global_orient", 3), ("body_pose", 63))]
        poses = np.concatenate([*parts, np.zeros((len(parts[0]), BODY_POSES - 66))], 1)
    translation = _numbers(path, params, "transl", 3)
    gender = text(data["gender"])
    mesh = path.parents[2] / "tools" / "subject_meshes" / gender / f"{path.parent.name}.ply"
    own = _own_body(smpl.models_beside(path), gender, mesh)
    shape = np.zeros(0, np.float32)
    joints = smpl.joints(own, shape, poses, translation)
    skin = smpl.vertices(own, shape, poses, translation, list(POINTS.values()))
    positions = np.concatenate([joints[:, : len(SMPL22)], skin, joints[:, list(FINGERS.values())]], 1)
    observed = np.ones(positions.shape[:2], bool)
    observed[:, -len(FINGERS) :] = known
    take = f"{path.parent.name} {path.stem}"
    yield metric(Scene(positions[:, None], SKELETON, rate, observed[:, None], (take,), source=f"GRAB {take}"))


def _numbers(path: Path, params: dict[str, Any], name: str, width: int) -> np.ndarray:
    values = np.asarray(params.get(name))
    if values.dtype.kind != "f" or values.ndim != 2 or values.shape[1] != width or not np.isfinite(values).all():
        raise FormatError(path, f'has no finite numbers "{name}" of shape (frames, {width}); expected a take of GRAB')
    return values


@lru_cache(maxsize=3)
def _own_body(models: Path, gender: str, mesh: Path) -> smpl.SmplModel:
    model = smpl.load(smpl.find(models, "smplx", gender))
    return smpl.with_template(model, read_vertices(mesh))


DATASET = DataSet(
    "grab",
    "GRAB, ten people grasping 51 objects; SMPL-X with each person's own body, 120 fps",
    "non-commercial research only; SMPL-X has a licence of its own",
    "1,334 takes, 4 hours, about 20 GB",
    "grab.is.tue.mpg.de; SMPL-X from smpl-x.is.tue.mpg.de",
    ("s10/*.npz", "tools/subject_meshes/**/*.ply", "body_models/**/*.npz"),
    takes,
    read,
)
