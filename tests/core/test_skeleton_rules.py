"""The skeleton itself: what it refuses, and how places are found on another one."""

from __future__ import annotations

import pytest

from motioncast.core.skeleton import LANDMARKS, STAND_INS, Skeleton
from motioncast.core.skeletons import MRT15, SKELETONS, SOMOF13
from motioncast.errors import SkeletonError


@pytest.mark.parametrize(
    ("names", "parents", "landmarks", "complaint"),
    [
        (("a", "b"), (-1,), ("", ""), "2 names, 1 parents"),
        (("a", "b"), (-1, 0), ("",), "1 landmarks"),
        (("a", "a"), (-1, 0), ("", ""), '"a" twice'),
        (("a", "b"), (1, -1), ("", ""), '"a" has parent 1'),
        (("a", "b"), (-1, 1), ("", ""), '"b" has parent 1'),
        (("a", "b"), (-1, -2), ("", ""), '"b" has parent -2'),
    ],
)
def test_lists_that_do_not_fit_together_are_refused(names, parents, landmarks, complaint):
    with pytest.raises(SkeletonError, match=complaint):
        Skeleton(names, parents, landmarks, "odd")


def test_index_names_what_there_is():
    assert MRT15.index("neck") == 7
    with pytest.raises(SkeletonError, match=r'"mrt15" has no joint "tail"; it has pelvis, left_hip'):
        MRT15.index("tail")


def test_bones_are_pairs_of_joint_and_parent():
    assert SOMOF13.bones[:3] == ((1, 0), (2, 0), (3, 1))
    assert len(MRT15.bones) == len(MRT15) - 1


@pytest.mark.parametrize("skeleton", SKELETONS.values(), ids=SKELETONS)
def test_mirroring_twice_changes_nothing_and_swaps_sides(skeleton):
    partners = skeleton.mirror()
    assert [partners[partner] for partner in partners] == list(range(len(skeleton)))
    for joint, partner in enumerate(partners):
        ours, theirs = skeleton.landmarks[joint], skeleton.landmarks[partner]
        assert theirs == ours.replace("left", "!").replace("right", "left").replace("!", "right")


def test_a_joint_without_a_partner_is_its_own():
    assert Skeleton(("a", "b"), (-1, 0), ("left_hip", "pelvis")).mirror() == (0, 1)


@pytest.mark.parametrize("target", [MRT15, SOMOF13], ids=lambda skeleton: skeleton.label)
@pytest.mark.parametrize("source", SKELETONS.values(), ids=SKELETONS)
def test_known_skeletons_map_onto_those_of_the_models(source, target):
    lacking = {("somof13", "mrt15"): "head", ("upper9", "mrt15"): "left_hip", ("upper9", "somof13"): "left_hip"}
    if lack := lacking.get((source.label, target.label)):
        with pytest.raises(SkeletonError, match=f"no joint for .*{lack}"):
            target.map_from(source)
        return
    for landmark, group in zip(target.landmarks, target.map_from(source), strict=True):
        choices = [(landmark,), *STAND_INS.get(landmark, ())]
        assert tuple(source.landmarks[joint] for joint in group) in choices


def test_a_direct_joint_wins_over_a_stand_in():
    source = Skeleton(("l", "r", "p"), (-1, -1, -1), ("left_hip", "right_hip", "pelvis"))
    assert Skeleton(("root",), (-1,), ("pelvis",)).map_from(source) == ((2,),)


def test_a_stand_in_needs_all_its_places():
    one_ear = Skeleton(("ear", "nose"), (-1, -1), ("left_ear", "nose"))
    assert Skeleton(("head",), (-1,), ("head",)).map_from(one_ear) == ((1,),)


def test_all_missing_places_are_named_with_what_to_do():
    legs = Skeleton(("p", "x"), (-1, 0), ("pelvis", ""), "legs")
    with pytest.raises(
        SkeletonError, match=r'"legs" has no joint for neck, head, .*joints are p, x; .*--map FILE'
    ) as caught:
        Skeleton(("p", "n", "h", "w"), (-1, 0, 1, 1), ("pelvis", "neck", "head", "left_wrist")).map_from(legs)
    assert "left_wrist" in str(caught.value)


def test_joints_without_a_landmark_never_serve():
    blank = Skeleton(("a",), (-1,), ("",))
    assert blank.find("pelvis") is None
    assert blank.find("") is None


def test_stand_ins_are_landmarks():
    assert set(STAND_INS) <= set(LANDMARKS)
    assert {place for choices in STAND_INS.values() for places in choices for place in places} <= set(LANDMARKS)
    assert len(set(LANDMARKS)) == len(LANDMARKS)
