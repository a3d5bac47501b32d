"""Exact nearest neighbours of many points in many dimensions, within bounded memory."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass

import numpy as np

KEPT = 46
"""Axes of the first bounds: more make them tighter and dearer."""

QUERIES = 2048
"""Queries that are searched for together."""

ROWS, TILE = 512, 512
"""Queries and points of one product: its bounds are 1 MB, which the cache of a core holds."""

PAIRS = 256
"""Pairs that are measured at once."""

MANY = 8
"""Candidates of a query in a tile above which bounds over all axes are cheaper than measuring them."""


@dataclass(frozen=True, slots=True, eq=False)
class Neighbours:
    """Points to search, prepared; make one with :func:`prepare`.

    Turned to their principal axes, points differ mostly along the first few. With a point's first coordinates x and
    the length r of the rest, the triangle inequality bounds its squared distance to a query (y, s) from below by
    ``|x - y|^2 + (r - s)^2``. One matrix product a tile of points gives the bounds of a block of queries, of which only
    the least is kept; the point of the least bound of all gives a distance that is reached; only tiles whose least
    bound is not above that are looked at again, and only their points with such a bound are measured, in float64.

    Attributes:
        points: ``(points, dimensions)``.
        mean: Mean of the points.
        axes: Principal axes, ``(dimensions, dimensions)``, a column each, the most important first.
        tables: What is multiplied with queries, over the first axes and over all: ``(tiles, axes + 2, TILE)``, float32;
            behind the last point the bounds are infinite.
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
        blocks = [queries[start : start + QUERIES] for start in range(0, len(queries), QUERIES)]
        with ThreadPoolExecutor(threads) as pool:
            return np.concatenate([np.zeros(0, np.int64), *pool.map(self._block, blocks)])

    def _block(self, queries: np.ndarray) -> np.ndarray:
        queries = np.asarray(queries, np.float64)
        turned = (queries - self.mean) @ self.axes
        squares = np.square(turned).sum(-1)
        few = _factors(turned, self.tables[0].shape[1] - 2)
        least, closest = self._least(few)
        reached = np.square(queries - self.points[closest]).sum(-1) - squares
        # what float32 may have lost: a product of n terms errs by less than n eps times the product of the lengths
        doubt = np.finfo(np.float32).eps * (squares + self.extent)
        limit, limit_full = (
            np.nextafter((reached + (table.shape[1] + 6) * doubt).astype(np.float32), np.float32(np.inf))
            for table in self.tables
        )
        candidates = least <= limit
        answer, distance = np.zeros(len(queries), np.int64), np.full(len(queries), np.inf)
        for tile in np.flatnonzero(candidates.any(1)):
            rows = np.flatnonzero(candidates[tile])
            near = few[rows] @ self.tables[0][tile] <= limit[rows, None]
            if np.count_nonzero(near) > MANY * len(rows):
                full = _factors(turned[rows], turned.shape[1])
                near &= full @ self.tables[1][tile] <= limit_full[rows, None]
            row, column = np.divmod(np.flatnonzero(near), TILE)
            self._measure(queries, rows[row], column + tile * TILE, answer, distance)
        return answer

    def _least(self, few: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """The least bound of each tile, ``(tiles, queries)``, and the point of the least of all, ``(queries,)``."""
        least = np.empty((len(self.tables[0]), len(few)), np.float32)
        columns = np.empty(least.shape, np.int64)
        for start in range(0, len(few), ROWS):
            rows = slice(start, start + ROWS)
            every = np.arange(len(few[rows]))
            bounds = np.empty((len(every), TILE), np.float32)
            for tile, table in enumerate(self.tables[0]):
                np.matmul(few[rows], table, out=bounds)
                bounds.argmin(1, out=columns[tile, rows])
                least[tile, rows] = bounds[every, columns[tile, rows]]
        best = least.argmin(0)
        return least, best * TILE + columns[best, np.arange(len(few))]

    def _measure(
        self, queries: np.ndarray, rows: np.ndarray, columns: np.ndarray, answer: np.ndarray, distance: np.ndarray
    ) -> None:
        """Measure pairs of query and point; ``answer`` and ``distance`` hold which is nearest so far."""
        measured = np.empty(len(rows))
        for start in range(0, len(rows), PAIRS):
            pairs = slice(start, start + PAIRS)
            measured[pairs] = np.square(queries[rows[pairs]] - self.points[columns[pairs]]).sum(-1)
        order = np.lexsort((columns, measured, rows))
        order = order[np.flatnonzero(np.diff(rows[order], prepend=-1))]  # the nearest of each query
        order = order[measured[order] < distance[rows[order]]]  # earlier points come first, and win if equally near
        answer[rows[order]], distance[rows[order]] = columns[order], measured[order]


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
    # a tile at a time: in float64 all points would take twice their room
    tiles = (points[start : start + TILE] - mean for start in range(0, count, TILE))
    scatter = sum((tile.T @ tile for tile in tiles), np.zeros(2 * (dimensions,)))
    axes = np.linalg.eigh(scatter)[1][:, ::-1]
    kept = min(kept, dimensions)
    first, full = (np.zeros((-(-count // TILE), rows + 2, TILE), np.float32) for rows in (kept, dimensions))
    extent = 0.0
    for tile in range(len(first)):
        turned = (points[tile * TILE : (tile + 1) * TILE] - mean) @ axes
        squares = np.square(turned).sum(-1, keepdims=True)
        extent = max(extent, float(squares.max()))
        for table, number in ((first, kept), (full, dimensions)):
            table[tile, -1] = np.inf
            table[tile, :, : len(turned)] = np.concatenate([turned[:, :number], _rest(turned, number), squares], 1).T
    return Neighbours(points, mean, axes, (first, full), extent)


def _factors(turned: np.ndarray, kept: int) -> np.ndarray:
    """What a table is multiplied with, ``(queries, axes + 2)`` float32.

    The bound less the query's own square is ``|x|^2 + r^2 - 2 x y - 2 r s``.
    """
    parts = [-2 * turned[:, :kept], -2 * _rest(turned, kept), np.ones((len(turned), 1))]
    return np.concatenate(parts, 1).astype(np.float32)


def _rest(turned: np.ndarray, kept: int) -> np.ndarray:
    """Length of what lies along the axes that are not kept, ``(..., 1)``."""
    return np.linalg.norm(turned[..., kept:], axis=-1, keepdims=True)
