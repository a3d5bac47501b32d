"""The skeleton: joint names, the tree, and which place of the body each joint stands for."""

from __future__ import annotations

from dataclasses import dataclass

from motioncast.errors import SkeletonError


@dataclass(frozen=True, slots=True)
class Skeleton:
    """Joint names, the tree that connects them, and the anatomical landmark that each joint marks.

    The same name does not always mean the same point: CMU's ``lfemur`` is the knee (a bone's *end*), a BVH
    file's ``LeftUpLeg`` the hip (a bone's *start*). So skeletons are mapped by ``landmarks``, never by index
    and never by name alone.

    Attributes:
        names: One name a joint, unique.
        parents: Index of each joint's parent, -1 for roots; a parent comes before its children.
        landmarks: Anatomical place of each joint, such as ``left_knee``; empty where it has no name.
        label: A short name of the whole skeleton.

    Raises:
        SkeletonError: If the lists do not fit together.

    Example:
        >>> arm = Skeleton(("shoulder", "elbow"), (-1, 0), ("left_shoulder", "left_elbow"), "arm")
        >>> arm.index("elbow"), arm.find("left_shoulder"), arm.bones
        (1, 0, ((1, 0),))
    """

    names: tuple[str, ...]
    parents: tuple[int, ...]
    landmarks: tuple[str, ...]
    label: str = "unnamed"

    def __post_init__(self) -> None:
        count = len(self.names)
        if len(self.parents) != count or len(self.landmarks) != count:
            raise SkeletonError(
                f'skeleton "{self.label}" has {count} names, {len(self.parents)} parents and '
                f"{len(self.landmarks)} landmarks; give one of each per joint"
            )
        if len(set(self.names)) != count:
            twice = next(name for name in self.names if self.names.count(name) > 1)
            raise SkeletonError(f'skeleton "{self.label}" names the joint "{twice}" twice; names must be unique')
        for joint, parent in enumerate(self.parents):
            if not -1 <= parent < joint:
                raise SkeletonError(
                    f'joint "{self.names[joint]}" has parent {parent}; a parent must come before its children'
                )

    def __len__(self) -> int:
        return len(self.names)

    @property
    def bones(self) -> tuple[tuple[int, int], ...]:
        """Pairs (joint, parent) of every joint that has a parent."""
        return tuple((joint, parent) for joint, parent in enumerate(self.parents) if parent >= 0)

    def index(self, name: str) -> int:
        """Index of the joint of that name.

        Raises:
            SkeletonError: If there is none.
        """
        try:
            return self.names.index(name)
        except ValueError:
            known = ", ".join(self.names)
            raise SkeletonError(f'skeleton "{self.label}" has no joint "{name}"; it has {known}') from None

    def find(self, landmark: str) -> int | None:
        """Index of the joint that marks this landmark, or None."""
        return self.landmarks.index(landmark) if landmark and landmark in self.landmarks else None

    def mirror(self) -> tuple[int, ...]:
        """For each joint the index of its partner on the other side (itself for joints of the middle).

        Example:
            >>> Skeleton(("a", "b"), (-1, -1), ("left_hip", "right_hip")).mirror()
            (1, 0)
        """
        swap = {"left": "right", "right": "left"}
        partners = []
        for joint, landmark in enumerate(self.landmarks):
            side, _, place = landmark.partition("_")
            other = self.find(f"{swap[side]}_{place}") if side in swap else None
            partners.append(joint if other is None else other)
        return tuple(partners)

    def map_from(self, source: Skeleton) -> tuple[tuple[int, ...], ...]:
        """For each joint of this skeleton the joints of ``source`` whose mean marks the same place.

        Usually that is one joint; a landmark that the source lacks is served by a close stand-in
        (``STAND_INS``: the pelvis of a skeleton without one lies between its hips).

        Raises:
            SkeletonError: If the source lacks a place, naming all that are missing.

        Example:
            >>> legs = Skeleton(("root", "hip"), (-1, 0), ("pelvis", "left_hip"))
            >>> other = Skeleton(("lhipjoint", "rhipjoint"), (-1, -1), ("left_hip", "right_hip"))
            >>> legs.map_from(other)
            ((0, 1), (0,))
        """
        found: list[tuple[int, ...]] = []
        missing: list[str] = []
        for name, landmark in zip(self.names, self.landmarks, strict=True):
            for places in ((landmark,), *STAND_INS.get(landmark, ())):
                indices = tuple(index for index in map(source.find, places) if index is not None)
                if len(indices) == len(places):
                    found.append(indices)
                    break
            else:
                missing.append(landmark or f'"{name}"')
        if missing:
            raise SkeletonError(
                f'skeleton "{source.label}" has no joint for {", ".join(missing)}; its joints are '
                f'{", ".join(source.names)}; name them with --map FILE (one "joint = landmark" a line)'
            )
        return tuple(found)


STAND_INS: dict[str, tuple[tuple[str, ...], ...]] = {
    "pelvis": (("left_hip", "right_hip"), ("lower_spine",)),
    "neck": (("neck_base",), ("left_shoulder", "right_shoulder"), ("upper_spine",)),
    "neck_base": (("neck",), ("left_shoulder", "right_shoulder"), ("upper_spine",)),
    "head": (
        ("upper_neck", "head_top"), ("left_ear", "right_ear"), ("nose",), ("head_top",), ("upper_neck",),
    ),
    "head_top": (("head",),),
    "nose": (("upper_neck",), ("neck", "head")),
    "middle_spine": (
        ("lower_spine", "upper_spine"), ("pelvis", "neck_base"), ("pelvis", "neck"),
        ("left_hip", "right_hip", "left_shoulder", "right_shoulder"),
    ),
    "upper_neck": (("neck", "head"), ("head",)),
    "left_wrist": (("left_hand",),),
    "right_wrist": (("right_hand",),),
    "left_ankle": (("left_heel",),),
    "right_ankle": (("right_heel",),),
    "left_foot": (("left_toe",),),
    "right_foot": (("right_toe",),),
    "left_toe": (("left_foot",),),
    "right_toe": (("right_foot",),),
    "left_hand": (("left_wrist",),),
    "right_hand": (("right_wrist",),),
    "left_shoulder": (("left_collar",),),
    "right_shoulder": (("right_collar",),),
}  # fmt: skip
"""Places that may serve for one that a skeleton lacks, nearest first; several places mean their middle."""

LANDMARKS: tuple[str, ...] = (
    "pelvis", "lower_spine", "middle_spine", "upper_spine", "neck_base", "neck", "upper_neck", "head", "head_top",
    "nose",
    *(
        f"{side}_{place}"
        for side in ("left", "right")
        for place in (
            "hip", "knee", "ankle", "heel", "foot", "toe", "collar", "shoulder", "elbow", "wrist", "hand",
            "fingers", "thumb", "eye", "ear",
        )
    ),
)  # fmt: skip
"""Every landmark that a joint can mark.

``head`` is the middle of the head (the end of CMU's head bone), ``upper_neck`` the base of the skull, ``neck_base``
the end of the thorax; ``foot`` is the ball of the foot, ``toe`` the tip; ``hand`` the knuckles, ``fingers`` the tips.
"""
