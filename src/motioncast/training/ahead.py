"""Batches prepared beside the training."""

from __future__ import annotations

from collections.abc import Iterator
from queue import Queue
from threading import Thread
from typing import TypeVar

Item = TypeVar("Item")


def ahead(items: Iterator[Item], depth: int = 3) -> Iterator[Item]:
    """The same items, in the same order, drawn by a thread of their own.

    Args:
        items: Items without end.
        depth: How many are kept ready.

    Raises:
        Exception: What drawing an item raised, when that item is asked for.

    Example:
        >>> from itertools import count
        >>> ready = ahead(count())
        >>> [next(ready) for _ in range(4)]
        [0, 1, 2, 3]
    """
    ready: Queue[tuple[Item | None, Exception | None]] = Queue(depth)

    def draw() -> None:
        try:
            for item in items:
                ready.put((item, None))
        except Exception as error:
            ready.put((None, error))

    Thread(target=draw, daemon=True).start()
    while True:
        item, error = ready.get()
        if error is not None:
            raise error
        yield item  # pyright: ignore[reportReturnType]
