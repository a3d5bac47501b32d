"""What a command says: answers on stdout, everything else on stderr."""

from __future__ import annotations

import json
import sys
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from typing import Any

import numpy as np


def complain(sentence: str, status: int) -> int:
    """Says why nothing came of it, on stderr, and hands the exit status through."""
    print(f"motioncast: {sentence}", file=sys.stderr)
    return status


def note(sentences: Iterable[str]) -> None:
    """Says aloud, on stderr, what was inferred or mended on the way."""
    for sentence in sentences:
        print(f"note: {sentence}", file=sys.stderr)


def emit(answer: Mapping[str, Any]) -> None:
    """Prints one JSON object to stdout; arrays become lists, floats keep seven digits."""
    json.dump(answer, sys.stdout, default=_plain, ensure_ascii=False, allow_nan=False)
    sys.stdout.write("\n")


def _plain(value: object) -> object:
    if isinstance(value, np.ndarray):
        # float32 has seven digits; more of them would double the text and mean nothing
        return np.round(value.astype(np.float64), 7).tolist() if value.dtype.kind == "f" else value.tolist()
    if isinstance(value, np.generic):
        return value.item()
    raise TypeError(f"{type(value).__name__} has no JSON form")


def table(columns: Sequence[str], rows: Iterable[Sequence[object]]) -> None:
    """Prints a table to stdout; the first column is text, the others are aligned to the right.

    Example:
        >>> table(("model", "ms"), [("fast", 3), ("paper", 12)])
        model  ms
        fast    3
        paper  12
    """
    lines = [[str(cell) for cell in row] for row in (columns, *rows)]
    widths = [max(map(len, column)) for column in zip(*lines, strict=True)]
    for first, *others in lines:
        cells = [
            first.ljust(widths[0]),
            *(cell.rjust(width) for cell, width in zip(others, widths[1:], strict=True)),
        ]
        print("  ".join(cells).rstrip())


@contextmanager
def progress(what: str) -> Iterator[Any]:
    """A progress bar on stderr; yields a function that takes the share done, 0 to 1.

    Nothing is drawn where stderr is not a terminal.
    """
    if not sys.stderr.isatty():
        yield lambda share: None
        return
    from rich.console import Console
    from rich.progress import Progress

    with Progress(console=Console(stderr=True), transient=True) as bar:
        task = bar.add_task(what, total=1.0)
        yield lambda share: bar.update(task, completed=share)
