"""Made-up people who walk, seeded: scenes for tests that need no data."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from motioncast.core.scene import Scene
from motioncast.core.skeletons import MRT15

STANDING_M = {
    "pelvis": (0, 0, 0.95), "neck": (0, 0, 1.45), "head": (0, 0, 1.62),
    "hip": (0.1, 0, 0.92), "knee": (0.12, -0.02, 0.50), "ankle": (0.12, 0.02, 0.09),
    "shoulder": (0.17, 0, 1.40), "elbow": (0.24, 0, 1.12), "wrist": (0.26, -0.05, 0.88),
}  # fmt: skip
"""A person of 1.7 m who stands at the origin and faces -y; the left side lies at +x."""


def standing_pose() -> np.ndarray:
    """The pose of ``STANDING_M`` on the 15 joints of ``MRT15``, ``(15, 3)`` metres."""
    pose = []
    for name in MRT15.names:
        side, _, place = name.partition("_")
        x, y, z = STANDING_M[place or name]
        pose.append((-x if side == "right" else x, y, z))
    return np.array(pose)


def walkers(people: int = 3, frames: int = 60, fps: float = 15.0, seed: int = 0) -> Scene:
    """People who walk on arcs, legs and arms swinging about hips and shoulders; bones keep their length.

    Args:
        people: Number of people.
        frames: Number of frames.
        fps: Frames a second.
        seed: Of speeds, directions and phases.

    Example:
        >>> walkers(people=2, frames=30).positions.shape
        (30, 2, 15, 3)
    """
    random = np.random.default_rng(seed)
    seconds = np.arange(frames) / fps
    positions = np.empty((frames, people, len(MRT15), 3))
    for person in range(people):
        speed, turn, start = random.uniform(0.6, 1.4), random.uniform(-0.6, 0.6), random.uniform(0, 2 * np.pi)
        pose = np.broadcast_to(standing_pose(), (frames, len(MRT15), 3)).copy()
        phase = 2 * np.pi * 0.9 * seconds + random.uniform(0, 2 * np.pi)
        for side, sign in (("left", 1), ("right", -1)):
            _swing(pose, f"{side}_hip", (f"{side}_knee", f"{side}_ankle"), 0.45 * sign * np.sin(phase))
            _swing(pose, f"{side}_knee", (f"{side}_ankle",), 0.4 * (1 + np.sin(sign * phase - 1)))
            _swing(pose, f"{side}_shoulder", (f"{side}_elbow", f"{side}_wrist"), -0.3 * sign * np.sin(phase))
        heading = start + turn * seconds
        # the integral of (sin, -cos) of the heading: an arc
        path = speed / turn * np.stack([np.cos(start) - np.cos(heading), np.sin(start) - np.sin(heading)], -1)
        cosine, sine = np.cos(heading)[:, None], np.sin(heading)[:, None]
        x, y = pose[..., 0], pose[..., 1]
        place = random.uniform(-2, 2, 2)
        positions[:, person, :, 0] = cosine * x - sine * y + (path[:, :1] + place[0])
        positions[:, person, :, 1] = sine * x + cosine * y + (path[:, 1:] + place[1])
        positions[:, person, :, 2] = pose[..., 2]
    return Scene(positions, MRT15, fps, source="made-up walkers")


def padded(scene: Scene, slots: int = 2) -> Scene:
    """A scene with slots for people who are never seen."""
    return Scene(
        np.pad(scene.positions, ((0, 0), (0, slots), (0, 0), (0, 0))),
        scene.skeleton,
        scene.fps,
        np.pad(scene.observed, ((0, 0), (0, slots), (0, 0))),
    )


def unseen(scene: Scene, *places: tuple[int | slice, ...], lost: bool = False) -> Scene:
    """A scene in which some places of its mask (frames, people, joints) were not seen.

    Args:
        scene: The scene.
        places: Indices of the mask.
        lost: Whether what was not seen is not a number either.
    """
    observed, positions = scene.observed.copy(), scene.positions
    for place in places:
        observed[place] = False
    if lost:
        positions = np.where(observed[..., None], positions, np.nan)
    return replace(scene, positions=positions, observed=observed)


def _swing(pose: np.ndarray, pivot: str, parts: tuple[str, ...], angle: np.ndarray) -> None:
    """Turn joints about the left-right axis through another joint, by an angle a frame."""
    middle = pose[:, MRT15.index(pivot)]
    cosine, sine = np.cos(angle), np.sin(angle)
    for part in parts:
        y, z = (pose[:, MRT15.index(part), axis] - middle[:, axis] for axis in (1, 2))
        pose[:, MRT15.index(part), 1] = middle[:, 1] + cosine * y - sine * z
        pose[:, MRT15.index(part), 2] = middle[:, 2] + sine * y + cosine * z
