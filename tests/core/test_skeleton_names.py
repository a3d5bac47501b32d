"""Joint names of many makers: each joint must be found, and none at a wrong place of the body."""

from __future__ import annotations

import numpy as np
import pytest

from motioncast.core.skeleton import LANDMARKS
from motioncast.core.skeletons import CMU31, COCO17, DIALECTS, H36M17, MRT15, SMPL22, SMPL24, SOMOF13, plain, recognise
from motioncast.errors import SkeletonError


def sided(names: str, left: str = "Left", right: str = "Right", prefix: str = "") -> list[str]:
    """Names with blanks for commas, ``*`` for either side."""
    found = []
    for name in names.split(", "):
        found += [name.replace("*", left), name.replace("*", right)] if "*" in name else [name]
    return [prefix + name for name in found]


MIXAMO = (
    "Hips, Spine, Spine1, Spine2, Neck, Head, HeadTop_End, *Shoulder, *Arm, *ForeArm, *Hand, *HandThumb1, "
    "*HandThumb2, *HandThumb3, *HandThumb4, *HandIndex1, *HandIndex2, *HandIndex3, *HandIndex4, *HandMiddle1, "
    "*HandRing1, *HandPinky1, *UpLeg, *Leg, *Foot, *ToeBase, *Toe_End"
)
HUMAN_IK = (
    "Reference, Hips, *UpLeg, *Leg, *Foot, *ToeBase, Spine, Spine1, Spine2, Spine3, Neck, Head, *Shoulder, *Arm, "
    "*ForeArm, *Hand, *HandThumb1, *HandIndex1"
)
SMPL_SHORT = (
    "Pelvis, *_Hip, Spine1, *_Knee, Spine2, *_Ankle, Spine3, *_Foot, Neck, *_Collar, Head, *_Shoulder, *_Elbow, "
    "*_Wrist, *_Hand"
)
SMPL_LONG = (
    "pelvis, *_hip, spine1, *_knee, spine2, *_ankle, spine3, *_foot, neck, *_collar, head, *_shoulder, *_elbow, "
    "*_wrist, *_hand"
)
IMAGE = "Nose, *Eye, *Ear, *Shoulder, *Elbow, *Wrist, *Hip, *Knee, *Ankle"

