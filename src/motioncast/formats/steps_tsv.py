r"""Steps of a video as a small table between tabs: when each begins and ends, what is done, and the frame of its pose.

    first   end   action      person   characteristic
    0       131   take                 102
    131     260   wash

``first`` is the first frame and ``end`` the one after the last. ``person`` (from 0) and ``characteristic`` may be left
out; where no frame is named, the most articulated one of the step is taken (``core.upper_body.most_articulated``).
"""

from __future__ import annotations

import csv
from dataclasses import dataclass
from pathlib import Path

from motioncast.errors import FormatError, InputError
from motioncast.formats.files import read_text

NEEDED = ("first", "end", "action")


@dataclass(frozen=True, slots=True)
class Span:
    """One step of one person.

    Attributes:
        first: Its first frame.
        end: The frame after its last.
        action: What is done.
        person: Who, from 0.
        characteristic: The frame of its pose; None where nobody said.
    """

    first: int
    end: int
    action: str
    person: int = 0
    characteristic: int | None = None


def read_steps(path: str | Path) -> list[Span]:
    """The steps of a table, in order of time.

    Raises:
        InputError: If there is no such file, or it holds no step.
        FormatError: If a line is damaged, naming it.
    """
    path = Path(path)
    if not path.is_file():
        raise InputError(f"there is no file {path}; give a table of steps with the columns {', '.join(NEEDED)}")
    table = csv.DictReader(read_text(path).splitlines(), delimiter="\t")
    if not set(NEEDED) <= set(table.fieldnames or ()):
        raise FormatError(path, f"the columns are {table.fieldnames}; expected {', '.join(NEEDED)} between tabs", 1)
    found = []
    for line, row in enumerate(table, 2):
        try:
            frame = (row.get("characteristic") or "").strip()
            span = Span(
                int(row["first"]),
                int(row["end"]),
                row["action"].strip(),
                int((row.get("person") or "0").strip() or 0),
                int(frame) if frame else None,
            )
        except (TypeError, ValueError, AttributeError):
            raise FormatError(path, f"{row} is no step; expected numbers of frames and an action", line) from None
        inside = span.characteristic is None or span.first <= span.characteristic < span.end
        if not (0 <= span.first < span.end and inside and span.action and span.person >= 0):
            raise FormatError(
                path, f"{row} is no step; expected first < end, an action, and the characteristic frame between", line
            )
        found.append(span)
    if not found:
        raise InputError(f"{path} holds no step; give one a line")
    return sorted(found, key=lambda span: (span.first, span.person))
