"""Distances from points to the surfaces of objects, exact for boxes, cylinders and meshes."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from motioncast.core.scene_object import SceneObject

Distance = Callable[[np.ndarray, np.ndarray], np.ndarray]

AT_ONCE = 4_000_000
"""Distances that are held at once: a limit of memory, not of what can be asked."""


def signed_distance(thing: SceneObject, points: np.ndarray) -> np.ndarray:
    """Distance of world points ``(..., 3)`` to the surface of an object that stands, ``(...)`` metres.

    Negative inside a box or a cylinder. Clouds and meshes have no inside: their distances are never negative.

    Example:
        >>> box = SceneObject("b", "table", "box", (2, 2, 2), (0, 0, 1))
        >>> signed_distance(box, np.array([[0, 0, 1], [2, 0, 1], [4, 5, 1.0]])).round(3).tolist()
        [-1.0, 1.0, 5.0]
    """
    points = np.asarray(points)
    near = thing.inward(points.reshape(-1, 3))
    if thing.shape == "box":
        x, y, z = np.ascontiguousarray(near.T)  # a row a coordinate: three times as fast
        width, depth, height = thing.size / 2
        found = _outside(np.abs(x) - width, np.abs(y) - depth, np.abs(z) - height)
    elif thing.shape == "cylinder":
        x, y, z = np.ascontiguousarray(near.T)
        radius, _, height = thing.size / 2
        found = _outside(np.sqrt(x * x + y * y) - radius, np.abs(z) - height)
    elif thing.shape == "points":
        assert thing.points is not None
        found = _in_parts(near, thing.points[:, None], _to_points)
    else:
        assert thing.points is not None
        assert thing.faces is not None
        found = _in_parts(near, thing.points[thing.faces], _to_triangles)
    return found.reshape(points.shape[:-1])


def surface_distance(thing: SceneObject, points: np.ndarray) -> np.ndarray:
    """Distance of world points ``(..., 3)`` to the surface of an object, ``(...)`` metres, also from inside.

    Example:
        >>> stool = SceneObject("s", "sittable", "cylinder", (0.4, 0.4, 0.5), (0, 0, 0.25))
        >>> surface_distance(stool, np.array([[0.0, 0.0, 0.25], [0.5, 0.0, 0.25]])).round(3).tolist()
        [0.2, 0.3]
    """
    return np.abs(signed_distance(thing, points))


def _outside(*beyond: np.ndarray) -> np.ndarray:
    """Signed distance from how far a point is beyond each pair of faces."""
    squares, deepest = np.zeros_like(beyond[0]), beyond[0]
    for distance in beyond:
        squares += np.maximum(distance, 0) ** 2
        deepest = np.maximum(deepest, distance)
    return np.sqrt(squares) + np.minimum(deepest, 0)


def _in_parts(points: np.ndarray, pieces: np.ndarray, distance: Distance) -> np.ndarray:
    """The least distance of each point ``(n, 3)`` to any piece ``(m, corners, 3)``."""
    rows = max(1, AT_ONCE // len(pieces))
    return np.concatenate([distance(points[start : start + rows], pieces) for start in range(0, len(points), rows)])


def _to_points(points: np.ndarray, cloud: np.ndarray) -> np.ndarray:
    cloud = cloud[:, 0]
    squares = (points**2).sum(-1)[:, None] - 2 * points @ cloud.T + (cloud**2).sum(-1)
    nearest = squares.argmin(1)
    return np.linalg.norm(points - cloud[nearest], axis=-1)


def _to_triangles(points: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """To the plane where a point projects into the triangle, else to the nearest edge."""
    a, b, c = triangles[:, 0], triangles[:, 1], triangles[:, 2]
    normal = np.cross(b - a, c - a)
    area = np.linalg.norm(normal, axis=-1)
    flat = area < 1e-12
    normal = normal / np.where(flat, 1, area)[:, None]
    height = np.einsum("nmk,mk->nm", points[:, None] - a, normal)
    inside = np.broadcast_to(~flat, height.shape).copy()
    nearest = np.full(height.shape, np.inf)
    for start, end in ((a, b), (b, c), (c, a)):
        along, away = end - start, points[:, None] - start
        inside &= np.einsum("nmk,mk->nm", away, np.cross(normal, along)) >= 0
        share = np.einsum("nmk,mk->nm", away, along) / np.maximum((along**2).sum(-1), 1e-12)
        rest = away - np.clip(share, 0, 1)[..., None] * along
        nearest = np.minimum(nearest, np.linalg.norm(rest, axis=-1))
    return np.where(inside, np.abs(height), nearest).min(1)
