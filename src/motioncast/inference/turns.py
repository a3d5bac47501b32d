"""Best-fitting turns of many joints in many frames, fast enough for a live stream.

``core.rotation.kabsch`` decomposes each matrix by itself; here one arithmetic serves all of them at once. The turn is
the eigenvector of the largest eigenvalue of a 4 x 4 matrix (Horn, J. Opt. Soc. Am. A 4 (1987) 629); that eigenvalue
is the largest root of its characteristic polynomial, found by Newton's steps from above, and the eigenvector is a
row of the adjugate (Theobald, Acta Cryst. A 61 (2005) 478).
"""

from __future__ import annotations

import numpy as np

STEPS = 20
"""Newton's steps at most; five are usual."""

STILL = 1e-7
"""Share of no turn in each fit: it settles the twist about a line, which would be left to rounding."""


def best_turns(fit: np.ndarray) -> np.ndarray:
    """Rotation matrices ``R``, ``(3, 3, ...)``, that make ``sum(R * fit)`` largest.

    With ``fit[i, j]`` the sum of ``after[i] * before[j]`` over vectors, ``R`` brings ``before`` closest to ``after``,
    as :func:`motioncast.core.rotation.kabsch` does. A matrix of zeros gives no turn. Entries come first, so that
    long rows of each are computed with at once.

    Example:
        >>> quarter = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
        >>> np.round(best_turns(quarter @ np.diag([3.0, 2.0, 1.0])), 5) + 0.0
        array([[ 0., -1.,  0.],
               [ 1.,  0.,  0.],
               [ 0.,  0.,  1.]])
    """
    size = np.sqrt(np.square(fit).sum((0, 1)))
    m = fit / np.maximum(size, 1e-30) + STILL * np.eye(3).reshape(3, 3, *(1,) * size.ndim)
    (xx, xy, xz), (yx, yy, yz), (zx, zy, zz) = m
    rows = (
        (xx + yy + zz, zy - yz, xz - zx, yx - xy),
        (zy - yz, xx - yy - zz, xy + yx, xz + zx),
        (xz - zx, xy + yx, yy - xx - zz, yz + zy),
        (yx - xy, xz + zx, yz + zy, zz - xx - yy),
    )
    return _matrices(_eigenvector(rows, _largest_root(m)))


def _largest_root(m: np.ndarray) -> np.ndarray:
    """Largest eigenvalue of Horn's matrix: the sum of the singular values, the last one negative for a mirror."""
    cofactors = np.stack([np.stack(_cross(m[(row + 1) % 3], m[(row + 2) % 3])) for row in range(3)])
    squares, pairs = np.square(m).sum((0, 1)), np.square(cofactors).sum((0, 1))
    determinant = (m[0] * cofactors[0]).sum(0)
    # the square of the sum is sum(s^2) + 2 sum(s s'), and sum(s s') at most sqrt(3 sum((s s')^2)): close from above
    root = np.sqrt(squares + 2 * np.sqrt(3 * pairs))
    constant, twice, linear = squares * squares - 4 * pairs, 2 * squares, 8 * determinant
    for _ in range(STEPS):
        square = root * root
        value = (square - twice) * square - linear * root + constant
        slope = 4 * (square - squares) * root - linear
        step = np.maximum(value, 0) / np.maximum(slope, 1e-30)
        root = root - step
        if step.max(initial=0) < 1e-14:
            break
    return root


def _eigenvector(rows: tuple[tuple[np.ndarray, ...], ...], value: np.ndarray) -> np.ndarray:
    """Quaternions ``(4, ...)``, not yet of length 1: the longest row of the adjugate of the matrix minus a value."""
    (a, b, c, d), (_, e, f, g), (_, _, h, i), (_, _, _, j) = rows
    a, e, h, j = a - value, e - value, h - value, j - value
    # minors of the upper two rows (p) and of the lower two (q), by the columns that they take
    p01, p02, p03, p12, p13 = a * e - b * b, a * f - c * b, a * g - d * b, b * f - c * e, b * g - d * e
    p23 = c * g - d * f
    q02, q03, q12, q13, q23 = c * i - h * d, c * j - i * d, f * i - h * g, f * j - i * g, h * j - i * i
    ab, ac, ad = c * q13 - b * q23 - d * q12, g * p23 - i * p13 + j * p12, h * p13 - f * p23 - i * p12
    bc, bd, cd = i * p03 - d * p23 - j * p02, c * p23 - h * p03 + i * p02, f * p03 - c * p13 - i * p01
    adjugate = (
        (e * q23 - f * q13 + g * q12, ab, ac, ad),
        (ab, a * q23 - c * q03 + d * q02, bc, bd),
        (ac, bc, d * p13 - g * p03 + j * p01, cd),
        (ad, bd, cd, c * p12 - f * p02 + h * p01),
    )
    best, longest = np.stack(adjugate[0]), np.abs(adjugate[0][0])
    for row in range(1, 4):
        length = np.abs(adjugate[row][row])
        longer = length > longest
        if longer.any():  # that is after turns beyond a right angle
            best = np.where(longer, np.stack(adjugate[row]), best)
            longest = np.maximum(length, longest)
    return best


def _matrices(quaternion: np.ndarray) -> np.ndarray:
    """Rotation matrices ``(3, 3, ...)`` of quaternions ``(4, ...)`` of any length."""
    w, x, y, z = quaternion / np.sqrt(np.square(quaternion).sum(0))
    entries = [
        1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y),
        2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x),
        2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y),
    ]  # fmt: skip
    return np.stack(entries).reshape(3, 3, *w.shape)


def _cross(a: np.ndarray, b: np.ndarray) -> tuple[np.ndarray, ...]:
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]
