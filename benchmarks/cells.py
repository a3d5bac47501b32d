"""Cells of the tables that programs write into the docs."""

from __future__ import annotations

from motioncast.benchmarks.result import Row


def cell(row: Row | None, digits: int, scale: float) -> str:
    """A figure and half of its interval, both times ``scale``; a dash where there is none."""
    if row is None:
        return "-"
    text = f"{scale * row.value:.{digits}f}"
    if row.low is None or row.high is None:
        return text
    return f"{text} ±{scale * (row.high - row.low) / 2:.{digits}f}"
