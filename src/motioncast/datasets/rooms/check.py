"""What is published with the rooms: how deep bodies are in things, how well seats fit, whether feet slide."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass

import numpy as np

from motioncast.core.shapes import signed_distance
from motioncast.datasets.rooms.bodies import PELVIS
from motioncast.datasets.rooms.compose import Room
from motioncast.datasets.rooms.contacts import FEET, FPS, runs, sliding
from motioncast.datasets.rooms.events import PELVIS_ABOVE_SEAT_M
from motioncast.datasets.rooms.fitting import TOUCHING, yaw
from motioncast.datasets.rooms.footprint import footprint
from motioncast.datasets.rooms.furnish import DECOYS

EVERY = 3
"""Every third frame is looked at for penetration."""

STANDING_M_S, WALKING_M_S = 0.15, 0.4


@dataclass(frozen=True, slots=True)
class Check:
    """What one room is like.

    Attributes:
        depth_m: Of each person and looked-at frame the depth of the deepest joint in any thing, ``(n,)``; joints that
            touch what they use are left out.
        nearest_m: Smallest distance of two pelvises of people who were not recorded together; infinite alone.
        seat_m: For each sitting the distance from the contact point under the pelvis to the seat.
        sliding_m_s: Sliding of feet in contact: ``real`` frames as stitched and bent, and ``synthetic`` ones.
        categories: Objects by category and role.
        events: By kind, ``synthetic`` or ``real``.
        short_of_decoys: Used things with fewer than three decoys of their category.
        free: Share of the floor that neither bodies nor things take.
        time_share: Share of frames that people stand, walk, sit, or do something else.
    """

    depth_m: np.ndarray
    nearest_m: float
    seat_m: np.ndarray
    sliding_m_s: dict[str, float]
    categories: Counter[tuple[str, str]]
    events: Counter[tuple[str, str]]
    short_of_decoys: int
    free: float
    time_share: dict[str, float]


def check(room: Room) -> Check:
    """The measures of one room."""
    objects = room.scene.objects
    categories = Counter((item.category, item.role) for item in objects)
    used = Counter(item.category for item in objects if item.role == "caused")
    return Check(
        depth_m=_depths(room),
        nearest_m=_nearest(room),
        seat_m=_seats(room),
        sliding_m_s={
            name: _sliding(room, mask) for name, mask in (("real", ~room.synthetic), ("synthetic", room.synthetic))
        },
        categories=categories,
        events=Counter((event.kind, "synthetic" if event.synthetic else "real") for event in room.events),
        short_of_decoys=sum(max(DECOYS * count - categories[name, "decoy"], 0) for name, count in used.items()),
        free=_free(room),
        time_share=_time_share(room),
    )


def _depths(room: Room) -> np.ndarray:
    positions, here = room.scene.positions, room.here
    joints = positions.shape[2]
    deepest = np.zeros(here.shape)
    for item in room.scene.objects:
        depth = np.zeros((*here.shape, joints), np.float32)
        depth[::EVERY] = -signed_distance(item, positions[::EVERY])
        for event in room.events:
            if event.thing == item.name:
                depth[:, event.person, list(TOUCHING[event.kind])] = 0
        deepest = np.maximum(deepest, depth.max(-1))
    return deepest[::EVERY][here[::EVERY]]


def _nearest(room: Room) -> float:
    pelvis = np.where(room.here[..., None], room.scene.positions[:, :, PELVIS, :2], np.nan)
    gaps = [
        np.linalg.norm(pelvis[:, one] - pelvis[:, other], axis=-1)
        for (one, other), kind in room.pairs.items()
        if kind == "composed"
    ]
    gaps = [gap[np.isfinite(gap)] for gap in gaps]
    return float(min((gap.min(initial=np.inf) for gap in gaps), default=np.inf))


def _seats(room: Room) -> np.ndarray:
    things = {item.name: item for item in room.scene.objects}
    errors = []
    for event in room.events:
        if event.kind == "sit":
            pelvis = np.median(room.scene.positions[event.start : event.end, event.person, PELVIS], 0)
            contact = pelvis - [0, 0, PELVIS_ABOVE_SEAT_M]
            errors.append(abs(float(signed_distance(things[event.thing], contact))))
    return np.array(errors)


def _sliding(room: Room, mask: np.ndarray) -> float:
    """Mean over the stretches of a mask ``(time, people)``, by their length."""
    total, frames = 0.0, 0
    for person in range(mask.shape[1]):
        for first, end in runs(mask[:, person] & room.here[:, person]):
            if end - first >= 5:
                feet = room.scene.positions[first:end, person][:, FEET]
                total += float(sliding(feet)) * (end - first)
                frames += end - first
    return total / frames if frames else float("nan")


def _free(room: Room) -> float:
    points = room.scene.positions[room.here].reshape(-1, 3)
    taken = footprint(points[np.all(np.abs(points[:, :2]) < room.half, -1)], room.half)
    for item in room.scene.objects:
        taken.take(float(item.position[0]), float(item.position[1]), yaw(item), *item.size[:2].tolist())
    return 1 - taken.share


def _time_share(room: Room) -> dict[str, float]:
    sits = np.zeros(room.here.shape, bool)
    for event in room.events:
        if event.kind == "sit":
            sits[event.start : event.end, event.person] = True
    pelvis = room.scene.positions[:, :, PELVIS, :2].astype(np.float64)
    # over a second, so that swaying is not walking
    reach = round(FPS / 2)
    held = np.pad(pelvis, ((reach, reach), (0, 0), (0, 0)), "edge")
    pace = np.linalg.norm(held[2 * reach :] - held[: -2 * reach], axis=-1)
    here = room.here
    masks = {
        "sit": here & sits,
        "stand": here & ~sits & (pace < STANDING_M_S),
        "walk": here & ~sits & (pace > WALKING_M_S),
    }
    shares = {name: float(mask.sum() / max(here.sum(), 1)) for name, mask in masks.items()}
    return {**shares, "other": 1 - sum(shares.values())}
