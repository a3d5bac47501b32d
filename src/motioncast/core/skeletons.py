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
        f"{prefix}{name}": f"{side}_{place}" if place else ""
        for prefix, side in ((left, "left"), (right, "right"))
        for name, place in places.items()
    }


def _sided_after(left: str, right: str, places: Mapping[str, str]) -> dict[str, str]:
    """Both sides of a table whose names end with the side: ``{"thigh": "hip"}`` gives thighl and thighr."""
    return {
        f"{name}{suffix}": f"{side}_{place}"
        for suffix, side in ((left, "left"), (right, "right"))
        for name, place in places.items()
    }


# CMU's Acclaim skeleton: a name stands for the END of that bone.
CMU_ENDS: dict[str, str] = {
    "root": "pelvis", "lowerback": "lower_spine", "upperback": "middle_spine", "thorax": "neck_base",
    "lowerneck": "neck", "upperneck": "upper_neck", "head": "head",
    **_sided("l", "r", {
        "hipjoint": "hip", "femur": "knee", "tibia": "ankle", "foot": "foot", "toes": "toe",
        "clavicle": "shoulder", "humerus": "elbow", "radius": "", "wrist": "wrist", "hand": "hand",
        "fingers": "fingers", "thumb": "thumb",
    }),
}  # fmt: skip

# BVH of Mixamo, MotionBuilder, Unity, Rokoko and their kin: a name stands for the START of that bone, so "head" is
# the base of the skull, "foot" the ankle and "toebase" the ball of the foot.
HUMANOID_STARTS: dict[str, str] = {
    "hips": "pelvis", "lowerback": "lower_spine", "spine": "lower_spine", "spine1": "middle_spine",
    "spine2": "upper_spine", "spine3": "upper_spine", "chest": "upper_spine", "upperchest": "",
    "neck": "neck_base",
    "neck1": "neck", "head": "upper_neck", "headend": "head_top", "headtopend": "head_top",
    **_sided("left", "right", {
        "upleg": "hip", "leg": "knee", "foot": "ankle", "toebase": "foot", "toe": "foot", "toes": "foot",
        "thigh": "hip", "shin": "knee", "upperleg": "hip", "lowerleg": "knee", "upperarm": "shoulder",
        "lowerarm": "elbow",
        "toeend": "toe", "toebaseend": "toe", "shoulder": "collar", "arm": "shoulder", "forearm": "elbow",
        "hand": "wrist", "handindex1": "hand", "handmiddle1": "hand", "handmiddle4": "fingers",
        "handmiddle3end": "fingers", "handthumb4": "thumb", "handthumb3end": "thumb",
    }),
}  # fmt: skip

# CMU's takes as BVH by cgspeed. Bones of no length start these joints: LHipJoint and LowerBack lie in the pelvis,
# LeftFingerBase in LeftHand (which is short of the wrist, since the wrist bone is left out).
CGSPEED_STARTS: dict[str, str] = {
    "hips": "pelvis", "lhipjoint": "", "rhipjoint": "", "lowerback": "", "spine": "lower_spine",
    "spine1": "middle_spine", "neck": "neck_base", "neck1": "neck", "head": "upper_neck", "headend": "head",
    "lthumb": "", "rthumb": "", "lthumbend": "left_thumb", "rthumbend": "right_thumb",
    **_sided("left", "right", {
        "upleg": "hip", "leg": "knee", "foot": "ankle", "toebase": "foot", "toebaseend": "toe", "shoulder": "",
        "arm": "shoulder", "forearm": "elbow", "hand": "wrist", "fingerbase": "", "handindex1": "hand",
        "handindex1end": "fingers",
    }),
}  # fmt: skip

XSENS_STARTS: dict[str, str] = {
    "pelvis": "pelvis", "hips": "pelvis", "l5": "lower_spine", "l3": "", "t12": "middle_spine", "t8": "upper_spine",
    "neck": "neck_base", "head": "upper_neck", "headend": "head_top",
    **_sided("left", "right", {
        "upperleg": "hip", "lowerleg": "knee", "foot": "ankle", "toe": "foot", "toeend": "toe",
        "shoulder": "collar", "upperarm": "shoulder", "forearm": "elbow", "hand": "wrist", "handend": "hand",
    }),
}  # fmt: skip

# Xsens MVN's BVH: the four chest joints are L5, L3, T12, T8.
MVN_BVH_STARTS: dict[str, str] = {
    "hips": "pelvis", "chest": "lower_spine", "chest2": "", "chest3": "middle_spine", "chest4": "upper_spine",
    "neck": "neck_base", "head": "upper_neck", "headend": "head_top",
    **_sided("left", "right", {
        "hip": "hip", "knee": "knee", "ankle": "ankle", "toe": "foot", "toeend": "toe", "collar": "collar",
        "shoulder": "shoulder", "elbow": "elbow", "wrist": "wrist", "wristend": "hand",
    }),
}  # fmt: skip

