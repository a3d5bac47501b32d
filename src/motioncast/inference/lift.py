"""From a scene to a model's joints and rate, and from the answer back to the scene's own.

A model knows some joints at one frame rate. What it is asked about has another skeleton and another rate; joints
that the model does not know are carried rigidly by those that it knows, and bones keep their length.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from motioncast.core import rotation
from motioncast.core.resample import LOBES, resample, sample
from motioncast.core.scene import Scene
from motioncast.core.skeleton import Skeleton

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


def between_sightings(observed: np.ndarray) -> np.ndarray:
    """The mask with gaps closed that have a sighting before and after, ``(time, people, joints)``."""
    return np.maximum.accumulate(observed) & np.maximum.accumulate(observed[::-1])[::-1]


def between_frames(history: np.ndarray, future: np.ndarray, model_fps: float, fps: float, frames: int) -> np.ndarray:
    """A model's answer at the frames of the scene, without a step where history and answer meet.

    Args:
        history: ``(time, ...)`` at the model's rate, its last frame now.
        future: ``(time, ...)`` at the model's rate.
        model_fps: The model's rate.
        fps: The scene's rate.
        frames: Frames wanted.
    """
    step = model_fps / fps
    times = len(history) - 1 + step * np.arange(1, frames + 1)
    whole = np.concatenate([history, future])
    return sample(whole, np.minimum(times, len(whole) - 1), step)


@dataclass(frozen=True, slots=True, eq=False)
class Lift:
    """How a model's joints carry those of a skeleton.

    Attributes:
        skeleton: The skeleton of the question.
        known: Joints of the question that a joint of the model stands for, in the same place.
        served: For each of them that joint of the model.
        carriers: For every joint the known joints that carry it, the nearest first.
        weights: How much each of them counts.
    """

    skeleton: Skeleton
    known: np.ndarray
    served: np.ndarray
    carriers: np.ndarray
    weights: np.ndarray

    @classmethod
    def between(cls, model: Skeleton, skeleton: Skeleton) -> Lift:
        """The lift from a model's skeleton to that of a question."""
        served: dict[int, int] = {}
        for joint, group in enumerate(model.map_from(skeleton)):
            if len(group) == 1:
                served.setdefault(group[0], joint)
        known = np.array(sorted(served))
        hops = _hops(skeleton)[:, known]
        order = np.argsort(hops, axis=1, kind="stable")[:, :ANCHORS]
        weights = np.broadcast_to(1.0 / np.arange(1, order.shape[1] + 1) ** 2, order.shape)
        return cls(skeleton, known, np.array([served[joint] for joint in known]), known[order], weights)

    @property
    def carried(self) -> np.ndarray:
        """Joints that are carried, ``(joints,)`` bool."""
        carried = np.ones(len(self.skeleton), bool)
        carried[self.known] = False
        return carried

    def __call__(self, answer: np.ndarray, last: np.ndarray) -> np.ndarray:
        """All joints of the question.

        Args:
            answer: The model's joints, ``(time, people, model joints, 3)``.
            last: The pose in the last frame of history, ``(people, joints, 3)``.

        Returns:
            ``(time, people, joints, 3)``.
        """
        lifted = np.empty((*answer.shape[:2], len(self.skeleton), 3))
        lifted[:, :, self.known] = answer[:, :, self.served]
        if not self.carried.any():
            return lifted
        torso = [joint for joint in self.known if self.skeleton.landmarks[joint] in TORSO]
        torso_turn = rotation.kabsch(_spread(last, torso), _spread(lifted, torso))
        turns: dict[bytes, np.ndarray] = {}  # joints of one hand have the same carriers
        for joint in np.flatnonzero(self.carried):
            carriers = self.carriers[joint]
            anchor, key = carriers[0], carriers.tobytes()
            if key not in turns:
                share = np.sqrt(self.weights[joint])[:, None]
                before = (last[:, carriers] - last[:, [anchor]]) * share
                after = (lifted[:, :, carriers] - lifted[:, :, [anchor]]) * share
                # three axes that turn with the torso decide what the carriers leave open
                axes = np.eye(3) * np.sqrt(TORSO_SHARE * np.square(before).sum((-1, -2)))[:, None, None]
                turned = rotation.rotate(torso_turn[:, :, None], axes)
                rest = np.concatenate([before, axes], 1)
                turns[key] = rotation.kabsch(rest, np.concatenate([after, turned], 2))
            carried = rotation.rotate(turns[key], last[:, joint] - last[:, anchor])
            lifted[:, :, joint] = lifted[:, :, anchor] + carried
        return lifted


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


def _spread(points: np.ndarray, joints: list[int]) -> np.ndarray:
    chosen = points[..., joints, :]
    return chosen - chosen.mean(-2, keepdims=True)


def rigid_bones(history: Scene) -> np.ndarray:
    """Mean length of each bone that keeps its length in the history, else NaN, ``(people, joints)`` metres."""
    joints, parents = (list(side) for side in zip(*history.skeleton.bones, strict=True))
    both = history.observed[:, :, joints] & history.observed[:, :, parents]
    apart = np.linalg.norm(history.positions[:, :, joints] - history.positions[:, :, parents], axis=-1)
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
    kept = positions.copy()
    for joint, parent in skeleton.bones:
        bone = positions[:, :, joint] - kept[:, :, parent]
        length = np.linalg.norm(bone, axis=-1, keepdims=True)
        wanted = np.where(np.isnan(lengths[:, joint]), length[..., 0], lengths[:, joint])[..., None]
        kept[:, :, joint] = kept[:, :, parent] + bone * wanted / np.maximum(length, 1e-9)
    return kept
