"""Is the model better than standing still? Compare it with simple guesses on your own recording.

python examples/03_compare_with_simple_guesses.py take.npz
"""

from __future__ import annotations

import sys

import motioncast as mc
from motioncast.metrics.curve import error_at, error_curve

NAMES = ("somoformer-fast", "zero-velocity", "constant-velocity", "neck-velocity", "root-velocity-damped")
MOMENTS_S = (0.2, 0.4, 1.0, 2.0, 3.0)


def main(*paths: str) -> None:
    take = mc.load_scene(*paths)
    now = take.frames - round(3.0 * take.fps)
    history, truth = take[:now], take[now:]

    print("error in mm".ljust(22), *(f"{seconds:g} s".rjust(6) for seconds in MOMENTS_S))
    for name in NAMES:
        curve = error_curve(mc.load(name).forecast(history, horizon_s=3.0), truth)
        errors = [error_at(curve, seconds, take.fps) for seconds in MOMENTS_S]
        cells = ("-" if error is None else f"{error * 1000:.0f}" for error in errors)
        print(name.ljust(22), *(cell.rjust(6) for cell in cells))


if __name__ == "__main__":
    main(*sys.argv[1:])
