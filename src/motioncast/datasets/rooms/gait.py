"""How one person walks: all walking frames of a subject, and what a frame looks like from inside the body."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from motioncast.core.skeletons import CMU31
from motioncast.datasets.rooms.bodies import PELVIS, bone_lengths, facing, turned
from motioncast.datasets.rooms.clips import Clip
from motioncast.datasets.rooms.contacts import FEET, FPS, lasting, pivot, runs, smoothed
from motioncast.datasets.rooms.stitch import BLEND, MIDDLE, continuations

COMPARED = tuple(
    CMU31.index(name)
    for name in (
        "lhipjoint", "lfemur", "ltibia", "ltoes", "rhipjoint", "rfemur", "rtibia", "rtoes", "thorax", "head",
        "lclavicle", "lhumerus", "lwrist", "rclavicle", "rhumerus", "rwrist",
    )
)  # fmt: skip

VELOCITY_S = 0.15
"""A velocity counts as the way that it makes in this time."""

SLOWEST_M_S, FASTEST_M_S = 0.45, 2.0
SHORTEST_S = 1.2
LEAST_S = 2.2
"""Walking of one person that a gait is made of."""

LEAST = round(1.0 * FPS)
"""Frames of the shortest piece of a walk, beside its blends."""


@dataclass(frozen=True, slots=True, eq=False)
class Gait:
    """The walking of one subject.

    Attributes:
        positions: All walking frames, ``(frames, 31, 3)``, floor at z = 0.
        looks: Where the person faces in each of them, ``(frames,)`` radians.
        pivots: Where the person stands, ``(frames, 2)``.
        firsts: For each frame the first frame of the stretch that it belongs to, ``(frames,)``.
        ends: Likewise its end, exclusive.
        onward: For each frame others that go on like it, ``(frames, ways)``: see ``stitch.continuations``.
        takes: The take of each frame.
        lengths: Bone lengths, ``(31,)``.
    """

    positions: np.ndarray
    looks: np.ndarray
    pivots: np.ndarray
    firsts: np.ndarray
    ends: np.ndarray
    onward: np.ndarray
    takes: np.ndarray
    lengths: np.ndarray

    def __len__(self) -> int:
        return len(self.positions)


def features(positions: np.ndarray) -> np.ndarray:
    """Pose and velocity of one person's frames ``(time, 31, 3)`` as seen from the body, ``(time, features)``.

    Their distance is in metres, the root mean square over joints.
    """
    angle = -facing(positions)[:, None]
    joints = positions[:, COMPARED].astype(np.float64)
    velocity = np.gradient(joints, axis=0) * FPS
    joints[..., :2] -= positions[:, PELVIS, None, :2]
    both = np.concatenate([turned(joints, angle), VELOCITY_S * turned(velocity, angle)], 1)
    return both.reshape(len(both), -1) / np.sqrt(len(COMPARED))


def walking(positions: np.ndarray) -> np.ndarray:
    """In which frames one person ``(time, 31, 3)`` walks forwards on the floor, ``(time,)`` bool."""
    pelvis = smoothed(positions[:, PELVIS].astype(np.float64), 5)
    velocity = np.gradient(pelvis[:, :2], axis=0) * FPS
    pace = np.linalg.norm(velocity, axis=-1)
    look = facing(positions)
    ahead = velocity[:, 0] * np.cos(look) + velocity[:, 1] * np.sin(look) > 0.8 * pace
    feet = positions[:, FEET, 2]
    on_floor = (smoothed(feet.min(-1), 3) < 0.06) & (feet.max(-1) < 0.4)
    upright = np.abs(pelvis[:, 2] / np.median(pelvis[:, 2]) - 1) < 0.1
    mask = (pace > SLOWEST_M_S) & (pace < FASTEST_M_S) & ahead & on_floor & upright
    return lasting(mask, round(SHORTEST_S * FPS))


def gait_of(clips: Sequence[Clip]) -> Gait | None:
    """The walking of one subject, or None where there is too little for a round of steps."""
    found = [(clip, first, end) for clip in clips for first, end in runs(walking(clip.positions[:, 0]))]
    lengths = [end - first for _, first, end in found]
    if sum(lengths) < LEAST_S * FPS:
        return None
    positions = np.concatenate([clip.positions[first:end, 0] for clip, first, end in found])
    seen = np.concatenate([features(clip.positions[:, 0])[first:end] for clip, first, end in found])
    pivots = np.concatenate([pivot(clip.positions[:, 0])[first:end] for clip, first, end in found])
    ends = np.cumsum(lengths).repeat(lengths)
    firsts = ends - np.repeat(lengths, lengths)
    looks = facing(positions)
    onward = continuations(positions, seen, looks, pivots, firsts, ends, LEAST + MIDDLE + BLEND)
    takes = np.repeat([clip.name for clip, _, _ in found], lengths)
    return Gait(positions, looks, pivots, firsts, ends, onward, takes, bone_lengths(positions))
