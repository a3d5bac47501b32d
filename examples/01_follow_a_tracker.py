"""Forecast live: push each frame of a tracker, read the next seconds at once.

python examples/01_follow_a_tracker.py take.npz      # the file plays the tracker
"""

from __future__ import annotations

import sys

import numpy as np

import motioncast as mc


def main(path: str) -> None:
    take = mc.load_scene(path)
    live = mc.load("somoformer-fast").stream(fps=take.fps, skeleton=take.skeleton)

    for number, (pose, seen) in enumerate(zip(take.positions, take.observed, strict=True)):
        frame = {
            person: np.where(seen[row][:, None], pose[row], np.nan)  # NaN: this joint was not seen
            for row, person in enumerate(take.people)
            if seen[row].any()
        }
        forecast = live.push(frame, time_s=number / take.fps)
        if forecast is None or number % 30:
            continue
        # in the first second a simple guess answers, and says so
        how = "guessed" if forecast.guessed.any() else "forecast"
        ahead = forecast.best[-1].mean((0, 1))
        print(f"{number / take.fps:5.2f} s: {how}, in {forecast.horizon_s:.1f} s they are near {ahead.round(2)}")


if __name__ == "__main__":
    main(*sys.argv[1:])
