"""Rotations: unit quaternions in the order w, x, y, z, over any batch of leading axes.

A rotation acts on column vectors: ``rotate(q, v)``. ``multiply(a, b)`` first turns by ``b``, then by ``a``.
"""

from __future__ import annotations

import numpy as np

IDENTITY = np.array([1.0, 0.0, 0.0, 0.0])


def normalise(quaternion: np.ndarray) -> np.ndarray:
    """Unit quaternions, ``(..., 4)``; a zero quaternion becomes the identity."""
    length = np.linalg.norm(quaternion, axis=-1, keepdims=True)
    return np.where(length > 1e-12, quaternion / np.maximum(length, 1e-12), IDENTITY)


def conjugate(quaternion: np.ndarray) -> np.ndarray:
    """The inverse rotation of unit quaternions, ``(..., 4)``."""
    return quaternion * np.array([1.0, -1.0, -1.0, -1.0])


def multiply(left: np.ndarray, right: np.ndarray) -> np.ndarray:
    """The product, ``(..., 4)``: first ``right``, then ``left``.

    Example:
        >>> half = from_axis_angle(np.array([0.0, 0.0, np.pi / 2]))
        >>> np.round(multiply(half, half), 6) + 0.0
        array([0., 0., 0., 1.])
    """
    w, x, y, z = np.moveaxis(np.asarray(left), -1, 0)
    a, b, c, d = np.moveaxis(np.asarray(right), -1, 0)
    return np.stack(
        [
            w * a - x * b - y * c - z * d,
            w * b + x * a + y * d - z * c,
            w * c - x * d + y * a + z * b,
            w * d + x * c - y * b + z * a,
        ],
        -1,
    )


def rotate(quaternion: np.ndarray, vector: np.ndarray) -> np.ndarray:
    """Turned vectors, ``(..., 3)``.

    Example:
        >>> quarter = from_axis_angle(np.array([0.0, 0.0, np.pi / 2]))
        >>> np.round(rotate(quarter, np.array([1.0, 0.0, 0.0])), 6) + 0.0
        array([0., 1., 0.])
    """
    axis = quaternion[..., 1:]
    turned = np.cross(axis, vector) * 2
    return vector + quaternion[..., :1] * turned + np.cross(axis, turned)


def from_axis_angle(vector: np.ndarray) -> np.ndarray:
    """Quaternions of rotation vectors ``(..., 3)``: the axis times the angle in radians."""
    angle = np.linalg.norm(vector, axis=-1, keepdims=True)
    # sin(a / 2) / a has the limit 1 / 2 at rest
    factor = np.where(angle > 1e-8, np.sin(angle / 2) / np.maximum(angle, 1e-8), 0.5)
    return np.concatenate([np.cos(angle / 2), vector * factor], -1)


def to_axis_angle(quaternion: np.ndarray) -> np.ndarray:
    """Rotation vectors ``(..., 3)`` of unit quaternions, angles up to pi."""
    quaternion = np.where(quaternion[..., :1] < 0, -quaternion, quaternion)
    sine = np.linalg.norm(quaternion[..., 1:], axis=-1, keepdims=True)
    angle = 2 * np.arctan2(sine, quaternion[..., :1])
    return quaternion[..., 1:] * np.where(sine > 1e-8, angle / np.maximum(sine, 1e-8), 2.0)


def from_matrix(matrix: np.ndarray) -> np.ndarray:
    """Quaternions of rotation matrices ``(..., 3, 3)``."""
    m = np.asarray(matrix, np.float64)
    trace = np.trace(m, axis1=-2, axis2=-1)
    diagonal = np.stack([m[..., 0, 0], m[..., 1, 1], m[..., 2, 2]], -1)
    # four squared components times four; the largest is safe to divide by
    squares = np.concatenate([1 + trace[..., None], 1 - trace[..., None] + 2 * diagonal], -1)
    largest = squares.argmax(-1)
    vector = np.stack([m[..., 2, 1] - m[..., 1, 2], m[..., 0, 2] - m[..., 2, 0], m[..., 1, 0] - m[..., 0, 1]], -1)
    symmetric = m + np.swapaxes(m, -1, -2)
    rows = np.empty((*m.shape[:-2], 4, 4))
    rows[..., 0, 0] = squares[..., 0]
    rows[..., 0, 1:] = rows[..., 1:, 0] = vector
    rows[..., 1:, 1:] = symmetric
    for axis in range(3):
        rows[..., axis + 1, axis + 1] = squares[..., axis + 1]
    return normalise(np.take_along_axis(rows, largest[..., None, None], -2)[..., 0, :])


