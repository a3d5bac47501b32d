"""Where bodies have been: cells of 10 cm seen from above, over all frames and all people."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from motioncast.datasets.rooms.bodies import turned

CELL_M = 0.1
MARGIN_M = 0.25
"""Things keep this far from every joint of everybody."""


@dataclass(frozen=True, slots=True, eq=False)
class Footprint:
    """Cells of the floor that are taken.

    Attributes:
        taken: ``(cells along x, cells along y)`` bool.
        corner: Where the first cell begins, ``(2,)``.
    """

    taken: np.ndarray
    corner: np.ndarray

    def free(self, x: float, y: float, angle: float, length: float, width: float) -> bool:
        """Whether a rectangle lies on cells that are not taken."""
        return not self.taken[self._cells(x, y, angle, length, width)].any()

    def take(self, x: float, y: float, angle: float, length: float, width: float) -> None:
        """Mark a rectangle as taken, with a hand's breadth around it."""
        self.taken[self._cells(x, y, angle, length + CELL_M, width + CELL_M)] = True

    @property
    def share(self) -> float:
        """Share of the cells that are taken."""
        return float(self.taken.mean())

    def _cells(self, x: float, y: float, angle: float, length: float, width: float) -> tuple[np.ndarray, np.ndarray]:
        sides = [np.linspace(-side / 2, side / 2, int(side / CELL_M * 2) + 2) for side in (length, width)]
        points = np.stack([side.ravel() for side in np.meshgrid(*sides)], -1)
        points = turned(points, angle) + np.array([x, y])
        return tuple(np.clip((points - self.corner) // CELL_M, 0, np.array(self.taken.shape) - 1).astype(int).T)


def footprint(points: np.ndarray, half: np.ndarray, margin_m: float = MARGIN_M) -> Footprint:
    """The cells within a margin of any point.

    Args:
        points: Joints of everybody whenever they are there, ``(n, 3)`` or ``(n, 2)`` metres.
        half: Half the length and width of the room, ``(2,)``.
        margin_m: How far around a point is taken too.
    """
    corner = -np.asarray(half) - 1.0
    shape = np.ceil(-2 * corner / CELL_M).astype(int)
    cells = ((points[:, :2] - corner) // CELL_M).astype(int)
    cells = cells[np.all((cells >= 0) & (cells < shape), -1)]
    hit = np.zeros(shape, bool)
    hit[cells[:, 0], cells[:, 1]] = True
    taken = hit.copy()
    reach = int(np.ceil(margin_m / CELL_M))
    for dx in range(-reach, reach + 1):
        for dy in range(-reach, reach + 1):
            if 0 < dx * dx + dy * dy <= (margin_m / CELL_M) ** 2 + 1:
                taken |= np.roll(hit, (dx, dy), (0, 1))
    return Footprint(taken, corner)
