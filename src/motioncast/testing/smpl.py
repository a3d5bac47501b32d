"""A made-up body model in the layout of SMPL's files, for tests: the real ones may not be passed on."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from motioncast.bodies.smpl import NAMES

_REST = {
    "pelvis": (0, 0.95, 0), "hip": (0.1, 0.92, 0), "spine1": (0, 1.05, 0), "knee": (0.11, 0.5, 0.01),
    "spine2": (0, 1.18, 0), "ankle": (0.11, 0.09, -0.02), "spine3": (0, 1.25, 0), "foot": (0.12, 0.02, 0.1),
    "neck": (0, 1.46, 0), "collar": (0.08, 1.4, 0), "head": (0, 1.55, 0.02), "shoulder": (0.18, 1.42, 0),
    "elbow": (0.45, 1.42, 0), "wrist": (0.7, 1.42, 0), "hand": (0.78, 1.42, 0), "jaw": (0, 1.55, 0.05),
    "eye_smplhf": (0.03, 1.6, 0.08),
}  # fmt: skip
"""Where the joints are at rest, above the ground, y up, facing +z, arms out."""

_PARENTS: tuple[int, ...] = (-1, 0, 0, 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 9, 9, 12, 13, 14, 16, 17, 18, 19)


def write_smpl(path: str | Path, kind: str = "smpl", shapes: int = 10, skin: int = 3) -> Path:
    """Writes a model: a body of 1.7 m, whose joints are vertices of it.

    Args:
        path: The file; folders above it are made.
        kind: ``smpl``, ``smplh`` or ``smplx``.
        shapes: How many shape numbers it has; the first makes it taller.
        skin: Vertices around each joint.

    Returns:
        The path.
    """
    names = NAMES[kind]
    rng = np.random.default_rng(0)
    rest, parents = [], list(_PARENTS)
    for index, name in enumerate(names):
        side, _, place = name.partition("_")
        if place and place not in _REST:  # fingers, one behind the other
            place = "hand"
        x, y, z = _REST[place or name]
        rest.append((-x if side == "right" else x, y - 0.95, z))  # the pelvis near the origin, as SMPL has it
        if index >= len(_PARENTS):
            parents.append(15 if place == "eye_smplhf" or name == "jaw" else 20 if side == "left" else 21)
    joints = len(names)
    bones = np.array(rest)
    template = np.concatenate([bones, (bones[:, None] + rng.normal(0, 0.05, (joints, skin, 3))).reshape(-1, 3)])
    vertices = len(template)
    directions = rng.normal(0, 0.01, (vertices, 3, shapes))
    directions[..., 0] = template * 0.02
    weights = rng.random((vertices, joints)) ** 8
    Path(path).parent.mkdir(parents=True, exist_ok=True)
    kintree = np.array([[2**32 - 1, *parents[1:]], range(joints)], np.uint32)
    np.savez(
        path,
        v_template=template,
        shapedirs=directions,
        posedirs=rng.normal(0, 0.002, (vertices, 3, 9 * (joints - 1))),
        J_regressor=np.eye(joints, vertices),
        weights=weights / weights.sum(1, keepdims=True),
        kintree_table=kintree,
        joint2num=np.array({"pelvis": 0}, dtype=object),  # the real files hold such a pickle too; it is never read
    )
    return Path(path)