def to_matrix(quaternion: np.ndarray) -> np.ndarray:
    """Rotation matrices ``(..., 3, 3)`` of unit quaternions."""
    return np.stack([rotate(quaternion, axis) for axis in np.eye(3)], -1)


def from_euler(angles: np.ndarray, order: str) -> np.ndarray:
    """Quaternions of Euler angles in radians, as a BVH file chains them.

    Args:
        angles: ``(..., len(order))`` angles in the order of ``order``.
        order: Axes such as ``"zxy"``: R = Rz Rx Ry, the last axis acts first.

    Example:
        >>> np.round(from_euler(np.array([np.pi / 2]), "x"), 3)
        array([0.707, 0.707, 0.   , 0.   ])
    """
    result = IDENTITY
    for column, axis in enumerate(order.lower()):
        vector = np.zeros((*angles.shape[:-1], 3))
        vector[..., "xyz".index(axis)] = angles[..., column]
        result = multiply(result, from_axis_angle(vector))
    return result


def to_euler(quaternion: np.ndarray, order: str) -> np.ndarray:
    """Euler angles in radians ``(..., 3)`` of unit quaternions, for three different axes.

    The middle angle lies within a quarter turn. At its ends (gimbal lock) the third angle is zero.
    """
    i, j, k = ("xyz".index(axis) for axis in order.lower())
    sign = 1.0 if (j - i) % 3 == 1 else -1.0
    matrix = to_matrix(quaternion)
    sine = np.clip(sign * matrix[..., i, k], -1, 1)
    locked = np.abs(sine) > 1 - 1e-10
    first = np.where(
        locked,
        np.arctan2(sign * matrix[..., k, j], matrix[..., j, j]),
        np.arctan2(-sign * matrix[..., j, k], matrix[..., k, k]),
    )
    third = np.where(locked, 0.0, np.arctan2(-sign * matrix[..., i, j], matrix[..., i, i]))
    return np.stack([first, np.arcsin(sine), third], -1)


def between(start: np.ndarray, end: np.ndarray) -> np.ndarray:
    """The shortest rotation (a swing, no twist) that turns direction ``start`` into ``end``, ``(..., 4)``.

    Opposite directions turn by pi about some axis across; a zero vector gives the identity.
    """
    start, end = np.broadcast_arrays(start, end)
    a = start / np.maximum(np.linalg.norm(start, axis=-1, keepdims=True), 1e-12)
    b = end / np.maximum(np.linalg.norm(end, axis=-1, keepdims=True), 1e-12)
    cosine = (a * b).sum(-1, keepdims=True)
    swing = np.concatenate([1 + cosine, np.cross(a, b)], -1)
    smallest = np.eye(3)[np.abs(a).argmin(-1)]
    across = np.concatenate([np.zeros_like(cosine), np.cross(a, smallest)], -1)
    there = (np.abs(a).sum(-1, keepdims=True) > 0.5) & (np.abs(b).sum(-1, keepdims=True) > 0.5)
    return np.where(there, normalise(np.where(cosine > -1 + 1e-9, swing, across)), IDENTITY)


def kabsch(rest: np.ndarray, bones: np.ndarray) -> np.ndarray:
    """The rotations ``(..., 4)`` that bring vectors ``rest`` closest to ``bones``, both ``(..., n, 3)``.

    Least squares by singular values: Kabsch, Acta Crystallographica A32 (1976) 922.
    """
    left, _, right = np.linalg.svd(np.swapaxes(bones, -1, -2) @ rest)
    left[..., 2] *= np.linalg.det(left @ right)[..., None]
    return from_matrix(left @ right)


def slerp(start: np.ndarray, end: np.ndarray, share: np.ndarray | float) -> np.ndarray:
    """Quaternions between two, along the shorter arc; ``share`` 0 gives start, 1 gives end."""
    step = to_axis_angle(multiply(end, conjugate(start)))
    return multiply(from_axis_angle(step * np.asarray(share)[..., None]), start)