# For each maker: its joint names, the joint at the right knee, ankle, shoulder, elbow and wrist, and the joints at
# the pelvis, neck and head of MRT15.
MAKERS: dict[str, tuple[list[str], str, str, str, str]] = {
    "mixamo": (
        sided(MIXAMO, prefix="mixamorig:"), "Leg Foot Arm ForeArm Hand", "Hips", "Neck", "Head HeadTop_End"),
    "mixamo again": (
        sided(MIXAMO, prefix="mixamorig1:"), "Leg Foot Arm ForeArm Hand", "Hips", "Neck", "Head HeadTop_End"),
    "motionbuilder": (sided(HUMAN_IK), "Leg Foot Arm ForeArm Hand", "Hips", "Neck", "Head"),
    "maya": (sided(HUMAN_IK, prefix="Character1_"), "Leg Foot Arm ForeArm Hand", "Hips", "Neck", "Head"),
    "cmu by cgspeed": (
        ["Hips", "LHipJoint", "LeftUpLeg", "LeftLeg", "LeftFoot", "LeftToeBase", "LeftToeBase_end", "RHipJoint",
         "RightUpLeg", "RightLeg", "RightFoot", "RightToeBase", "RightToeBase_end", "LowerBack", "Spine", "Spine1",
         "Neck", "Neck1", "Head", "Head_end", "LeftShoulder", "LeftArm", "LeftForeArm", "LeftHand",
         "LeftFingerBase", "LeftHandIndex1", "LeftHandIndex1_end", "LThumb", "LThumb_end", "RightShoulder",
         "RightArm", "RightForeArm", "RightHand", "RightFingerBase", "RightHandIndex1", "RightHandIndex1_end",
         "RThumb", "RThumb_end"],
        "Leg Foot Arm ForeArm Hand", "Hips", "Neck1", "Head_end"),
    "xsens": (
        sided("Pelvis, L5, L3, T12, T8, Neck, Head, * Shoulder, * Upper Arm, * Forearm, * Hand, * Upper Leg, "
              "* Lower Leg, * Foot, * Toe"),
        "LowerLeg Foot UpperArm Forearm Hand", "Pelvis", "Neck", "Head"),
    "xsens bvh": (
        sided("Hips, Chest, Chest2, Chest3, Chest4, Neck, Head, Head_end, *Collar, *Shoulder, *Elbow, *Wrist, "
              "*Wrist_end, *Hip, *Knee, *Ankle, *Toe, *Toe_end"),
        "Knee Ankle Shoulder Elbow Wrist", "Hips", "Neck", "Head Head_end"),
    "smpl": (sided(SMPL_LONG, "left", "right"), "knee ankle shoulder elbow wrist", "pelvis", "neck", "head"),
    "smpl short": (sided(SMPL_SHORT, "L", "R"), "Knee Ankle Shoulder Elbow Wrist", "Pelvis", "Neck", "Head"),
    "smpl in simulators": (
        sided("Pelvis, *_Hip, *_Knee, *_Ankle, *_Toe, Torso, Spine, Chest, Neck, Head, *_Thorax, *_Shoulder, "
              "*_Elbow, *_Wrist, *_Hand", "L", "R"),
        "Knee Ankle Shoulder Elbow Wrist", "Pelvis", "Neck", "Head"),
    "openpose": (
        sided("Nose, Neck, *Shoulder, *Elbow, *Wrist, MidHip, *Hip, *Knee, *Ankle, *Eye, *Ear, *BigToe, *SmallToe, "
              "*Heel", "R", "L"),
        "Knee Ankle Shoulder Elbow Wrist", "MidHip", "Neck", "LEar REar"),
    "coco": (sided(IMAGE, "left_", "right_"), "Knee Ankle Shoulder Elbow Wrist", "left_Hip right_Hip",
             "left_Shoulder right_Shoulder", "left_Ear right_Ear"),
    "coco short": (sided(IMAGE, "L", "R"), "Knee Ankle Shoulder Elbow Wrist", "LHip RHip", "LShoulder RShoulder",
                   "LEar REar"),
    "h36m": (list(H36M17.names), "Knee Foot Shoulder Elbow Wrist", "Hip", "Thorax", "Nose"),
    "h36m of lifters": (
        sided("root, *Hip, *Knee, *Ankle, torso, neck, nose, head, *Shoulder, *Elbow, *Wrist", "L", "R"),
        "Knee Ankle Shoulder Elbow Wrist", "root", "neck", "nose"),
    "h36m of toolboxes": (
        sided("root, *_hip, *_knee, *_foot, spine, thorax, neck_base, head, *_shoulder, *_elbow, *_wrist",
              "left", "right"),
        "knee foot shoulder elbow wrist", "root", "thorax", "neck_base"),
    "h36m bvh": (
        sided("Hips, *UpLeg, *Leg, *Foot, *ToeBase, Spine, Spine1, Neck, Head, *Shoulder, *Arm, *ForeArm, *Hand, "
              "*HandThumb, *_Wrist_End"),
        "Leg Foot Arm ForeArm Hand", "Hips", "Neck", "Head"),
    "unity": (
        sided("Hips, *UpperLeg, *LowerLeg, *Foot, *Toes, Spine, Chest, UpperChest, Neck, Head, *Shoulder, *UpperArm, "
              "*LowerArm, *Hand"),
        "LowerLeg Foot UpperArm LowerArm Hand", "Hips", "Neck", "Head"),
    "rokoko": (
        sided("Hips, Spine1, Spine2, Spine3, Spine4, Neck, Head, *Shoulder, *Arm, *ForeArm, *Hand, *Thigh, *Shin, "
              "*Foot, *Toe"),
        "Shin Foot Arm ForeArm Hand", "Hips", "Neck", "Head"),
    "acclaim": (list(CMU31.names), "femur tibia clavicle humerus wrist", "root", "lowerneck", "head"),
}  # fmt: skip


@pytest.mark.parametrize("names", [maker[0] for maker in MAKERS.values()], ids=MAKERS)
@pytest.mark.parametrize("target", [MRT15, SOMOF13], ids=lambda skeleton: skeleton.label)
def test_every_place_that_a_model_needs_is_found(names, target):
    groups = target.map_from(recognise(names, [-1] * len(names)))  # raises where one is missing
    limbs = [group for group, place in zip(groups, target.landmarks, strict=True) if "_" in place]
    assert len(limbs) == 12
    assert len(set(limbs)) == 12


@pytest.mark.parametrize(("names", "limbs", "pelvis", "neck", "head"), MAKERS.values(), ids=MAKERS)
def test_places_are_the_right_ones(names, limbs, pelvis, neck, head):
    groups = dict(zip(MRT15.landmarks, MRT15.map_from(recognise(names, [-1] * len(names))), strict=True))

    def found(landmark: str) -> list[str]:
        return sorted(plain(names[joint]) for joint in groups[landmark])

    assert found("pelvis") == sorted(map(plain, pelvis.split()))
    assert found("neck") == sorted(map(plain, neck.split()))
    assert found("head") == sorted(map(plain, head.split()))
    for landmark, limb in zip(("knee", "ankle", "shoulder", "elbow", "wrist"), limbs.split(), strict=True):
        for side in ("left", "right"):
            (name,) = found(f"{side}_{landmark}")
            assert name in (f"{side}{limb}".lower(), f"{side[0]}{limb}".lower())


