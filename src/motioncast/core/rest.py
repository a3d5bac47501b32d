"""The rest pose of a body that is known by its joint positions alone: pivots, bone lengths, a T pose."""

from __future__ import annotations

import numpy as np

from motioncast.core import rotation
from motioncast.core.scene import Scene
from motioncast.core.skeleton import Skeleton

RIGID_M = 0.004
"""Bones of one joint turn together if their angle moves their ends by no more than this."""


def _both_sides(places: dict[str, tuple[float, float, float]]) -> dict[str, tuple[float, float, float]]:
    left = {f"left_{name}": place for name, place in places.items()}
    right = {f"right_{name}": (-x, y, z) for name, (x, y, z) in places.items()}
    return left | right


T_POSE: dict[str, tuple[float, float, float]] = {
    "pelvis": (0, 0, 0.95), "lower_spine": (0, 0, 1.06), "middle_spine": (0, 0, 1.17),
    "upper_spine": (0, 0, 1.28), "neck_base": (0, 0, 1.40), "neck": (0, 0, 1.48), "upper_neck": (0, 0, 1.55),
    "head": (0, 0, 1.63), "head_top": (0, 0, 1.78), "nose": (0, -0.10, 1.63),
    **_both_sides({
        "hip": (0.10, 0, 0.90), "knee": (0.10, 0, 0.50), "ankle": (0.10, 0, 0.08), "heel": (0.10, 0.05, 0.02),
        "foot": (0.10, -0.10, 0.03), "toe": (0.10, -0.16, 0.02), "collar": (0.05, 0, 1.41),
        "shoulder": (0.18, 0, 1.42), "elbow": (0.46, 0, 1.42), "wrist": (0.72, 0, 1.42),
        "hand": (0.80, 0, 1.42), "fingers": (0.90, 0, 1.42), "thumb": (0.78, -0.06, 1.42),
        "eye": (0.03, -0.09, 1.66), "ear": (0.08, 0, 1.64),
    }),
}  # fmt: skip
"""Where the landmarks are, in metres, on someone who stands on the floor, faces -y and holds the arms out."""


def rest_body(scene: Scene) -> tuple[Skeleton, np.ndarray]:
    """The skeleton with the pivots that the motion asks for, and rest offsets of each person.

    Lengths are medians over the frames; directions are those of a T pose by landmark. Bones that turn
    together keep the angles that they have in the motion.

    Returns:
        Skeleton of ``n`` joints and offsets ``(people, n, 3)``; a pivot's offset is zero.
    """
    skeleton = scene.skeleton
    rest = _rest_bones(scene)
    names, parents, landmarks, source = [], [], [], []
    number: dict[int, int] = {}
    pivots = _pivots(scene)
    for joint, parent in enumerate(_one_root(skeleton)):
        above = number[parent] if parent >= 0 else -1
        if joint in pivots:
            leader = pivots[joint]
            if leader == joint:
                names.append(_unused(f"{skeleton.names[joint]}_pivot", skeleton.names))
                parents.append(above)
                landmarks.append("")
                source.append(-1)
            above = names.index(_unused(f"{skeleton.names[leader]}_pivot", skeleton.names))
        number[joint] = len(names)
        names.append(skeleton.names[joint])
        parents.append(above)
        landmarks.append(skeleton.landmarks[joint])
        source.append(joint)
    offsets = np.where(np.array(source)[:, None] >= 0, rest[:, source], 0.0)
    return Skeleton(tuple(names), tuple(parents), tuple(landmarks), skeleton.label), offsets


def handles(skeleton: Skeleton, offsets: np.ndarray, joint: int) -> list[int]:
    """The joints by whose places this joint's turn is known: its children, or those of its pivots.

    A child of no length says nothing; only where there is no other are its own children looked at.
    """
    children = [child for child, parent in skeleton.bones if parent == joint]
    long = [child for child in children if np.linalg.norm(offsets[:, child], axis=-1).min() > 1e-6]
    return long or [end for child in children for end in handles(skeleton, offsets, child)]


def steadiness(scene: Scene) -> np.ndarray:
    """How much each joint counts when its parent's turn is fitted, ``(joints,)``.

    Where bones of one joint move on their own, those that move least against one another say best how the
    joint turns: the hips, not the thigh.
    """
    weights = np.ones(len(scene.skeleton))
    grounded = _grounded(scene)
    for joint in range(len(scene.skeleton)):
        ends = [end for end, root in enumerate(grounded) if root == joint]
        if len(ends) > 2:
            angles = _spread(scene, joint, ends)
            np.fill_diagonal(angles, np.inf)
            weights[ends] = 1 / np.maximum(angles.min(1), 0.05)
            weights[ends] /= weights[ends].max()
    return weights


def _grounded(scene: Scene) -> list[int]:
    """For each joint the first ancestor that is not always in one place with the joint's parent."""
    positions, parents, result = scene.positions, scene.skeleton.parents, []
    for parent in parents:
        while parent > 0 and np.array_equal(positions[:, :, parent], positions[:, :, parents[parent]]):
            parent = parents[parent]
        result.append(parent)
    return result


def _one_root(skeleton: Skeleton) -> list[int]:
    """Parents, with all further roots hung on the first joint: a file's body is one tree."""
    return [max(parent, 0) if joint else -1 for joint, parent in enumerate(skeleton.parents)]


