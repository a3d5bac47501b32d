"""Boxes and cylinders that stand, to be looked at all at once: many times faster than one by one."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from motioncast.core.rotation import to_matrix
from motioncast.core.scene_object import SceneObject


@dataclass(frozen=True, slots=True, eq=False)
class Solids:
    """Things with an inside, to be looked at all at once.

    Attributes:
        centres: ``(things, 3)``.
        axes: Their own axes in the world, in columns, ``(things, 3, 3)``.
        halves: Half of their extents, ``(things, 3)``.
        round: Which of them are cylinders, ``(things,)``.

    Example:
        >>> shapes = ("box", "cylinder")
        >>> things = Solids.of([SceneObject(shape, "table", shape, (2, 2, 1), (0, 0, 0.5)) for shape in shapes])
        >>> things.depth(np.array([[0.9, 0.9, 0.5], [0.6, 0.0, 0.9]])).round(2)
        array([0.1, 0.1])
        >>> things.depth(np.array([[0.9, 0.9, 0.5]])).round(2)
        array([0.1, 0. ])
    """

    centres: np.ndarray
    axes: np.ndarray
    halves: np.ndarray
    round: np.ndarray

    @classmethod
    def of(cls, things: Sequence[SceneObject]) -> Solids:
        """The boxes and cylinders of some things that stand."""
        solid = [thing for thing in things if thing.shape in ("box", "cylinder")]
        place = np.array([(*thing.position, *thing.rotation, *thing.size) for thing in solid], np.float64).reshape(
            -1, 10
        )
        cylinders = np.array([thing.shape == "cylinder" for thing in solid], bool)
        return cls(place[:, :3], to_matrix(place[:, 3:7]), place[:, 7:] / 2, cylinders)

    def __getitem__(self, which: np.ndarray | slice | list[int]) -> Solids:
        """Some of them."""
        return Solids(self.centres[which], self.axes[which], self.halves[which], self.round[which])

    def __len__(self) -> int:
        return len(self.centres)

    def near(self, path: np.ndarray, reach_m: float) -> Solids:
        """Those that somebody who goes along a path ``(time, 2)`` over the ground and reaches so far can touch."""
        away = np.linalg.norm(path[:, None] - self.centres[:, :2], axis=-1).min(0, initial=np.inf)
        return self[away < np.linalg.norm(self.halves[:, :2], axis=-1) + reach_m]

    def inward(self, body: np.ndarray) -> np.ndarray:
        """A body ``(..., joints, 3)`` as each sees it, ``(things, ..., joints, 3)``."""
        flat = body.reshape(-1, 3) - self.centres[:, None]
        return (flat @ self.axes).reshape(len(self), *body.shape)

    def depth(self, body: np.ndarray) -> np.ndarray:
        """How deep the deepest joint of a body ``(..., joints, 3)`` is in each, ``(things, ...)``; 0 outside."""
        own = self.inward(body)
        shape = (-1, *[1] * (body.ndim - 1))
        x, y, z = (self.halves[:, axis].reshape(shape) for axis in range(3))
        aside = np.minimum(x - np.abs(own[..., 0]), y - np.abs(own[..., 1]))
        if self.round.any():
            aside = np.where(self.round.reshape(shape), x - np.hypot(own[..., 0], own[..., 1]), aside)
        return np.maximum(np.minimum(aside, z - np.abs(own[..., 2])).max(-1), 0)
