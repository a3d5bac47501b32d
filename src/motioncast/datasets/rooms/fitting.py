"""Whether a thing may stand where it is wanted: in nobody's way, and in no body except where it is touched."""

from __future__ import annotations

import numpy as np

from motioncast.core.scene_object import SceneObject
from motioncast.core.shapes import signed_distance
from motioncast.datasets.rooms.bodies import PELVIS
from motioncast.datasets.rooms.figure import HANDS, HIPS
from motioncast.datasets.rooms.ground import Ground

DEEPEST_M = 0.03
"""No joint is deeper than this in a thing that it does not use."""

HAND = tuple(joint for hand in HANDS for joint in hand[1:])
TOUCHING = {"stand": (), "play": (), "sit": (PELVIS, *HIPS), "reach": HAND, "fetch": (), "write": HAND}
"""Joints that may touch what is used: pelvis and hips a seat, hands from the wrist on a counter or a board."""


def fits(item: SceneObject, body: np.ndarray, ground: Ground, touching: tuple[int, ...]) -> bool:
    """Whether a thing is in nobody's way, the walls' included, and not in the body that uses it."""
    corners = item.corners[:, :2]
    if (np.abs(corners) > ground.half + 0.02).any():
        return False
    circles = around(item)
    for x, y, radius in circles:
        for other in ground.people:
            square = np.square(other - [x, y]).sum(-1)
            if (square < (radius + 0.4) ** 2).any():
                return False
        for there_x, there_y, there in ground.things:
            if np.hypot(x - there_x, y - there_y) < radius + there:
                return False
    others = [joint for joint in range(body.shape[1]) if joint not in touching]
    return bool((signed_distance(item, body[::2, others]) > -DEEPEST_M).all())


def around(item: SceneObject) -> list[tuple[float, float, float]]:
    """Circles that cover the floor under a thing: x, y, radius."""
    depth, width = float(item.size[0]), float(item.size[1])
    if item.shape == "cylinder":
        return [(float(item.position[0]), float(item.position[1]), depth / 2)]
    short, long = min(depth, width), max(depth, width)
    count = max(1, round(long / max(short, 0.3)))
    axis = np.array([1.0, 0, 0]) if depth > width else np.array([0, 1.0, 0])
    places = (np.arange(count) + 0.5) / count - 0.5
    middles = item.outward(places[:, None] * long * axis * np.ones((1, 3)))
    radius = 0.5 * float(np.hypot(short, long / count))
    return [(float(x), float(y), radius) for x, y, _ in middles]


def yaw(item: SceneObject) -> float:
    """How far a thing that stands upright is turned about the vertical, radians."""
    return float(2 * np.arctan2(item.rotation[3], item.rotation[0]))
