"""The ground of a room while it fills: where one may walk, what stands there, and who is where when."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from motioncast.core.scene_object import SceneObject
from motioncast.datasets.rooms.contacts import FPS

PERSONAL_SPACE_M = 0.75
"""Pelvises of two strangers never come closer than this."""

WALL_M = 0.45
"""A walking pelvis keeps this far from walls, doors apart."""

THING_M = 0.35
"""A walking pelvis keeps this far from the edge of a thing."""

DOOR_M = 1.1
OUTSIDE_M = 1.2
LOOKED_AT = 3

LEAD = round(8 * FPS)
"""Frames that are made and thrown away, so that a room does not start empty."""
"""Width of a door, and how far beyond the wall one is still in sight."""


@dataclass(slots=True, eq=False)
class Ground:
    """A rectangle with doors, things on it, and people who already have their ways.

    Attributes:
        half: Half its length and width, ``(2,)`` metres; it is centred on the origin.
        doors: Middle of each door in the wall and the direction that leads in, ``(doors, 3)``: x, y, angle.
        frames: Length of the scene.
        people: Pelvis paths, each ``(frames, 2)``, not a number while somebody is away.
        things: Circles that nobody may walk into, ``(x, y, radius)``.
        items: The things themselves, of people who already have their ways.
        bodies: Joints of these people, every third frame, each ``(n, 31, 3)``.
        named: How many things have a name.
    """

    half: np.ndarray
    doors: np.ndarray
    frames: int
    people: list[np.ndarray] = field(default_factory=list)
    things: list[tuple[float, float, float]] = field(default_factory=list)
    items: list[SceneObject] = field(default_factory=list)
    bodies: list[np.ndarray] = field(default_factory=list)
    named: int = 0

    def name(self, kind: str) -> str:
        """A new name for a thing of a kind."""
        self.named += 1
        return f"{kind} {self.named}"

    def free(self, paths: np.ndarray, start: int) -> np.ndarray:
        """Which of some pelvis paths ``(ways, time, 2)`` from a frame on touch nobody and nothing, ``(ways,)`` bool.

        Every third frame is looked at: nobody makes 30 cm in between.
        """
        paths = paths[:, ::LOOKED_AT]
        free = self.inside(paths)
        if free.any():
            free[free] = self.clear_of_things(paths[free])
        if free.any():
            free[free] = self.clear_of_people(paths[free], start)
        return free

    def inside(self, paths: np.ndarray) -> np.ndarray:
        """Which paths stay within the walls or pass through a door."""
        fits = np.all(np.abs(paths) <= self.half - WALL_M, -1)
        for x, y, angle in self.doors:
            ahead = np.array([np.cos(angle), np.sin(angle)])
            way = paths - [x, y]
            along, aside = way @ ahead, way @ [-ahead[1], ahead[0]]
            fits |= (np.abs(aside) < DOOR_M / 2 - 0.25) & (np.abs(along) < OUTSIDE_M)
        return fits.all(-1)

    def clear_of_things(self, paths: np.ndarray) -> np.ndarray:
        """Which paths keep their distance from all things."""
        clear = np.ones(len(paths), bool)
        for x, y, radius in self.things:
            clear &= (np.square(paths - [x, y]).sum(-1) > (radius + THING_M) ** 2).all(-1)
        return clear

    def clear_of_people(self, paths: np.ndarray, start: int) -> np.ndarray:
        """Which paths, every third frame of them, keep people's personal space."""
        clear = np.ones(len(paths), bool)
        for other in self.people:
            there = other[start::LOOKED_AT][: paths.shape[1]]
            square = np.square(paths[:, : len(there)] - there).sum(-1)
            clear &= ~(square < PERSONAL_SPACE_M**2).any(-1)  # not a number is no collision
        return clear
