"""Exact nearest neighbours of many points in many dimensions, within bounded memory."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass

import numpy as np

KEPT = 46
"""Axes of the first bounds: more make them tighter and dearer."""

QUERIES = 64
"""Queries of a block: with 100,000 points its bounds are 26 MB."""

PAIRS = 2048
"""Pairs that are measured at once."""

MANY = 512
"""Candidates of a query above which bounds over all axes are cheaper than measuring them."""


@dataclass(frozen=True, slots=True, eq=False)
class Neighbours:
    """Points to search, prepared; make one with :func:`prepare`.

    Turned to their principal axes, points differ mostly along the first few. With a point's first coordinates x and
    the length r of the rest, the triangle inequality bounds its squared distance to a query (y, s) from below by
    ``|x - y|^2 + (r - s)^2``. One matrix product gives the bounds of a block of queries; the point of the least bound
    gives a distance that is reached; only points whose bound is not above that are measured, in float64.

    Attributes:
        points: ``(points, dimensions)``.
        mean: Mean of the points.
        axes: Principal axes, ``(dimensions, dimensions)``, a column each, the most important first.
        tables: What is multiplied with queries, over the first axes and over all: ``(axes + 2, points)``, float32.
        extent: Largest squared length of a point, from the mean.
    """

    points: np.ndarray
    mean: np.ndarray
    axes: np.ndarray
    tables: tuple[np.ndarray, np.ndarray]
    extent: float

    def nearest(self, queries: np.ndarray, threads: int = 2) -> np.ndarray:
        """Index of the nearest point of each query, ``(queries,)``; of equally near ones the first.

        Args:
            queries: ``(queries, dimensions)``, finite.
            threads: Number of threads that share the queries.

        Example:
            >>> prepare(np.array([[0.0, 0.0], [3.0, 4.0], [3.0, 4.0]])).nearest(np.array([[2.0, 2.0], [2.0, 0.0]]))
            array([1, 0])
        """
        with ThreadPoolExecutor(threads) as pool:
            shares = pool.map(lambda share: self._search(share, self.tables[0]), np.array_split(queries, threads))
            return np.concatenate(list(shares))

    def _search(self, queries: np.ndarray, table: np.ndarray) -> np.ndarray:
        # two buffers for all blocks: fresh ones would cost as much time as the product
        bounds = np.empty((QUERIES, len(self.points)), np.float32)
        near = np.empty(bounds.shape, bool)
        answer = np.empty(len(queries), np.int64)
        for start in range(0, len(queries), QUERIES):
            block = np.asarray(queries[start : start + QUERIES], np.float64)
            answer[start : start + QUERIES] = self._block(block, table, bounds[: len(block)], near[: len(block)])
        return answer

    def _block(self, queries: np.ndarray, table: np.ndarray, bounds: np.ndarray, near: np.ndarray) -> np.ndarray:
        turned = (queries - self.mean) @ self.axes
        squares = np.square(turned).sum(-1)
        kept = len(table) - 2
        # the bound less the query's own square is |x|^2 + r^2 - 2 x y - 2 r s
        row = np.concatenate([-2 * turned[:, :kept], -2 * _rest(turned, kept), np.ones((len(queries), 1))], 1)
        np.matmul(row.astype(np.float32), table, out=bounds)
        reached = np.square(queries - self.points[bounds.argmin(1)]).sum(-1)
        # what float32 may have lost: a product of n terms errs by less than n eps times the product of the lengths
        doubt = (kept + 8) * np.finfo(np.float32).eps * (squares + self.extent)
        limit = np.nextafter((reached - squares + doubt).astype(np.float32), np.float32(np.inf))
        np.less_equal(bounds, limit[:, None], out=near)
        counts = np.count_nonzero(near, axis=1)
        answer = np.empty(len(queries), np.int64)
        crowded = (counts > MANY) & (table is not self.tables[1])
        if crowded.any():
            near[crowded] = False
            answer[crowded] = self._search(queries[crowded], self.tables[1])
        answer[~crowded] = self._measured(queries, near)
        return answer

    def _measured(self, queries: np.ndarray, near: np.ndarray) -> np.ndarray:
        """The nearest candidate of each query that has any."""
        rows, columns = np.divmod(np.flatnonzero(near), near.shape[1])
        distances = np.empty(len(rows))
        for start in range(0, len(rows), PAIRS):
            pairs = slice(start, start + PAIRS)
            distances[pairs] = np.square(queries[rows[pairs]] - self.points[columns[pairs]]).sum(-1)
        order = np.lexsort((columns, distances, rows))
        first = np.flatnonzero(np.diff(rows, prepend=-1))  # rows came in order
        return columns[order[first]]


def prepare(points: np.ndarray, kept: int = KEPT) -> Neighbours:
    """Points made ready for searching.

    Args:
        points: ``(points, dimensions)``, finite.
        kept: Axes of the first bounds.

    Raises:
        ValueError: If there is no point.
    """
    count, dimensions = points.shape
    if not count:
        raise ValueError("no point to search among came; give at least one")
    mean = points.mean(0, dtype=np.float64)
    # a block at a time: in float64 all points would take twice their room
    blocks = [slice(start, start + PAIRS) for start in range(0, count, PAIRS)]
    scatter = sum(((points[block] - mean).T @ (points[block] - mean) for block in blocks), np.zeros(2 * (dimensions,)))
    axes = np.linalg.eigh(scatter)[1][:, ::-1]
    kept = min(kept, dimensions)
    first, full = np.empty((kept + 2, count), np.float32), np.empty((dimensions + 2, count), np.float32)
    for block in blocks:
        turned = (points[block] - mean) @ axes
        squares = np.square(turned).sum(-1, keepdims=True)
        for table, number in ((first, kept), (full, dimensions)):
            table[:, block] = np.concatenate([turned[:, :number], _rest(turned, number), squares], 1).T
    return Neighbours(points, mean, axes, (first, full), float(full[-1].max()))


def _rest(turned: np.ndarray, kept: int) -> np.ndarray:
    """Length of what lies along the axes that are not kept, ``(..., 1)``."""
    return np.linalg.norm(turned[..., kept:], axis=-1, keepdims=True)
