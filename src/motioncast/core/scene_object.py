"""Things in a scene: furniture, tools, walls."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from motioncast.core.rotation import to_matrix
from motioncast.errors import SceneError

CATEGORIES = (
    "whiteboard", "microwave", "kettle", "coffee_machine", "table", "sittable", "cupboard", "occluder", "dishwasher",
    "drawer", "sink", "trash", "out_of_bound",
)  # fmt: skip
"""What an object can be: the thirteen types of Humans in Kitchens, in its order."""

SHAPES = ("box", "cylinder", "points", "mesh")

LARGEST_M = 30.0
"""No object of a room is larger; one that is came in another unit."""


@dataclass(frozen=True, slots=True, eq=False)
class SceneObject:
    """One object: what it is, its shape in its own frame, and where that frame is; metres, z up.

    Attributes:
        name: What it is called, such as ``table 2``.
        category: One of ``CATEGORIES``.
        shape: ``box``, ``cylinder`` (standing along its own z), ``points`` or ``mesh``.
        size: Full extents of a box, or diameter, diameter and height of a cylinder, ``(3,)``. Of points and meshes:
            worked out.
        position: The middle of its frame in the world, ``(3,)``, or ``(time, 3)`` of an object that moves.
        rotation: How its frame is turned, unit quaternion wxyz ``(4,)``, or ``(time, 4)``. Default: not at all.
        points: Surface points or corners of triangles in its own frame, ``(n, 3)``.
        faces: Triangles of a mesh, ``(m, 3)`` indices.
        role: In composed rooms ``caused`` (it is there because somebody uses it) or ``decoy``; else empty.

    Raises:
        SceneError: If the shape is empty, absurdly large or not finite, or the category is unknown.

    Example:
        >>> table = SceneObject("table 1", "table", "box", (1.6, 0.8, 0.72), (2.0, 1.0, 0.36))
        >>> table.moves, table.at(-1).position.tolist()
        (False, [2.0, 1.0, 0.36000001430511475])
    """

    name: str
    category: str
    shape: str
    size: np.ndarray = None  # pyright: ignore[reportAssignmentType]  # filled on construction
    position: np.ndarray = None  # pyright: ignore[reportAssignmentType]
    rotation: np.ndarray = None  # pyright: ignore[reportAssignmentType]
    points: np.ndarray | None = None
    faces: np.ndarray | None = None
    role: str = ""

    def __post_init__(self) -> None:
        called = f'object "{self.name}"'
        if self.category not in CATEGORIES:
            raise SceneError(f'{called} has the category "{self.category}"; use one of {", ".join(CATEGORIES)}')
        if self.shape not in SHAPES:
            raise SceneError(f'{called} has the shape "{self.shape}"; use one of {", ".join(SHAPES)}')
        points = None if self.points is None else np.asarray(self.points, np.float32)
        faces = None if self.faces is None else np.asarray(self.faces, np.int32)
        if self.shape in ("points", "mesh"):
            if points is None or points.ndim != 2 or points.shape[1] != 3 or not len(points):
                raise SceneError(f"{called} is given by {self.shape} and has none; give at least one point (n, 3)")
            if self.shape == "mesh" and not _triangles(faces, len(points)):
                raise SceneError(f"{called} is a mesh without triangles of its points; give faces (m, 3) of indices")
            size = 2 * np.abs(points).max(0)
        else:
            size = np.asarray(self.size, np.float32)
        position = np.zeros(3) if self.position is None else np.asarray(self.position, np.float32)
        rotation = np.array([1, 0, 0, 0]) if self.rotation is None else np.asarray(self.rotation, np.float32)
        if size.shape != (3,) or position.shape[-1:] != (3,) or rotation.shape[-1:] != (4,):
            raise SceneError(
                f"{called} has size {size.shape}, position {position.shape} and rotation {rotation.shape}; "
                "expected (3,), (3,) and (4,), the last two with time in front where it moves"
            )
        if not all(
            np.isfinite(array).all() for array in (size, position, rotation, points if points is not None else size)
        ):
            raise SceneError(f"{called} has numbers that are not finite; give metres")
        if size.max() > LARGEST_M or (size < 0).any() or not size.any():
            told = " x ".join(f"{length:g}" for length in size)
            raise SceneError(f"{called} measures {told} m; expected metres, at most {LARGEST_M:g} and above 0")
        set_field = object.__setattr__
        set_field(self, "size", np.asarray(size, np.float32))
        set_field(self, "position", np.asarray(position, np.float32))
        set_field(self, "rotation", np.asarray(rotation, np.float32))
        set_field(self, "points", points)
        set_field(self, "faces", faces)

    @property
    def moves(self) -> bool:
        """Whether it has a place a frame."""
        return self.position.ndim > 1 or self.rotation.ndim > 1

    @property
    def frames(self) -> int | None:
        """Number of frames of an object that moves; None of one that stands."""
        moving = [array for array in (self.position, self.rotation) if array.ndim > 1]
        return len(moving[0]) if moving else None

    def at(self, frame: int) -> SceneObject:
        """The object as it stands in one frame."""
        return self[np.array(frame)]

    def __getitem__(self, frames: slice | np.ndarray) -> SceneObject:
        """The same object with only these frames, a slice or indices."""
        position = self.position[frames] if self.position.ndim > 1 else self.position
        rotation = self.rotation[frames] if self.rotation.ndim > 1 else self.rotation
        return replace(self, position=position, rotation=rotation)

    def inward(self, points: np.ndarray) -> np.ndarray:
        """World points ``(..., 3)`` in the frame of an object that stands."""
        return (points - self.position) @ to_matrix(self.rotation).astype(np.float32)

    def outward(self, points: np.ndarray) -> np.ndarray:
        """Points ``(..., 3)`` of the object's frame in the world."""
        return points @ to_matrix(self.rotation).astype(np.float32).T + self.position

    @property
    def corners(self) -> np.ndarray:
        """The eight corners of its bounding box in the world, ``(8, 3)``, of an object that stands."""
        signs = np.array([[x, y, z] for x in (-0.5, 0.5) for y in (-0.5, 0.5) for z in (-0.5, 0.5)])
        return self.outward(signs * self.size)


def _triangles(faces: np.ndarray | None, points: int) -> bool:
    """Whether there are triangles, and all of their corners are points."""
    return faces is not None and faces.shape[1:] == (3,) and faces.size > 0 and 0 <= faces.min() <= faces.max() < points
