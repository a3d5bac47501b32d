"""Furniture that nobody uses: walls, and decoys of every kind in the space that bodies leave free.

A chair that stands only where somebody will sit tells the future. So for each thing that is used there are at least
three of its kind that are not.
"""

from __future__ import annotations

import numpy as np

from motioncast.core.scene_object import SceneObject
from motioncast.datasets.rooms.fitting import yaw
from motioncast.datasets.rooms.footprint import Footprint
from motioncast.datasets.rooms.ground import DOOR_M, Ground
from motioncast.datasets.rooms.kinds import HUNG_M, KINDS, WALL_HEIGHT_M, Kind, thing

DECOYS = 3
"""Decoys for each thing that is used."""

FILLERS = ("chair", "trash", "stool")
TRIES = 40
WALL_M = 0.1

USUAL = (
    "chair", "table", "chair", "counter", "trash", "sink", "chair", "whiteboard", "kettle", "cupboard", "drawer",
    "microwave", "stool", "table", "dishwasher", "coffee machine", "sofa", "chair", "screen", "counter",
)  # fmt: skip
"""What a room is filled up with, in this order."""


def walls(half: np.ndarray, doors: np.ndarray) -> list[SceneObject]:
    """Walls around a rectangle that leave its doors open."""
    found = []
    for side in range(4):
        along, across = (0, 1) if side % 2 == 0 else (1, 0)
        sign = 1.0 if side < 2 else -1.0
        gaps = sorted(
            float(door[along])
            for door in doors
            if abs(door[across] - sign * half[across]) < 0.01 and abs(door[along]) < half[along]
        )
        edges = [-half[along], *(edge for gap in gaps for edge in (gap - DOOR_M / 2, gap + DOOR_M / 2)), half[along]]
        for first, last in zip(edges[::2], edges[1::2], strict=True):
            if last - first < 0.2:
                continue
            middle = np.zeros(2)
            middle[along], middle[across] = (first + last) / 2, sign * (half[across] + WALL_M / 2)
            size = np.array([last - first, WALL_M, WALL_HEIGHT_M])
            angle = 0.0 if along == 0 else np.pi / 2
            name = f"wall {len(found) + 1}"
            found.append(thing(KINDS["wall"], name, size, float(middle[0]), float(middle[1]), 0.0, angle, "decoy"))
    return found


def decoys(
    used: list[str], count: int, taken: Footprint, ground: Ground, random: np.random.Generator
) -> list[SceneObject]:
    """Things in free space: three of the kind of each that is used, then the usual ones up to a count.

    Args:
        used: Kinds of the things that people use.
        count: How many decoys are wanted; more where the used kinds ask for it, fewer where there is no room.
        taken: Where bodies and things are; what is set down is added to it.
        ground: The room.
        random: Source of places and sizes.
    """
    needed = [kind for kind in used for _ in range(DECOYS)]
    usual = [USUAL[number % len(USUAL)] for number in range(max(count - len(needed), 0))]
    found: list[SceneObject] = []
    for names in (needed, usual):
        # large things first, and what stands on others last
        for name in sorted(names, key=_order):
            placed = _placed(name, ground, found, taken, random)
            if placed is None and names is needed:
                placed = _placed(name, ground, found, taken, random, smallest=True)
            if placed is not None:
                found.append(placed)
    # what found no place is made up for by small things
    for name in (*FILLERS,) * count:
        if len(found) >= count:
            break
        placed = _placed(name, ground, found, taken, random)
        if placed is not None:
            found.append(placed)
    return found


def _order(name: str) -> tuple[bool, float]:
    kind = KINDS[name]
    return kind.place == "top", -kind.least[0] * kind.least[1]


def _placed(
    name: str,
    ground: Ground,
    found: list[SceneObject],
    taken: Footprint,
    random: np.random.Generator,
    smallest: bool = False,
) -> SceneObject | None:
    """A thing of a kind where there is space for it, or None."""
    kind = KINDS[name]
    size = np.array(kind.least) if smallest else kind.size(random)
    if kind.place == "top":
        return _on_top(kind, ground.name(name), size, found, random)
    draw = _at_wall if kind.place in ("wall", "hung") else _anywhere
    for _ in range(TRIES):
        x, y, angle = draw(size, ground.half, random)
        if taken.free(x, y, angle, size[0], size[1]):
            taken.take(x, y, angle, size[0], size[1])
            height = HUNG_M if kind.place == "hung" else 0.0
            return thing(kind, ground.name(name), size, x, y, height, angle, "decoy")
    return None


def _anywhere(size: np.ndarray, half: np.ndarray, random: np.random.Generator) -> tuple[float, float, float]:
    edge = half - size[:2].max() / 2 - 0.05
    x, y = random.uniform(-edge, edge)
    # most furniture stands square to the walls
    angle = random.integers(4) * np.pi / 2 + (random.normal(0, 0.3) if random.random() < 0.5 else 0.0)
    return float(x), float(y), float(angle)


def _at_wall(size: np.ndarray, half: np.ndarray, random: np.random.Generator) -> tuple[float, float, float]:
    """With its back (its +x side) to one of the four walls."""
    side = int(random.integers(4))
    angle = side * np.pi / 2
    reach, spread = (half[0], half[1]) if side % 2 == 0 else (half[1], half[0])
    out = reach - size[0] / 2 - 0.01
    aside = random.uniform(-1, 1) * max(spread - size[1] / 2 - 0.05, 0)
    x, y = out * np.cos(angle) - aside * np.sin(angle), out * np.sin(angle) + aside * np.cos(angle)
    return float(x), float(y), float(angle)


def _on_top(
    kind: Kind, name: str, size: np.ndarray, found: list[SceneObject], random: np.random.Generator
) -> SceneObject | None:
    """On a table or a counter that has nothing there yet."""
    bases = [base for base in found if base.category in ("table", "cupboard") and base.size[2] < 1.0]
    for index in random.permutation(len(bases)):
        base = bases[index]
        aside = random.uniform(-1, 1) * max(float(base.size[1] - size[1]) / 2 - 0.02, 0)
        x, y, _ = base.outward(np.array([0.0, aside, 0.0]))
        top = float(base.position[2] + base.size[2] / 2)
        others = [other for other in found if abs(other.position[2] - other.size[2] / 2 - top) < 0.01]
        if all(np.hypot(other.position[0] - x, other.position[1] - y) > 0.4 for other in others):
            angle = yaw(base)
            return thing(kind, name, size, float(x), float(y), top, float(angle), "decoy")
    return None