# SMPL and all skeletons that name joints after joints; SMPL's "head" is the base of the skull, its "foot" the ball.
SMPL_JOINTS: dict[str, str] = {
    "pelvis": "pelvis", "hips": "pelvis", "spine1": "lower_spine", "spine2": "middle_spine", "spine3": "upper_spine",
    "torso": "lower_spine", "spine": "middle_spine", "chest": "upper_spine", "neck": "neck", "head": "upper_neck",
    "headend": "head_top",
    **{
        name: landmark
        for left, right in (("left", "right"), ("l", "r"))
        for name, landmark in _sided(left, right, {
            "hip": "hip", "knee": "knee", "ankle": "ankle", "foot": "foot", "toe": "foot", "toeend": "toe",
            "collar": "collar", "thorax": "collar", "shoulder": "shoulder", "elbow": "elbow", "wrist": "wrist",
            "hand": "hand",
        }).items()
    },
}  # fmt: skip

UNREAL_STARTS: dict[str, str] = {
    "pelvis": "pelvis", "spine01": "lower_spine", "spine02": "middle_spine", "spine03": "upper_spine",
    "neck01": "neck_base", "head": "upper_neck",
    **_sided_after("l", "r", {
        "thigh": "hip", "calf": "knee", "shin": "knee", "foot": "ankle", "ball": "foot", "toe": "foot",
        "clavicle": "collar", "shoulder": "collar", "upperarm": "shoulder", "lowerarm": "elbow",
        "forearm": "elbow", "hand": "wrist",
    }),
}  # fmt: skip

BIPED_STARTS: dict[str, str] = {
    "pelvis": "pelvis", "spine": "lower_spine", "spine1": "middle_spine", "spine2": "upper_spine",
    "neck": "neck_base", "head": "upper_neck", "headnub": "head_top",
    **_sided("l", "r", {
        "thigh": "hip", "calf": "knee", "foot": "ankle", "toe0": "foot", "toe0nub": "toe",
        "clavicle": "collar", "upperarm": "shoulder", "forearm": "elbow", "hand": "wrist",
    }),
}  # fmt: skip

KINECT_JOINTS: dict[str, str] = {
    "spinebase": "pelvis", "spinemid": "middle_spine", "spineshoulder": "neck_base", "neck": "neck", "head": "head",
    **_sided_after("left", "right", {
        "hip": "hip", "knee": "knee", "ankle": "ankle", "foot": "toe", "shoulder": "shoulder", "elbow": "elbow",
        "wrist": "wrist", "hand": "hand", "handtip": "fingers", "thumb": "thumb",
    }),
}  # fmt: skip

_IMAGE_SIDES: dict[str, str] = {
    "eye": "eye", "ear": "ear", "shoulder": "shoulder", "elbow": "elbow", "wrist": "wrist", "hip": "hip",
    "knee": "knee", "ankle": "ankle", "heel": "heel", "bigtoe": "toe", "smalltoe": "",
}  # fmt: skip

# Detectors of images (OpenPose, COCO, HALPE, and OpenCap and Pose2Sim after them); "neck" lies between the shoulders.
OPENPOSE_JOINTS: dict[str, str] = {
    "nose": "nose", "neck": "neck_base", "midhip": "pelvis", "hip": "pelvis", "head": "head_top",
    **_sided("l", "r", _IMAGE_SIDES), **_sided("left", "right", _IMAGE_SIDES),
}  # fmt: skip

# The 17 joints of Human3.6M as single-image methods name them: "foot" is the ankle, "head" the top of the head.
H36M_JOINTS: dict[str, str] = {
    "hip": "pelvis", "root": "pelvis", "spine": "middle_spine", "belly": "middle_spine", "torso": "middle_spine",
    "thorax": "neck_base", "neck": "neck", "nose": "nose", "necknose": "nose", "neckbase": "nose", "head": "head_top",
    **{
        name: landmark
        for left, right in (("left", "right"), ("l", "r"))
        for name, landmark in _sided(left, right, {
            "hip": "hip", "knee": "knee", "foot": "ankle", "ankle": "ankle", "shoulder": "shoulder",
            "elbow": "elbow", "wrist": "wrist",
        }).items()
    },
}  # fmt: skip

