"""Manifests: a table of a benchmark's windows by which anyone can tell that he built the same ones.

For each group of people of a window: the take, its first and last frame, where it was set down (composed scenes), and
for the window a checksum of its positions at 0.1 mm.
"""

from __future__ import annotations

import csv
import hashlib
import io

from motioncast.benchmarks.protocol import Protocol, tenths_mm
from motioncast.datasets.windows import COMPOSED, Windows

COLUMNS = ("window", "take", "first_frame", "last_frame", "fps", "x_m", "y_m", "angle_rad", "sha256")


def manifest(protocol: Protocol, windows: Windows) -> str:
    """The manifest of windows as CSV."""
    out = io.StringIO()
    table = csv.writer(out, lineterminator="\n")
    table.writerow(COLUMNS)
    length = windows.positions.shape[1]
    for index, (takes, starts) in enumerate(zip(windows.takes, windows.starts, strict=True)):
        digest = hashlib.sha256(tenths_mm(windows.positions[index])).hexdigest()[:16]
        for group, (take, start) in enumerate(zip(takes.split(COMPOSED), starts, strict=True)):
            place = [f"{value:.4f}" for value in windows.places[index][group]] if windows.places else ["", "", ""]
            table.writerow([index, take, start, start + length - 1, f"{protocol.fps:g}", *place, digest])
    return out.getvalue()
