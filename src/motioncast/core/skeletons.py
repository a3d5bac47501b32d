"""The known skeletons, and the recognition of joints by name.

Names are looked up without regard to case, spaces, underscores and namespace prefixes (``mixamorig:``).
A *dialect* maps a family of names to landmarks; the dialect that explains most joints of a file wins.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence

from motioncast.core.skeleton import LANDMARKS, Skeleton
from motioncast.errors import SkeletonError


def _sided(left: str, right: str, places: Mapping[str, str]) -> dict[str, str]:
    """Both sides of a table: ``{"femur": "knee"}`` with "l", "r" gives lfemur and rfemur."""
    return {
        f"{prefix}{name}": f"{side}_{place}"
        for prefix, side in ((left, "left"), (right, "right"))
        for name, place in places.items()
    }


# CMU's Acclaim skeleton: a name stands for the END of that bone.
CMU_ENDS: dict[str, str] = {
    "root": "pelvis", "lowerback": "lower_spine", "upperback": "middle_spine", "thorax": "neck_base",
    "lowerneck": "neck", "upperneck": "upper_neck", "head": "head",
    **_sided("l", "r", {
        "hipjoint": "hip", "femur": "knee", "tibia": "ankle", "foot": "foot", "toes": "toe",
        "clavicle": "shoulder", "humerus": "elbow", "wrist": "wrist", "hand": "hand",
        "fingers": "fingers", "thumb": "thumb",
    }),
}  # fmt: skip

# BVH made from CMU by cgspeed, MotionBuilder, Mixamo: a name stands for the START of that bone.
HUMANOID_STARTS: dict[str, str] = {
    "hips": "pelvis", "lowerback": "lower_spine", "spine": "lower_spine", "spine1": "middle_spine",
    "spine2": "upper_spine", "spine3": "upper_spine", "chest": "upper_spine", "neck": "neck_base",
    "neck1": "neck", "head": "head", "headtopend": "head_top",
    **_sided("left", "right", {
        "upleg": "hip", "leg": "knee", "foot": "ankle", "toebase": "toe", "toe": "toe",
        "shoulder": "collar", "arm": "shoulder", "forearm": "elbow", "hand": "wrist",
        "handindex1": "fingers", "fingerbase": "hand", "handthumb1": "thumb", "thumb": "thumb",
    }),
}  # fmt: skip

XSENS_STARTS: dict[str, str] = {
    "pelvis": "pelvis", "l5": "lower_spine", "l3": "middle_spine", "t12": "upper_spine", "t8": "neck_base",
    "neck": "neck", "head": "head",
    **_sided("left", "right", {
        "upperleg": "hip", "lowerleg": "knee", "foot": "ankle", "toe": "toe",
        "shoulder": "collar", "upperarm": "shoulder", "forearm": "elbow", "hand": "wrist",
    }),
}  # fmt: skip

SMPL_JOINTS: dict[str, str] = {
    "pelvis": "pelvis", "spine1": "lower_spine", "spine2": "middle_spine", "spine3": "upper_spine",
    "torso": "lower_spine", "spine": "middle_spine", "chest": "upper_spine", "neck": "neck", "head": "head",
    **_sided("left", "right", {
        "hip": "hip", "knee": "knee", "ankle": "ankle", "foot": "toe", "toe": "toe", "collar": "collar",
        "thorax": "collar", "shoulder": "shoulder", "elbow": "elbow", "wrist": "wrist", "hand": "hand",
    }),
    **_sided("l", "r", {
        "hip": "hip", "knee": "knee", "ankle": "ankle", "foot": "toe", "toe": "toe", "collar": "collar",
        "thorax": "collar", "shoulder": "shoulder", "elbow": "elbow", "wrist": "wrist", "hand": "hand",
    }),
}  # fmt: skip

UNREAL_STARTS: dict[str, str] = {
    "pelvis": "pelvis", "spine01": "lower_spine", "spine02": "middle_spine", "spine03": "upper_spine",
    "neck01": "neck_base", "head": "head",
    **{
        f"{name}{suffix}": f"{side}_{place}"
        for suffix, side in (("l", "left"), ("r", "right"))
        for name, place in {
            "thigh": "hip", "calf": "knee", "foot": "ankle", "ball": "toe", "clavicle": "collar",
            "upperarm": "shoulder", "lowerarm": "elbow", "hand": "wrist",
        }.items()
    },
}  # fmt: skip

LANDMARK_NAMES: dict[str, str] = {
    **{landmark.replace("_", ""): landmark for landmark in LANDMARKS},
    **_sided("left", "right", {"eye": "eye", "ear": "ear", "bigtoe": "toe"}),
    **_sided("l", "r", {"eye": "eye", "ear": "ear", "heel": "heel", "bigtoe": "toe"}),
    "midhip": "pelvis", "root": "pelvis", "lowerneck": "neck",
}  # fmt: skip

DIALECTS: dict[str, dict[str, str]] = {
    "landmarks": LANDMARK_NAMES,
    "cmu": CMU_ENDS,
    "humanoid": HUMANOID_STARTS,
    "smpl": SMPL_JOINTS,
    "xsens": XSENS_STARTS,
    "unreal": UNREAL_STARTS,
}
"""Families of joint names; earlier ones win a tie."""


def plain(name: str) -> str:
    """A joint name without namespace, case, blanks and punctuation.

    Example:
        >>> plain("mixamorig:LeftUp_Leg"), plain("L Hip")
        ('leftupleg', 'lhip')
    """
    return re.sub(r"[^a-z0-9]", "", name.rpartition(":")[2].lower().removeprefix("mixamorig"))


def recognise(
    names: Sequence[str], parents: Sequence[int], label: str = "unnamed", named: Mapping[str, str] | None = None
) -> Skeleton:
    """A skeleton whose landmarks are recognised from its joint names.

    Args:
        names: Joint names as the file gives them.
        parents: Parent of each joint, -1 for roots.
        label: Short name of the skeleton.
        named: Landmarks that the user gives by joint name; they win over the recognised ones.

    Raises:
        SkeletonError: If ``named`` holds an unknown joint or landmark.

    Example:
        >>> recognise(["Hips", "LeftUpLeg", "LeftLeg"], [-1, 0, 1]).landmarks
        ('pelvis', 'left_hip', 'left_knee')
        >>> recognise(["root", "lhipjoint", "lfemur"], [-1, 0, 1]).landmarks
        ('pelvis', 'left_hip', 'left_knee')
    """
    keys = [plain(name) for name in names]
    dialect = max(DIALECTS.values(), key=lambda table: len({table[key] for key in keys if key in table}))
    landmarks = [dialect.get(key, "") for key in keys]
    for joint, name in (named or {}).items():
        if joint not in names:
            raise SkeletonError(f'the map names the joint "{joint}", which is not in {", ".join(names)}')
        if name and name not in LANDMARKS:
            raise SkeletonError(f'the map names the landmark "{name}"; use one of {", ".join(LANDMARKS)}')
        landmarks = ["" if known == name else known for known in landmarks]
        landmarks[list(names).index(joint)] = name
    for joint, landmark in enumerate(landmarks):  # the first joint of a name keeps it
        if landmark in landmarks[:joint]:
            landmarks[joint] = ""
    return Skeleton(tuple(names), tuple(parents), tuple(landmarks), label)


def _of_landmarks(label: str, tree: Mapping[str, str]) -> Skeleton:
    """A skeleton whose joints are named by their landmarks, from a table joint -> parent."""
    names = tuple(tree)
    parents = tuple(names.index(parent) if parent else -1 for parent in tree.values())
    return Skeleton(names, parents, names, label)


MRT15 = _of_landmarks("mrt15", {
    "pelvis": "", "left_hip": "pelvis", "left_knee": "left_hip", "left_ankle": "left_knee",
    "right_hip": "pelvis", "right_knee": "right_hip", "right_ankle": "right_knee",
    "neck": "pelvis", "head": "neck", "left_shoulder": "neck", "left_elbow": "left_shoulder",
    "left_wrist": "left_elbow", "right_shoulder": "neck", "right_elbow": "right_shoulder",
    "right_wrist": "right_elbow",
})  # fmt: skip
"""The 15 joints of the CMU setting of SoMoFormer (order of MRT's files)."""

SOMOF13 = Skeleton(
    names=(
        "left_hip", "right_hip", "left_knee", "right_knee", "left_ankle", "right_ankle", "neck",
        "left_shoulder", "right_shoulder", "left_elbow", "right_elbow", "left_wrist", "right_wrist",
    ),
    parents=(-1, 0, 0, 1, 2, 3, 0, 6, 6, 7, 8, 9, 10),
    landmarks=(
        "left_hip", "right_hip", "left_knee", "right_knee", "left_ankle", "right_ankle", "neck",
        "left_shoulder", "right_shoulder", "left_elbow", "right_elbow", "left_wrist", "right_wrist",
    ),
    label="somof13",
)  # fmt: skip
"""The 13 joints of the SoMoF benchmark, in its order; it has no pelvis."""

SMPL22 = recognise(
    ["pelvis", "left_hip", "right_hip", "spine1", "left_knee", "right_knee", "spine2", "left_ankle",
     "right_ankle", "spine3", "left_foot", "right_foot", "neck", "left_collar", "right_collar", "head",
     "left_shoulder", "right_shoulder", "left_elbow", "right_elbow", "left_wrist", "right_wrist"],
    [-1, 0, 0, 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 9, 9, 12, 13, 14, 16, 17, 18, 19],
    "smpl22",
)  # fmt: skip

COCO17 = Skeleton(
    names=(
        "nose", "left_eye", "right_eye", "left_ear", "right_ear", "left_shoulder", "right_shoulder",
        "left_elbow", "right_elbow", "left_wrist", "right_wrist", "left_hip", "right_hip", "left_knee",
        "right_knee", "left_ankle", "right_ankle",
    ),
    parents=(-1, 0, 0, 1, 2, 0, 0, 5, 6, 7, 8, 5, 6, 11, 12, 13, 14),
    landmarks=(
        "nose", "left_eye", "right_eye", "left_ear", "right_ear", "left_shoulder", "right_shoulder",
        "left_elbow", "right_elbow", "left_wrist", "right_wrist", "left_hip", "right_hip", "left_knee",
        "right_knee", "left_ankle", "right_ankle",
    ),
    label="coco17",
)  # fmt: skip

SKELETONS: dict[str, Skeleton] = {skeleton.label: skeleton for skeleton in (MRT15, SOMOF13, SMPL22, COCO17)}
"""Known skeletons by name."""