def _unused(name: str, names: tuple[str, ...]) -> str:
    while name in names:
        name += "_"
    return name


def _spread(scene: Scene, joint: int, ends: list[int]) -> np.ndarray:
    """How far the angle between two bones of a joint strays from its median, ``(ends, ends)`` radians."""
    bones = scene.positions[:, :, ends].astype(np.float64) - scene.positions[:, :, joint, None]
    seen = scene.observed[:, :, ends] & scene.observed[:, :, joint, None]
    result = np.zeros((len(ends), len(ends)))
    for first in range(len(ends)):
        for second in range(first):
            a, b, both = bones[:, :, first], bones[:, :, second], seen[:, :, first] & seen[:, :, second]
            angle = np.arctan2(np.linalg.norm(np.cross(a, b), axis=-1), (a * b).sum(-1))
            for person in range(both.shape[1]):
                angles = angle[both[:, person], person]
                if len(angles):
                    strayed = np.abs(angles - np.median(angles)).max()
                    result[first, second] = result[second, first] = max(result[first, second], strayed)
    return result


def _groups(scene: Scene, joint: int, ends: list[int]) -> list[list[int]]:
    """The ends of a joint's bones, grouped by what turns together."""
    lengths = _lengths(scene, joint, ends).max(0)
    moves = _spread(scene, joint, ends) * np.minimum(lengths[:, None], lengths)
    groups: list[list[int]] = []
    for end in range(len(ends)):
        group = next((group for group in groups if moves[end, group].max() <= RIGID_M), None)
        if group is None:
            groups.append([end])
        else:
            group.append(end)
    return [[ends[end] for end in group] for group in groups]


def _pivots(scene: Scene) -> dict[int, int]:
    """Joints that hang on a pivot: joint -> the first joint on the same pivot.

    The largest group of bones that turn together hangs on the joint itself, if it is more than one bone.
    """
    parents = _one_root(scene.skeleton)
    result = {}
    for joint in range(len(parents)):
        ends = [end for end, parent in enumerate(parents) if parent == joint]
        groups = _groups(scene, joint, ends) if len(ends) > 1 else []
        core = max(groups, key=len, default=[])
        for group in groups:
            if group is not core or len(core) == 1:
                result.update(dict.fromkeys(group, group[0]))
    return result


def _lengths(scene: Scene, joint: int, ends: list[int]) -> np.ndarray:
    """Median lengths of the bones from a joint, ``(people, ends)``; zero for those never seen."""
    bones = scene.positions[:, :, ends].astype(np.float64) - scene.positions[:, :, joint, None]
    length = np.linalg.norm(bones, axis=-1)
    seen = scene.observed[:, :, ends] & scene.observed[:, :, joint, None]
    result = np.zeros(length.shape[1:])
    for person, end in np.argwhere(seen.any(0)):
        result[person, end] = np.median(length[seen[:, person, end], person, end])
    return result


def _rest_bones(scene: Scene) -> np.ndarray:
    """Rest offset of each joint from its parent, ``(people, joints, 3)``."""
    skeleton, parents = scene.skeleton, _one_root(scene.skeleton)
    directions = _t_pose_directions(skeleton)
    rest = np.zeros((scene.positions.shape[1], len(skeleton), 3))
    for joint in range(len(skeleton)):
        ends = [end for end, parent in enumerate(parents) if parent == joint]
        if not ends:
            continue
        lengths = _lengths(scene, joint, ends)
        rest[:, ends] = directions[ends] * lengths[..., None]
        for group in _groups(scene, joint, ends):
            if len(group) > 1:
                members = [ends.index(end) for end in group]
                rest[:, group] = _shape(scene, joint, group, rest[:, group], lengths[:, members])
    return rest


def _shape(scene: Scene, joint: int, group: list[int], wanted: np.ndarray, lengths: np.ndarray) -> np.ndarray:
    """Bones that turn together as they stand to one another in the motion, turned to the wanted pose."""
    shapes = wanted.copy()
    for person in range(len(wanted)):
        seen = scene.observed[:, person, [joint, *group]].all(1)
        if not seen.any():
            continue
        bones = scene.positions[seen, person].astype(np.float64)
        bones = bones[:, group] - bones[:, joint, None]
        turns = rotation.kabsch(bones, np.broadcast_to(bones[0], bones.shape))
        shape = rotation.rotate(turns[:, None], bones).mean(0)
        shape = rotation.rotate(rotation.kabsch(shape, wanted[person]), shape)
        size = np.linalg.norm(shape, axis=-1, keepdims=True)
        shapes[person] = shape / np.maximum(size, 1e-9) * lengths[person][:, None]
    return shapes


def _t_pose_directions(skeleton: Skeleton) -> np.ndarray:
    """Unit direction of each joint from its parent, ``(joints, 3)``; unnamed joints go on as their parent."""
    places = np.zeros((len(skeleton), 3))
    directions = np.tile([0.0, 0.0, 1.0], (len(skeleton), 1))
    for joint, parent in enumerate(_one_root(skeleton)):
        known = T_POSE.get(skeleton.landmarks[joint])
        if parent < 0:
            places[joint] = known or (0, 0, 0)
            continue
        step = np.array(known) - places[parent] if known else 0.1 * directions[parent]
        size = np.linalg.norm(step)
        directions[joint] = step / size if size > 1e-9 else directions[parent]
        places[joint] = places[parent] + step
    return directions
