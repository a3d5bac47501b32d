"""The kinds of furniture that a room may hold: sizes of real ones, and where they stand."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from motioncast.core.rotation import from_axis_angle
from motioncast.core.scene_object import SceneObject


@dataclass(frozen=True, slots=True)
class Kind:
    """A kind of thing.

    Attributes:
        category: One of the thirteen categories.
        shape: ``box`` or ``cylinder``.
        least: Smallest depth, width and height, metres; depth points away from who uses it.
        most: Largest.
        place: ``floor``, ``wall`` (its back to a wall), ``hung`` (on a wall, above the floor) or ``top``
            (on a counter).
    """

    category: str
    shape: str
    least: tuple[float, float, float]
    most: tuple[float, float, float]
    place: str

    def size(self, random: np.random.Generator) -> np.ndarray:
        """A size of this kind, ``(3,)`` metres."""
        size = random.uniform(self.least, self.most).round(2)
        if self.shape == "cylinder":
            size[1] = size[0]
        return size


KINDS = {
    "chair": Kind("sittable", "box", (0.42, 0.42, 0.42), (0.48, 0.5, 0.48), "floor"),
    "stool": Kind("sittable", "cylinder", (0.34, 0.34, 0.44), (0.4, 0.4, 0.5), "floor"),
    "bar stool": Kind("sittable", "cylinder", (0.34, 0.34, 0.7), (0.4, 0.4, 0.85), "floor"),
    "sofa": Kind("sittable", "box", (0.75, 1.5, 0.4), (0.9, 2.1, 0.45), "wall"),
    "table": Kind("table", "box", (0.7, 1.1, 0.7), (0.9, 1.8, 0.76), "floor"),
    "counter": Kind("cupboard", "box", (0.55, 0.8, 0.88), (0.62, 1.8, 0.94), "wall"),
    "cupboard": Kind("cupboard", "box", (0.4, 0.8, 1.8), (0.6, 1.2, 2.1), "wall"),
    "drawer": Kind("drawer", "box", (0.5, 0.4, 0.7), (0.6, 0.6, 0.92), "wall"),
    "sink": Kind("sink", "box", (0.55, 0.6, 0.86), (0.62, 0.9, 0.92), "wall"),
    "dishwasher": Kind("dishwasher", "box", (0.58, 0.6, 0.84), (0.62, 0.6, 0.88), "wall"),
    "whiteboard": Kind("whiteboard", "box", (0.04, 1.2, 1.0), (0.06, 2.0, 1.2), "hung"),
    "microwave": Kind("microwave", "box", (0.36, 0.46, 0.27), (0.42, 0.52, 0.32), "top"),
    "kettle": Kind("kettle", "cylinder", (0.16, 0.16, 0.22), (0.2, 0.2, 0.27), "top"),
    "coffee machine": Kind("coffee_machine", "box", (0.35, 0.26, 0.34), (0.45, 0.36, 0.44), "top"),
    "trash": Kind("trash", "cylinder", (0.26, 0.26, 0.4), (0.4, 0.4, 0.7), "floor"),
    "wall": Kind("occluder", "box", (0.2, 0.1, 2.4), (20.0, 0.1, 2.4), "wall"),
    "screen": Kind("occluder", "box", (0.06, 0.9, 1.6), (0.1, 1.6, 2.0), "floor"),
}
"""Kinds by name. Out-of-bound markers, the thirteenth category, are left out as they are in the field's own data."""

WALL_HEIGHT_M = 2.4
HUNG_M = 0.95
"""Height of the lower edge of what hangs on a wall."""


def thing(
    kind: Kind, name: str, size: np.ndarray, x: float, y: float, z: float, angle: float, role: str
) -> SceneObject:
    """A thing whose lower side is at a height z and which is turned about the vertical; its back is its +x side."""
    turn = from_axis_angle(np.array([0.0, 0.0, angle]))
    return SceneObject(name, kind.category, kind.shape, size, np.array([x, y, z + size[2] / 2]), turn, role=role)
