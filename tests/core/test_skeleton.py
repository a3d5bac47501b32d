"""The skeleton's own rules."""

from __future__ import annotations

import pytest

from motioncast.core.skeleton import LANDMARKS, STAND_INS, Skeleton
from motioncast.core.skeletons import MRT15
from motioncast.errors import SkeletonError


@pytest.mark.parametrize(
    ("names", "parents", "message"),
    [
        (("a", "a"), (-1, 0), '"a" twice'),
        (("a", "b"), (1, -1), "must come before"),
        (("a",), (-1, 0), "1 names, 2 parents"),
        (("a",), (0,), "must come before"),
    ],
)
def test_a_broken_tree_is_refused(names, parents, message):
    with pytest.raises(SkeletonError, match=message):
        Skeleton(names, parents, ("",) * len(names))


def test_a_missing_place_is_named_with_the_way_out():
    with pytest.raises(SkeletonError, match=r"no joint for pelvis, left_hip, .*--map"):
        MRT15.map_from(Skeleton(("neck",), (-1,), ("neck",)))
    with pytest.raises(SkeletonError, match='no joint "tail"'):
        MRT15.index("tail")


def test_stand_ins_are_landmarks():
    for place, choices in STAND_INS.items():
        assert {place, *(one for choice in choices for one in choice)} <= set(LANDMARKS)


def test_mirror_twice_is_nothing():
    partner = MRT15.mirror()
    assert [partner[joint] for joint in partner] == list(range(15))
    assert MRT15.names[partner[MRT15.index("left_knee")]] == "right_knee"