# Gait laboratories: joint centres (RHJC, Plug-in Gait's bone ends) and markers on the skin close to a joint.
GAIT_JOINTS: dict[str, str] = {
    "pelo": "pelvis", "midhjc": "pelvis", "trxo": "neck_base", "hedo": "head", "c7": "neck_base",
    **_sided("l", "r", {
        "hjc": "hip", "kjc": "knee", "ajc": "ankle", "sjc": "shoulder", "ejc": "elbow", "wjc": "wrist",
        "fep": "hip", "feo": "knee", "tio": "ankle", "hup": "shoulder", "huo": "elbow", "rao": "wrist", "hno": "hand",
        "kne": "knee", "ank": "ankle", "hee": "heel", "toe": "toe", "sho": "shoulder", "elb": "elbow",
    }),
}  # fmt: skip

LANDMARK_NAMES: dict[str, str] = {
    **{landmark.replace("_", ""): landmark for landmark in LANDMARKS},
    "midhip": "pelvis", "root": "pelvis", "lowerneck": "neck",
}  # fmt: skip

DIALECTS: dict[str, dict[str, str]] = {
    "landmarks": LANDMARK_NAMES,
    "cmu": CMU_ENDS,
    "humanoid": HUMANOID_STARTS,
    "cgspeed": CGSPEED_STARTS,
    "smpl": SMPL_JOINTS,
    "xsens": XSENS_STARTS,
    "mvn": MVN_BVH_STARTS,
    "unreal": UNREAL_STARTS,
    "biped": BIPED_STARTS,
    "kinect": KINECT_JOINTS,
    "openpose": OPENPOSE_JOINTS,
    "h36m": H36M_JOINTS,
    "gait": GAIT_JOINTS,
}
"""Families of joint names, an empty landmark for joints that are known to mark none; earlier ones win a tie."""


def plain(name: str) -> str:
    """A joint name without namespace, case, blanks and punctuation.

    Example:
        >>> plain("mixamorig:LeftUp_Leg"), plain("L Hip")
        ('leftupleg', 'lhip')
    """
    key = re.sub(r"[^a-z0-9]", "", name.rpartition(":")[2].lower())
    return re.sub(r"^(mixamorig\d*|character\d+|bip0*1)(?=.)", "", key)


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
    dialect = max(DIALECTS.values(), key=lambda table: sum(key in table for key in keys))
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

SMPL24 = recognise([*SMPL22.names, "left_hand", "right_hand"], [*SMPL22.parents, 20, 21], "smpl24")

HIK29 = Skeleton(
    (*SMPL22.names, "jaw", "left_eyeball", "nose", "left_eye", "right_eye", "left_ear", "right_ear"),
    (*SMPL22.parents, 15, 15, 15, 24, 24, 25, 26),
    (*SMPL22.landmarks, "", "", "nose", "left_eye", "right_eye", "left_ear", "right_ear"),
    "hik29",
)
"""Humans in Kitchens: SMPL-X's body, jaw and left eyeball, then five points of the skin of the face."""

CMU31 = recognise(
    ["root", "lhipjoint", "lfemur", "ltibia", "lfoot", "ltoes", "rhipjoint", "rfemur", "rtibia", "rfoot", "rtoes",
     "lowerback", "upperback", "thorax", "lowerneck", "upperneck", "head",
     "lclavicle", "lhumerus", "lradius", "lwrist", "lhand", "lfingers", "lthumb",
     "rclavicle", "rhumerus", "rradius", "rwrist", "rhand", "rfingers", "rthumb"],
    [-1, 0, 1, 2, 3, 4, 0, 6, 7, 8, 9, 0, 11, 12, 13, 14, 15, 13, 17, 18, 19, 20, 21, 20, 13, 24, 25, 26, 27, 28, 27],
    "cmu31",
)  # fmt: skip
"""CMU's Acclaim skeleton: joints are named after the bones that end there."""

H36M17 = recognise(
    ["Hip", "RHip", "RKnee", "RFoot", "LHip", "LKnee", "LFoot", "Spine", "Thorax", "Nose", "Head",
     "LShoulder", "LElbow", "LWrist", "RShoulder", "RElbow", "RWrist"],
    [-1, 0, 1, 2, 0, 4, 5, 0, 7, 8, 9, 8, 11, 12, 8, 14, 15],
    "h36m17",
)  # fmt: skip

OPENPOSE25 = recognise(
    ["MidHip", "RHip", "RKnee", "RAnkle", "LHip", "LKnee", "LAnkle", "Neck", "Nose", "RShoulder", "RElbow", "RWrist",
     "LShoulder", "LElbow", "LWrist", "REye", "LEye", "REar", "LEar", "LBigToe", "LSmallToe", "LHeel",
     "RBigToe", "RSmallToe", "RHeel"],
    [-1, 0, 1, 2, 0, 4, 5, 0, 7, 7, 9, 10, 7, 12, 13, 8, 8, 15, 16, 6, 6, 6, 3, 3, 3],
    "openpose25",
)  # fmt: skip
"""OpenPose's BODY_25; the pelvis comes first here, since a parent comes before its children."""

