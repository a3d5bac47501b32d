"""The scene: people moving in one world, on one clock."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from motioncast.core.scene_object import SceneObject
from motioncast.core.skeleton import Skeleton
from motioncast.errors import SceneError


@dataclass(frozen=True, slots=True, eq=False)
class Scene:
    """People moving in one world, on one clock; metres, seconds, z up.

    Attributes:
        positions: World positions of the joints, ``(time, people, joints, 3)``, float32; zero where not observed.
        skeleton: The skeleton that all people share.
        fps: Frames a second.
        observed: Which joints were seen, ``(time, people, joints)``, bool. Default: all of them.
        people: One id a person. Default: ``person 1``, ``person 2``, ...
        rotations: Local rotations, ``(time, people, joints, 4)`` quaternions wxyz, where they are known: a
            joint's rotation turns its children (BVH's convention).
        offsets: Rest offset of each joint from its parent, ``(people, joints, 3)``, where rotations are known.
        source: Where the motion comes from.
        remarks: What the reader inferred or mended, one sentence each; said aloud to the user.
        objects: What stands or moves around the people.
        floor_m: Height of the floor, where it is known.

    Raises:
        SceneError: If shapes disagree, or an observed position is not finite.

    Example:
        >>> from motioncast.core.skeletons import MRT15
        >>> scene = Scene(np.zeros((30, 2, 15, 3), np.float32), MRT15, fps=15)
        >>> scene.people, scene.duration_s, scene[:15].frames
        (('person 1', 'person 2'), 2.0, 15)
    """

    positions: np.ndarray
    skeleton: Skeleton
    fps: float
    observed: np.ndarray = None  # pyright: ignore[reportAssignmentType]  # filled on construction
    people: tuple[str, ...] = ()
    rotations: np.ndarray | None = None
    offsets: np.ndarray | None = None
    source: str = ""
    remarks: tuple[str, ...] = ()
    objects: tuple[SceneObject, ...] = ()
    floor_m: float | None = None

    def __post_init__(self) -> None:
        with np.errstate(over="ignore"):  # what float32 cannot hold becomes infinite and is refused below
            positions = np.asarray(self.positions, np.float32)
        if positions.ndim != 4 or positions.shape[-1] != 3 or positions.shape[2] != len(self.skeleton):
            raise SceneError(
                f"positions have shape {positions.shape}; expected (time, people, {len(self.skeleton)} joints, 3)"
            )
        observed = np.ones(positions.shape[:3], bool) if self.observed is None else np.asarray(self.observed, bool)
        if observed.shape != positions.shape[:3]:
            raise SceneError(f"the mask has shape {observed.shape}; expected {positions.shape[:3]}")
        if not (np.isfinite(self.fps) and self.fps > 0):
            raise SceneError(f"the frame rate is {self.fps}; expected a positive number of frames a second")
        finite = np.isfinite(positions)
        if not finite.all() and not np.all(finite, -1)[observed].all():
            time, person, joint = np.argwhere(observed & ~np.all(finite, -1))[0]
            raise SceneError(
                f'the position of "{self.skeleton.names[joint]}" of person {person + 1} in frame {time} is not a '
                "finite number; mark it as not observed or mend it"
            )
        for name, given, wanted in (
            ("rotations", self.rotations, (*positions.shape[:3], 4)),
            ("offsets", self.offsets, (*positions.shape[1:],)),
        ):
            if given is not None and given.shape != wanted:
                raise SceneError(f"the {name} have shape {given.shape}; expected {wanted}")
        for thing in self.objects:
            if thing.frames not in (None, len(positions)):
                raise SceneError(
                    f'object "{thing.name}" moves for {thing.frames} frames and the people for {len(positions)}; '
                    "give it a place a frame, or one place"
                )
        people = self.people or tuple(f"person {number + 1}" for number in range(positions.shape[1]))
        if len(people) != positions.shape[1] or len(set(people)) != len(people):
            raise SceneError(f"{len(people)} ids came for {positions.shape[1]} people; give each its own")
        set_field = object.__setattr__
        whole = observed.all()  # as most are: a copy takes a tenth of the time of a choice
        kept = positions.copy() if whole else np.where(observed[..., None], positions, np.float32(0))
        set_field(self, "positions", kept)
        set_field(self, "observed", observed)
        set_field(self, "people", tuple(people))
        set_field(self, "fps", float(self.fps))

    @property
    def frames(self) -> int:
        """Number of frames."""
        return len(self.positions)

    @property
    def duration_s(self) -> float:
        """Length in seconds: frames over frame rate."""
        return self.frames / self.fps

    def __getitem__(self, frames: slice) -> Scene:
        """The same scene with only these frames."""
        rotations = None if self.rotations is None else self.rotations[frames]
        return replace(
            self,
            positions=self.positions[frames],
            observed=self.observed[frames],
            rotations=rotations,
            objects=tuple(thing[frames] for thing in self.objects),
        )

    def select(self, people: Sequence[str]) -> Scene:
        """The same scene with only these people, in this order.

        Raises:
            SceneError: If one of them is not there.
        """
        for person in people:
            if person not in self.people:
                raise SceneError(f'there is no person "{person}"; the scene has {", ".join(self.people)}')
        rows = [self.people.index(person) for person in people]
        return replace(
            self,
            positions=self.positions[:, rows],
            observed=self.observed[:, rows],
            people=tuple(people),
            rotations=None if self.rotations is None else self.rotations[:, rows],
            offsets=None if self.offsets is None else self.offsets[rows],
        )

    def on(self, skeleton: Skeleton) -> Scene:
        """The same people on another skeleton, joint by joint of the same anatomical place.

        A joint that stands between several of this scene's joints is seen where all of them are.

        Raises:
            SkeletonError: If this scene's skeleton lacks a place.
        """
        groups = skeleton.map_from(self.skeleton)
        first = [group[0] for group in groups]
        positions, observed = self.positions[:, :, first], self.observed[:, :, first]
        for joint, group in enumerate(groups):
            if len(group) > 1:
                positions[:, :, joint] = self.positions[:, :, list(group)].mean(2)
                observed[:, :, joint] = self.observed[:, :, list(group)].all(2)
        return replace(self, positions=positions, observed=observed, skeleton=skeleton, rotations=None, offsets=None)


def join(scenes: Sequence[Scene]) -> Scene:
    """One scene of several takes of one world and one clock, a person or more each.

    Shorter takes end early: their people are not observed afterwards. Ids that occur twice get a number.

    Raises:
        SceneError: If frame rates or skeletons differ, or there is no scene.
    """
    if not scenes:
        raise SceneError("no motion came; give at least one file")
    first = scenes[0]
    for other in scenes[1:]:
        if other.fps != first.fps:
            raise SceneError(
                f"{first.source} has {first.fps:g} frames a second and {other.source} {other.fps:g}; "
                "people of one scene share one clock (override a wrong header with --fps)"
            )
        if (other.skeleton.names, other.skeleton.parents) != (first.skeleton.names, first.skeleton.parents):
            raise SceneError(
                f"{first.source} and {other.source} have different joints or trees; bring them to one skeleton first"
            )
    frames = max(scene.frames for scene in scenes)

    def padded(array: np.ndarray) -> np.ndarray:
        return np.concatenate([array, np.zeros((frames - len(array), *array.shape[1:]), array.dtype)])

    ids = [person for scene in scenes for person in scene.people]
    people = [
        person if ids.count(person) == 1 else f"{person} ({ids[: number + 1].count(person)})"
        for number, person in enumerate(ids)
    ]
    turned = [scene.rotations for scene in scenes if scene.rotations is not None]
    offsets = [scene.offsets for scene in scenes if scene.offsets is not None]
    whole = len(turned) == len(offsets) == len(scenes)
    return Scene(
        np.concatenate([padded(scene.positions) for scene in scenes], 1),
        first.skeleton,
        first.fps,
        np.concatenate([padded(scene.observed) for scene in scenes], 1),
        tuple(people),
        np.concatenate([padded(rotations) for rotations in turned], 1) if whole else None,
        np.concatenate(offsets) if whole else None,
        ", ".join(dict.fromkeys(scene.source for scene in scenes)),
        tuple(dict.fromkeys(remark for scene in scenes for remark in scene.remarks)),
        tuple(thing for scene in scenes for thing in scene.objects),
        next((scene.floor_m for scene in scenes if scene.floor_m is not None), None),
    )
