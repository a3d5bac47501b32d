"""A room without people, and a scene put into it."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from motioncast.core.scene import Scene
from motioncast.core.scene_object import SceneObject
from motioncast.core.shapes import signed_distance

ANKLE_M = 0.08
"""Height of an ankle over the floor, for skeletons that end there."""

DEEPEST_M = 0.1
"""Measured furniture and measured people overlap by this much before anybody is told."""


@dataclass(frozen=True, slots=True)
class Room:
    """Furniture and floor; metres, z up, in the world of the people.

    Attributes:
        objects: What stands in it.
        floor_m: Height of the floor, where it is known.
        remarks: What the reader inferred or left out, one sentence each.
    """

    objects: tuple[SceneObject, ...]
    floor_m: float | None = None
    remarks: tuple[str, ...] = ()


def furnish(scene: Scene, room: Room, history: int | None = None) -> Scene:
    """The scene with the furniture of a room beside its own, and a floor.

    A floor that neither states is inferred from the feet, and said aloud in a remark; so is who stands inside
    a thing in the last frame of the history.

    Args:
        scene: The people.
        room: The room, in their world.
        history: Frames of the scene that may be looked at. Default: all.
    """
    seen = scene[: scene.frames if history is None else history]
    remarks = list(room.remarks)
    floor = room.floor_m if room.floor_m is not None else scene.floor_m
    if floor is None:
        floor = floor_under(seen)
        remarks.append(
            f'the room has no floor_m; {floor:.2f} m is taken, from the lowest feet (write "floor_m" into the room)'
        )
    remarks += overlaps(seen, room.objects)
    return replace(
        scene, objects=(*scene.objects, *room.objects), floor_m=float(floor), remarks=(*scene.remarks, *remarks)
    )


def floor_under(scene: Scene) -> float:
    """Height of the floor in metres, from the lowest joints of people; 0 if nobody is seen.

    Every hundredth frame may be wrong; where a skeleton ends at the ankles, the floor is below them.

    Example:
        >>> from motioncast.core.skeletons import MRT15
        >>> round(floor_under(Scene(np.ones((10, 1, 15, 3)), MRT15, 30)), 2)
        0.92
    """
    lowest = np.where(scene.observed, scene.positions[..., 2], np.inf).min(-1)
    lowest = lowest[np.isfinite(lowest)]
    if not len(lowest):
        return 0.0
    places = ("left_toe", "right_toe", "left_foot", "right_foot")
    feet = any(scene.skeleton.find(place) is not None for place in places)
    return float(np.percentile(lowest, 1)) - (0 if feet else ANKLE_M)


def overlaps(scene: Scene, objects: tuple[SceneObject, ...]) -> list[str]:
    """Who stands inside a box or cylinder in the last frame, a sentence each; seats and walls do not count."""
    sentences = []
    for thing in objects:
        if thing.category in ("sittable", "occluder", "out_of_bound") or not scene.frames:
            continue
        depth = -signed_distance(thing.at(-1), scene.positions[-1])  # (people, joints)
        deepest = np.where(scene.observed[-1], depth, 0).max(-1)
        sentences += [
            f'{person} stands {deep * 100:.0f} cm inside "{thing.name}" at the start; check its place and the unit'
            for person, deep in zip(scene.people, deepest, strict=True)
            if deep > DEEPEST_M
        ]
    return sentences
