"""Joints recognised by name: the same name is not the same point."""

from __future__ import annotations

import pytest

from motioncast.core.skeletons import MRT15, NEAREST_PARENTS, SKELETONS, SOMOF13, UPPER9, grow, recognise
from motioncast.errors import SkeletonError

SIDES = ("Left", "Right")
HUMANOID = ["Hips", "Spine", "Spine1", "Spine2", "Neck", "Head"] + [
    side + part for side in SIDES for part in ("Shoulder", "Arm", "ForeArm", "Hand", "UpLeg", "Leg", "Foot", "ToeBase")
]
LISTS = {
    "mixamo": [f"mixamorig:{name}" for name in [*HUMANOID, "HeadTop_End", "LeftToe_End", "RightToe_End"]],
    "motionbuilder": [f"Actor1:{name}" for name in HUMANOID],
    "cgspeed": [
        "Hips", "LHipJoint", "LeftUpLeg", "LeftLeg", "LeftFoot", "LeftToeBase", "LeftToeBase_end", "RHipJoint",
        "RightUpLeg", "RightLeg", "RightFoot", "RightToeBase", "RightToeBase_end", "LowerBack", "Spine", "Spine1",
        "Neck", "Neck1", "Head", "Head_end", "LeftShoulder", "LeftArm", "LeftForeArm", "LeftHand", "LeftFingerBase",
        "LeftHandIndex1", "LeftHandIndex1_end", "LThumb", "LThumb_end", "RightShoulder", "RightArm", "RightForeArm",
        "RightHand", "RightFingerBase", "RightHandIndex1", "RightHandIndex1_end", "RThumb", "RThumb_end",
    ],
    "xsens": ["Pelvis", "L5", "L3", "T12", "T8", "Neck", "Head"] + [
        side + part for side in SIDES
        for part in ("Shoulder", "UpperArm", "Forearm", "Hand", "UpperLeg", "LowerLeg", "Foot", "Toe")
    ],
    "mvn": ["Hips", "Chest", "Chest2", "Chest3", "Chest4", "Neck", "Head"] + [
        side + part for side in SIDES
        for part in ("Collar", "Shoulder", "Elbow", "Wrist", "Hip", "Knee", "Ankle", "Toe")
    ],
    "unreal": ["pelvis", "spine_01", "spine_02", "spine_03", "neck_01", "head"] + [
        f"{part}_{side}" for side in "lr"
        for part in ("clavicle", "upperarm", "lowerarm", "hand", "thigh", "calf", "foot", "ball")
    ],
    "biped": ["Bip01 Pelvis", "Bip01 Spine", "Bip01 Spine1", "Bip01 Neck", "Bip01 Head"] + [
        f"Bip01 {side} {part}" for side in "LR"
        for part in ("Clavicle", "UpperArm", "Forearm", "Hand", "Thigh", "Calf", "Foot", "Toe0")
    ],
}  # fmt: skip


def landmark(names, joint):
    return recognise(names, [-1] * len(names)).landmarks[names.index(joint)]


@pytest.mark.parametrize("family", LISTS)
def test_every_family_serves_the_models(family):
    skeleton = recognise(LISTS[family], [-1] * len(LISTS[family]))
    for wanted in (MRT15, SOMOF13):
        assert all(len(group) >= 1 for group in wanted.map_from(skeleton))
    assert skeleton.mirror() != tuple(range(len(skeleton)))


@pytest.mark.parametrize("name", sorted(set(SKELETONS) - {"upper9"}))  # it has no legs
def test_known_skeletons_serve_somof_and_are_recognised_again(name):
    skeleton = SKELETONS[name]
    assert len(SOMOF13.map_from(skeleton)) == 13
    assert set(grow(skeleton.names).landmarks) >= {"left_knee", "right_wrist"}


def test_the_same_name_is_another_point():
    assert landmark(LISTS["mixamo"], "mixamorig:LeftFoot") == "left_ankle"
    assert recognise(["root", "lfemur", "ltibia", "lfoot"], [-1, 0, 1, 2]).landmarks[3] == "left_foot"
    assert landmark(list(SKELETONS["h36m17"].names), "LFoot") == "left_ankle"
    assert landmark(LISTS["mixamo"], "mixamorig:LeftShoulder") == "left_collar"
    assert landmark(LISTS["mvn"], "LeftShoulder") == "left_shoulder"
    assert landmark(LISTS["cgspeed"], "Head") == "upper_neck"
    assert landmark(LISTS["cgspeed"], "Head_end") == "head"
    assert landmark(LISTS["cgspeed"], "LowerBack") == ""


def test_grown_skeletons_hang_together_and_have_parents_first():
    skeleton = grow(list(reversed(SOMOF13.names)))
    assert skeleton.parents.count(-1) == 1
    assert grow(["left_wrist", "button", "left_elbow"]).parents[-2:] == (-1, 1)
    assert grow(["left_wrist", "button", "left_elbow"]).names == ("button", "left_elbow", "left_wrist")


def test_no_landmark_hangs_on_itself():
    def above(place, trail=()):
        assert place not in trail, (place, trail)
        for parent in NEAREST_PARENTS.get(place, ()):
            above(parent, (*trail, place))

    assert grow(["nose", "head"]).names == ("head", "nose")
    for place in ("left_hip", "right_hip", "neck", "left_fingers", "nose", "head_top", "left_toe"):
        above(place)


def test_the_user_wins_over_the_table():
    skeleton = recognise(["a", "b"], [-1, 0], named={"a": "pelvis", "b": "neck"})
    assert skeleton.landmarks == ("pelvis", "neck")
    with pytest.raises(SkeletonError, match='names the joint "c"'):
        recognise(["a"], [-1], named={"c": "pelvis"})
    with pytest.raises(SkeletonError, match='landmark "tail"'):
        recognise(["a"], [-1], named={"a": "tail"})


def test_every_whole_body_serves_the_upper_body():
    for name in set(SKELETONS) - {"somof13"}:  # which has no head
        assert len(UPPER9.map_from(SKELETONS[name])) == 9
    assert UPPER9.mirror() == (0, 1, 5, 6, 7, 2, 3, 4, 8)
