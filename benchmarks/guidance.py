"""What keeping futures clear of things and of strangers changes, on validation rooms only.

    python benchmarks/guidance.py --data DIR [--model sast] [--rooms 24]

The same futures as they were denoised and as they are answered, beside what real people did.
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from time import process_time

import numpy as np

from motioncast.benchmarks.rooms.run import room_windows
from motioncast.benchmarks.rooms.scoring import FPS, HORIZON, Samples, figures_of
from motioncast.benchmarks.rooms.windows import RoomWindow
from motioncast.inference.denoiser import DiffusionForecaster
from motioncast.inference.registry import load
from motioncast.metrics.physical import mean_jerk

COLUMNS = (
    ("depth in things, mm", "depth_in_things", 1000), ("deeper than 2 cm, %", "frames_deeper_than_2_cm", 100),
    ("pairs in one another, %", "pairs_overlapping", 100), ("how deep, mm", "overlap_of_pairs", 1000),
    ("on a seat, % of sitting", "seat_under_sitting", 100), ("jump at the seam over real", "seam_over_real", 1),
    ("foot skating, m/s", "foot_skating", 1),
)  # fmt: skip
"""Heads, metrics and factors; jerk and time follow."""


def row(name: str, windows: Sequence[RoomWindow], samples: Samples, seconds: float | None = None) -> str:
    """A row of the table."""
    found = {figure.metric: figure for figure in figures_of(windows, samples) if figure.frame == HORIZON}
    ones = np.ones((1, len(windows)))
    cells = [f"{factor * float(found[metric].mean(ones)[0]):.3g}" for _, metric, factor in COLUMNS]
    jerk = np.mean([mean_jerk(futures[0].swapaxes(0, 1), FPS).mean() for futures in samples])
    time = "" if seconds is None else f"{1000 * seconds / len(windows):.0f}"
    return f"| {' | '.join([name, *cells, f'{jerk:.0f}', time])} |"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--data", type=Path, required=True, help="folder with the open motion data")
    parser.add_argument("--model", default="sast")
    parser.add_argument("--rooms", type=int, default=24)
    asked = parser.parse_args()
    guided = load(asked.model)
    assert isinstance(guided, DiffusionForecaster)
    windows = room_windows(asked.data, "validation", asked.rooms)
    heads = [f"{len(windows)} windows", *(head for head, _, _ in COLUMNS), "jerk, m/s³", "ms"]
    print(f"| {' | '.join(heads)} |\n|---|" + "---:|" * (len(heads) - 1))
    print(row("real", windows, [window.future[None] for window in windows]), flush=True)
    for name, model in (("as denoised", replace(guided, guided=False)), ("kept clear", guided)):
        begin = process_time()
        futures = [
            model.forecast(window.scene, horizon_s=HORIZON / FPS, seed=n).samples for n, window in enumerate(windows)
        ]
        print(row(name, windows, futures, process_time() - begin), flush=True)


if __name__ == "__main__":
    main()