@pytest.mark.parametrize("names", [maker[0] for maker in MAKERS.values()], ids=MAKERS)
def test_sides_are_never_swapped_and_no_landmark_comes_twice(names):
    landmarks = recognise(names, [-1] * len(names)).landmarks
    known = [landmark for landmark in landmarks if landmark]
    assert len(set(known)) == len(known)
    for name, landmark in zip(names, landmarks, strict=True):
        key = plain(name)
        if landmark.startswith("left_"):
            assert key.startswith("l")
        elif landmark.startswith("right_"):
            assert key.startswith("r")


@pytest.mark.parametrize("names", [maker[0] for maker in MAKERS.values()], ids=MAKERS)
def test_the_order_of_joints_does_not_matter(names):
    there = dict(zip(names, recognise(names, [-1] * len(names)).landmarks, strict=True))
    back = names[::-1]
    again = dict(zip(back, recognise(back, [-1] * len(back)).landmarks, strict=True))
    limbs = {place for place in MRT15.landmarks if place not in ("neck", "head")}
    for name in names:
        if there[name] in limbs or again[name] in limbs:
            assert there[name] == again[name]


@pytest.mark.data
def test_the_places_of_ball_players_have_human_distances(shared):
    arrays = np.load(shared / "extra" / "extra_ballplay.npz", allow_pickle=False)
    names = [str(name) for name in arrays["joint_names"]]
    skeleton = recognise(names, arrays["parents"].tolist())
    MRT15.map_from(skeleton)
    relative = arrays["bp_001_rel"].astype(float)
    relative = np.concatenate([np.zeros_like(relative[:, :1]), relative], 1)  # the root comes apart

    def distance(a: str, b: str) -> float:
        one, two = skeleton.find(a), skeleton.find(b)
        assert one is not None
        assert two is not None
        return float(np.median(np.linalg.norm(relative[:, one] - relative[:, two], axis=-1)))

    thigh = distance("left_hip", "left_knee")
    for a, b, share in (
        ("right_hip", "right_knee", 1.0), ("left_knee", "left_ankle", 1.0), ("left_shoulder", "left_elbow", 0.7),
        ("left_elbow", "left_wrist", 0.65), ("pelvis", "neck", 1.25), ("left_shoulder", "right_shoulder", 0.9),
    ):  # fmt: skip
        assert distance(a, b) == pytest.approx(share * thigh, rel=0.25)


def test_dialects_name_landmarks_only():
    for dialect, table in DIALECTS.items():
        assert {place for place in table.values() if place} <= set(LANDMARKS), dialect
        assert all(key == plain(key) for key in table), dialect


def test_the_same_name_can_mean_a_start_or_an_end():
    assert recognise(["lfemur", "ltibia", "lclavicle"], [-1, 0, -1]).landmarks == (
        "left_knee", "left_ankle", "left_shoulder")  # fmt: skip
    assert recognise(["LeftUpLeg", "LeftLeg", "LeftShoulder"], [-1, 0, -1]).landmarks == (
        "left_hip", "left_knee", "left_collar")  # fmt: skip


def test_known_skeletons_recognise_their_own_names():
    for skeleton in (MRT15, SOMOF13, COCO17):
        assert recognise(skeleton.names, skeleton.parents).landmarks == skeleton.landmarks
    assert SMPL24.names[:22] == SMPL22.names
    assert SMPL22.landmarks[15] == "upper_neck"  # SMPL's head joint is the base of the skull


def test_named_joints_win():
    body = recognise(["Hips", "LeftUpLeg", "blob"], [-1, 0, 0], named={"blob": "left_hip", "Hips": ""})
    assert body.landmarks == ("", "", "left_hip")


@pytest.mark.parametrize(
    ("named", "complaint"),
    [
        ({"tail": "pelvis"}, '"tail", which is not in Hips, Spine'),
        ({"Hips": "tail"}, 'landmark "tail"; use one of pelvis'),
    ],
)
def test_maps_with_unknown_words_are_refused(named, complaint):
    with pytest.raises(SkeletonError, match=complaint):
        recognise(["Hips", "Spine"], [-1, 0], named=named)


def test_strange_names_are_recognised_as_nothing():
    assert recognise(["", "日本", "joint_17", ":"], [-1, 0, 1, 2]).landmarks == ("",) * 4
