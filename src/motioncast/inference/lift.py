"""From a scene to a model's joints and rate, and from the answer back to the scene's own.

A model knows some joints at one frame rate. What it is asked about has another skeleton and another rate; joints
that the model does not know are carried rigidly by those that it knows, and bones keep their length.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from motioncast.core.resample import LOBES, resample, sample
from motioncast.core.scene import Scene
from motioncast.core.skeleton import Skeleton
from motioncast.inference.turns import best_turns

ANCHORS = 3
"""Known joints that carry an unknown one."""

TORSO = ("pelvis", "left_hip", "right_hip", "neck", "left_shoulder", "right_shoulder")
TORSO_SHARE = 0.02
"""How much the torso's turn counts where the carrying joints leave it open, as about a straight arm."""

CONSTANT = 0.02
"""A bone is rigid if its length varies by less than this share of it."""


def needed_frames(history: int, model_fps: float, fps: float) -> int:
    """Frames of a scene that can influence the answer: the model's history and the filter's reach before it."""
    step = fps / model_fps
    return int(np.ceil((history - 1) * step)) + reach(step) + 2


def reach(step: float) -> int:
    """Frames on either side that the resampling filter reads, for moments ``step`` frames apart."""
    return int(np.ceil(LOBES * max(1.0, step)))


def lower(scene: Scene, skeleton: Skeleton, fps: float, history: int) -> Scene:
    """The last ``history`` frames of a scene at a model's rate, on its skeleton.

    Frames before the scene begins are not observed.
    """
    asked = resample(scene.on(skeleton), fps)[-history:]
    missing = history - asked.frames
    if not missing:
        return asked
    empty = np.zeros((missing, *asked.observed.shape[1:]), bool)
    first = np.repeat(asked.positions[:1], missing, 0)
    return Scene(
        np.concatenate([first, asked.positions]), skeleton, fps, np.concatenate([empty, asked.observed]), asked.people
    )


def last_pose(scene: Scene) -> np.ndarray:
    """Where each joint was seen last, ``(people, joints, 3)``; one never seen stands amid those that were."""
    seen = scene.observed
    when = scene.frames - 1 - seen[::-1].argmax(0)
    pose = np.take_along_axis(scene.positions, when[None, ..., None], 0)[0].astype(np.float64)
    ever = np.asarray(seen.any(0))[..., None]
    middle = (pose * ever).sum(1, keepdims=True) / np.maximum(ever.sum(1, keepdims=True), 1)
    return np.where(ever, pose, middle)


def between_sightings(observed: np.ndarray) -> np.ndarray:
    """The mask with gaps closed that have a sighting before and after, ``(time, people, joints)``."""
    return np.maximum.accumulate(observed) & np.maximum.accumulate(observed[::-1])[::-1]


def between_frames(whole: np.ndarray, now: int, step: float, frames: int) -> np.ndarray:
    """A model's answer at the frames of the scene, without a step where history and answer meet.

    Args:
        whole: History and answer, ``(time, ...)`` at the model's rate.
        now: The last frame of history in it.
        step: Frames of the model from one frame of the scene to the next.
        frames: Frames wanted.
    """
    return sample(whole, np.minimum(now + step * np.arange(1, frames + 1), len(whole) - 1), step)


@dataclass(frozen=True, slots=True, eq=False)
class Lift:
    """How a model's joints carry those of a skeleton.

    Attributes:
        skeleton: The skeleton of the question.
        known: Joints of the question that a joint of the model stands for, in the same place.
        served: For each of them that joint of the model.
        carried: Joints that the model does not know, ``(joints,)`` bool.
        carriers: For every joint the known joints that carry it, the nearest first.
    """

    skeleton: Skeleton
    known: np.ndarray
    served: np.ndarray
    carried: np.ndarray
    carriers: np.ndarray

    @classmethod
    @lru_cache(maxsize=16)
    def between(cls, model: Skeleton, skeleton: Skeleton) -> Lift:
        """The lift from a model's skeleton to that of a question."""
        served: dict[int, int] = {}
        for joint, group in enumerate(model.map_from(skeleton)):
            if len(group) == 1:
                served.setdefault(group[0], joint)
        known = np.array(sorted(served))
        nearest = np.argsort(_hops(skeleton)[:, known], axis=1, kind="stable")[:, :ANCHORS]
        carried = np.ones(len(skeleton), bool)
        carried[known] = False
        return cls(skeleton, known, np.array([served[joint] for joint in known]), carried, known[nearest])

    def __call__(self, answer: np.ndarray, last: np.ndarray) -> np.ndarray:
        """All joints of the question.

        Args:
            answer: The model's joints, ``(time, people, model joints, 3)``.
            last: The pose in the last frame of history, ``(people, joints, 3)``.

        Returns:
            ``(time, people, joints, 3)``.
        """
        # joints and axes first: whole rows of frames and people are computed with at once
        lifted = np.empty((len(self.skeleton), 3, *answer.shape[:2]))
        lifted[self.known] = answer.transpose(2, 3, 0, 1)[self.served]
        if self.carried.any():
            self._carry(lifted, last.transpose(1, 2, 0).copy()[:, :, None])
        return lifted.transpose(2, 3, 0, 1)

    def _carry(self, lifted: np.ndarray, last: np.ndarray) -> None:
        """Puts the carried joints in; ``(joints, 3, time, people)``, the last pose with a time of one frame."""
        torso = [joint for joint in self.known if self.skeleton.landmarks[joint] in TORSO]
        torso_turn = best_turns(_fit(_spread(lifted[torso]), _spread(last[torso])))
        # joints of one hand have the same carriers: they turn as one
        carriers, group = np.unique(self.carriers[self.carried], axis=0, return_inverse=True)
        first, others = carriers[:, 0], carriers.T[1:]
        share = 1.0 / np.arange(2, carriers.shape[1] + 1).reshape(-1, 1, 1, 1, 1)  # the nearer counts more
        before, after = ((at[others] - at[first]) * share for at in (last, lifted))
        # the torso's turn decides what the carriers leave open
        open_share = TORSO_SHARE * np.square(before).sum((0, 2))
        turns = best_turns(_fit(after, before) + open_share * torso_turn[:, :, None])
        for joint, turn in zip(np.flatnonzero(self.carried), group.reshape(-1), strict=True):
            anchor = self.carriers[joint, 0]
            x, y, z = last[joint] - last[anchor]
            matrix = turns[:, :, turn]
            lifted[joint] = lifted[anchor] + (matrix[:, 0] * x + matrix[:, 1] * y + matrix[:, 2] * z)


