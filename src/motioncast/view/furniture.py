"""The things of a scene on their way into a page."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from motioncast.core.scene_object import SceneObject
from motioncast.view.packing import Block

MOST_POINTS = 1500
"""Points of a cloud beyond this number are left out evenly."""

MOST_TRIANGLES = 4000
"""A mesh of more triangles is shown by its corners, as a cloud."""


def add_objects(
    block: Block, objects: Sequence[SceneObject], past: slice, origin: np.ndarray, scale: float
) -> list[dict[str, Any]]:
    """Adds shapes and places of objects; returns what the page says of each.

    Whether a thing is a decoy or stands where somebody uses it is not told.

    Args:
        block: Where numbers go.
        objects: The objects of the history.
        past: Its frames that are shown; a thing that moves stays afterwards where it was last seen.
        origin: The page's origin in the world, ``(3,)``.
        scale: Unit of positions in metres.
    """
    entries = []
    for number, thing in enumerate(objects):
        shape = thing.shape
        if shape == "mesh" and thing.faces is not None and len(thing.faces) > MOST_TRIANGLES:
            shape = "points"
        shown = thing[past]
        block.add(f"object/{number}/position", np.atleast_2d(shown.position) - origin, scale)
        block.add(f"object/{number}/rotation", np.atleast_2d(shown.rotation), 1 / 16384)
        if thing.points is not None:
            step = -(-len(thing.points) // MOST_POINTS) if shape == "points" else 1
            block.add(f"object/{number}/points", thing.points[::step], 1e-3)
        if shape == "mesh" and thing.faces is not None:
            block.add(f"object/{number}/faces", thing.faces, 1)
        entries.append(
            {"name": thing.name, "category": thing.category, "shape": shape, "size": thing.size.round(4).tolist()}
        )
    return entries