UPPER9 = Skeleton(
    names=(
        "head", "neck", "right_shoulder", "right_elbow", "right_wrist", "left_shoulder", "left_elbow", "left_wrist",
        "pelvis",
    ),
    parents=(-1, 0, 1, 2, 3, 1, 5, 6, 1),
    landmarks=(
        "head", "neck", "right_shoulder", "right_elbow", "right_wrist", "left_shoulder", "left_elbow", "left_wrist",
        "pelvis",
    ),
    label="upper9",
)  # fmt: skip
"""The upper body of FutureHuman3D, in its order (Table 4.13); the head is the root, since a parent comes first."""

SKELETONS: dict[str, Skeleton] = {
    skeleton.label: skeleton
    for skeleton in (MRT15, SOMOF13, SMPL22, SMPL24, HIK29, COCO17, CMU31, H36M17, OPENPOSE25, UPPER9)
}
"""Known skeletons by name."""

NEAREST_PARENTS: dict[str, tuple[str, ...]] = {
    "lower_spine": ("pelvis",),
    "middle_spine": ("lower_spine", "pelvis"),
    "upper_spine": ("middle_spine", "lower_spine", "pelvis"),
    "neck_base": ("upper_spine", "middle_spine", "lower_spine", "pelvis"),
    "neck": ("neck_base", "upper_spine", "middle_spine", "lower_spine", "pelvis", "left_hip"),
    "upper_neck": ("neck", "neck_base"),
    "head": ("upper_neck", "neck", "neck_base"),
    "head_top": ("head", "upper_neck", "neck", "neck_base"),
    "nose": ("head", "upper_neck", "neck", "neck_base"),
    "right_hip": ("pelvis", "lower_spine", "left_hip"),
    **{
        f"{side}_{place}": tuple(
            parent if parent in ("pelvis", "lower_spine", "neck", "neck_base", "upper_spine", "head", "nose")
            else f"{side}_{parent}"
            for parent in parents
        )
        for side in ("left", "right")
        for place, parents in {
            "hip": ("pelvis", "lower_spine"), "knee": ("hip",), "ankle": ("knee",), "heel": ("ankle",),
            "foot": ("ankle", "heel"), "toe": ("foot", "ankle", "heel"),
            "collar": ("neck_base", "neck", "upper_spine"),
            "shoulder": ("collar", "neck_base", "neck", "upper_spine", "hip"), "elbow": ("shoulder",),
            "wrist": ("elbow",), "hand": ("wrist", "elbow"), "fingers": ("hand", "wrist"), "thumb": ("wrist", "hand"),
            "eye": ("nose", "head"), "ear": ("eye", "nose", "head"),
        }.items()
        if (side, place) != ("right", "hip")
    },
}  # fmt: skip
"""For each landmark the places that it may hang from, nearest first."""


def grow(names: Sequence[str], label: str = "unnamed", named: Mapping[str, str] | None = None) -> Skeleton:
    """A skeleton of joints without a tree: each hangs from the nearest place of the body that is there.

    Joints come parents first, else in the given order; joints without a landmark hang from nothing.

    Args:
        names: Joint names, as markers of a tracker.
        label: Short name of the skeleton.
        named: Landmarks by joint name, over the recognised ones.

    Raises:
        SkeletonError: If ``named`` holds an unknown joint or landmark.

    Example:
        >>> body = grow(["left_knee", "left_hip", "pelvis"])
        >>> body.names, body.parents
        (('pelvis', 'left_hip', 'left_knee'), (-1, 0, 1))
    """
    flat = recognise(names, [-1] * len(names), label, named)
    parents: dict[int, int] = {}
    for joint, landmark in enumerate(flat.landmarks):
        places = map(flat.find, NEAREST_PARENTS.get(landmark, ()))
        parents[joint] = next((place for place in places if place is not None), -1)
    order: list[int] = []
    while len(order) < len(names):  # NEAREST_PARENTS has no cycles, so each round places a joint
        order.append(next(j for j in parents if j not in order and (parents[j] < 0 or parents[j] in order)))
    return Skeleton(
        tuple(flat.names[joint] for joint in order),
        tuple(order.index(parents[joint]) if parents[joint] >= 0 else -1 for joint in order),
        tuple(flat.landmarks[joint] for joint in order),
        label,
    )