def _fit(after: np.ndarray, before: np.ndarray) -> np.ndarray:
    """What :func:`best_turns` makes turns of, ``(3, 3, ..., t, p)``: sums over vectors ``(n, ..., 3, t, p)``."""
    fit = np.empty((3, 3, *after.shape[1:-3], *after.shape[-2:]))
    for i, j in np.ndindex(3, 3):
        fit[i, j] = (after[..., i, :, :] * before[..., j, :, :]).sum(0)
    return fit


def _spread(points: np.ndarray) -> np.ndarray:
    return points - points.mean(0)


def _hops(skeleton: Skeleton) -> np.ndarray:
    """Number of bones between any two joints, ``(joints, joints)``; separate trees are far apart."""
    count = len(skeleton)
    hops = np.full((count, count), 1000)
    np.fill_diagonal(hops, 0)
    for joint, parent in skeleton.bones:
        hops[joint, parent] = hops[parent, joint] = 1
    for middle in range(count):
        hops = np.minimum(hops, hops[:, middle, None] + hops[None, middle])
    return hops


def rigid_bones(history: Scene) -> np.ndarray:
    """Mean length of each bone that keeps its length in the history, else NaN, ``(people, joints)`` metres."""
    joints, parents = (list(side) for side in zip(*history.skeleton.bones, strict=True))
    both = history.observed[:, :, joints] & history.observed[:, :, parents]
    bones = history.positions[:, :, joints] - history.positions[:, :, parents]
    apart = np.sqrt(np.einsum("tpji,tpji->tpj", bones, bones))
    count = np.maximum(both.sum(0), 1)
    mean = (apart * both).sum(0) / count
    deviation = np.sqrt((np.square(apart - mean) * both).sum(0) / count)
    spans = np.array([_spans_torso(history.skeleton, joint) for joint in joints])
    rigid = (both.sum(0) >= 2) & (deviation < CONSTANT * mean) & ~spans
    lengths = np.full(history.observed.shape[1:], np.nan)
    lengths[:, joints] = np.where(rigid, mean, np.nan)
    return lengths


def _spans_torso(skeleton: Skeleton, joint: int) -> bool:
    """Whether a "bone" of a coarse skeleton bridges the flexible torso, as from pelvis to neck; it may stretch."""
    place, above = skeleton.landmarks[joint], skeleton.landmarks[skeleton.parents[joint]]
    return place in TORSO and above in TORSO and not (place.endswith("hip") and above == "pelvis")


def keep_lengths(positions: np.ndarray, skeleton: Skeleton, lengths: np.ndarray) -> np.ndarray:
    """Positions whose rigid bones have their length, from the root outwards.

    Args:
        positions: ``(time, people, joints, 3)``.
        skeleton: Their skeleton.
        lengths: ``(people, joints)`` metres, NaN for bones that may stretch.
    """
    kept, wanted = positions.transpose(2, 3, 0, 1).copy(), lengths.T[:, None]
    for joints, parents in _tiers(skeleton):
        start, bone = kept[parents], kept[joints]
        bone -= start
        length = np.sqrt(np.square(bone).sum(1))
        bone *= np.where(np.isnan(wanted[joints]), 1.0, wanted[joints] / np.maximum(length, 1e-9))[:, None]
        bone += start
        kept[joints] = bone
    return kept.transpose(2, 3, 0, 1)


@lru_cache(maxsize=16)
def _tiers(skeleton: Skeleton) -> list[tuple[list[int], list[int]]]:
    """Joints and their parents by distance from the root, nearest first: each tier can be moved at once."""
    depth: dict[int, int] = {-1: -1}
    tiers: dict[int, tuple[list[int], list[int]]] = {}
    for joint, parent in enumerate(skeleton.parents):
        depth[joint] = depth[parent] + 1
        if parent >= 0:
            joints, parents = tiers.setdefault(depth[joint], ([], []))
            joints.append(joint)
            parents.append(parent)
    return [tiers[tier] for tier in sorted(tiers)]
