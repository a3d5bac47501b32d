"""Characteristic moments as a small table between tabs: one moment a line, of one motion or of many takes.

Its columns are ``COLUMNS``, its first line names them.
"""

from __future__ import annotations

import csv
import io
import math
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

from motioncast.errors import FormatError
from motioncast.formats.files import atomic_write, read_text

COLUMNS = ("take", "person", "second", "extent_m", "source", "note")

SOURCES = ("auto", "accepted", "manual", "rejected")
"""Found by the rule and not looked at; looked at and right; set by a person; looked at and wrong."""


@dataclass(frozen=True, slots=True, order=True)
class Moment:
    """A characteristic moment of one person.

    Attributes:
        take: Name of the motion: that of its file without the suffix.
        person: Who.
        second: When, from the first frame on.
        extent_m: How far hands, feet and head are from their usual places (``datasets.moments``).
        source: One of ``SOURCES``.
        note: Anything in one line.
    """

    take: str
    person: str
    second: float
    extent_m: float
    source: str = "auto"
    note: str = ""


def write_moments(path: str | Path, moments: Iterable[Moment]) -> None:
    """Write a table of moments, sorted by take, person and time: whole or not at all.

    Raises:
        OutputError: If it cannot be written.
    """
    with atomic_write(path) as temporary:
        temporary.write_text(moments_text(moments), encoding="utf-8", newline="\n")


def moments_text(moments: Iterable[Moment]) -> str:
    r"""The table as text.

    Example:
        >>> moments_text([Moment("walk", "Ann", 1.5, 0.91)]).splitlines()[1]
        'walk\tAnn\t1.500\t0.910\tauto\t'
    """
    out = io.StringIO()
    table = csv.writer(out, delimiter="\t", quoting=csv.QUOTE_NONE, quotechar=None, lineterminator="\n")
    table.writerow(COLUMNS)
    for entry in sorted(moments):
        plain = (" ".join(text.split()) for text in (entry.take, entry.person, entry.note))
        take, person, note = plain
        table.writerow([take, person, f"{entry.second:.3f}", f"{entry.extent_m:.3f}", entry.source, note])
    return out.getvalue()


def read_moments(path: str | Path) -> list[Moment]:
    """Read a table of moments.

    Raises:
        InputError: If there is no such file.
        FormatError: If it is no such table, naming the line.
    """
    lines = read_text(path).splitlines()
    if not lines or tuple(lines[0].split("\t")) != COLUMNS:
        raise FormatError(path, f"is no table of moments; expected a first line {', '.join(COLUMNS)} between tabs", 1)
    return [_moment(path, number, line) for number, line in enumerate(lines[1:], 2) if line.strip()]


def _moment(path: str | Path, number: int, line: str) -> Moment:
    cells = line.split("\t")
    if len(cells) != len(COLUMNS):
        raise FormatError(path, f"has {len(cells)} cells; expected {len(COLUMNS)} between tabs", number)
    take, person, second, extent, source, note = cells
    if source not in SOURCES:
        raise FormatError(path, f'the source is "{source}"; expected one of {", ".join(SOURCES)}', number)
    return Moment(
        take, person, _number(path, number, "second", second), _number(path, number, "extent_m", extent), source, note
    )


def _number(path: str | Path, line: int, column: str, text: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not (math.isfinite(value) and value >= 0):
        raise FormatError(path, f'{column} is "{text}"; expected a number from 0 on', line)
    return value
