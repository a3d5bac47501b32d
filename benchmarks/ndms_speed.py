"""How long NDMS and UMWR of 1,000 forecasts of 250 frames take against 100,000 real words, and how much memory.

python benchmarks/ndms_speed.py                 # motion made up of slow waves
python benchmarks/ndms_speed.py --data DIR      # the open CMU benchmark's: takes for testing against takes for training
"""

from __future__ import annotations

import argparse
import resource
from pathlib import Path
from time import perf_counter, process_time

import numpy as np

from motioncast.benchmarks.open_cmu import single_scenes
from motioncast.core.skeletons import SKELETONS
from motioncast.metrics.ndms import dictionary, ndms
from motioncast.metrics.umwr import umwr
from motioncast.metrics.words import WORD, motion_words

FORECASTS, FRAMES, REAL_WORDS = 1_000, 250, 100_000
FPS = 25.0
SKELETON = SKELETONS["mrt15"]
HIPS = (SKELETON.landmarks.index("left_hip"), SKELETON.landmarks.index("right_hip"))


def waves(motions: int, seed: int, frames: int = FRAMES + WORD - 1) -> np.ndarray:
    """People whose joints swing slowly, ``(motions, frames, 15, 3)`` metres; each at a pace of their own."""
    random = np.random.default_rng(seed)
    body = random.normal(scale=0.5, size=(1, 1, 15, 3))
    body[..., HIPS, :] = [[-0.1, 0.0, 0.9], [0.1, 0.0, 0.9]]
    pace, phase = random.uniform(0.1, 1.5, (motions, 1, 6)), random.uniform(0, 2 * np.pi, (motions, 1, 6))
    swing = np.sin(2 * np.pi * pace * np.arange(frames)[:, None] / FPS + phase)
    reach = random.normal(scale=0.1, size=(motions, 6, 45))
    return (body + (swing @ reach).reshape(motions, frames, 15, 3)).astype(np.float32)


def recorded(data: Path, split: str) -> list[np.ndarray]:
    """The words of every take of a split, seen whole."""
    scenes = single_scenes(data, split, FPS, SKELETON)
    return [motion_words(scene.positions[:, 0], HIPS) for scene in scenes if scene.observed.all()]


def words(data: Path | None) -> tuple[np.ndarray, np.ndarray]:
    """Words of forecasts, ``(1000, 250, 8, 15, 3)``, and real ones, ``(100000, 8, 15, 3)``."""
    if data is None:
        real = motion_words(waves(REAL_WORDS // FRAMES, seed=1), HIPS)
        return motion_words(waves(FORECASTS, seed=2), HIPS), real.reshape(-1, *real.shape[2:])
    # short of takes, some stand in several times, a little turned out of shape so that no word comes twice
    parts = [np.concatenate(recorded(data, split)) for split in ("test", "train")]
    random = np.random.default_rng(0)
    forecasts, real = (
        part[np.arange(count) % len(part)] + random.normal(scale=0.005, size=(count, 1, 15, 3)).astype(np.float32)
        for part, count in zip(parts, (FORECASTS * FRAMES, REAL_WORDS), strict=True)
    )
    return forecasts.reshape(FORECASTS, FRAMES, *forecasts.shape[1:]), real


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--data", type=Path, help="folder with the data of the open CMU benchmark")
    forecasts, real = words(parser.parse_args().data)
    held = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1000
    begin, cpu = perf_counter(), process_time()
    known = dictionary(real)
    prepared = perf_counter()
    scores = ndms(forecasts, known)
    scored, spent = perf_counter(), process_time() - cpu
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1000
    print(f"{forecasts.shape[0]:,} forecasts of {forecasts.shape[1]} frames, {len(real):,} real words")
    print(f"prepare {prepared - begin:.1f} s, NDMS {scored - prepared:.1f} s, processor time of both {spent:.1f} s")
    print(f"peak {peak:.0f} MB, of which words {held:.0f} MB; mean NDMS {scores.mean():.3f}")
    begin = perf_counter()
    ratio = umwr(known.nearest(forecasts[:100])).mean()
    print(f"UMWR of 100 forecasts {perf_counter() - begin:.1f} s; mean {ratio:.3f}")


if __name__ == "__main__":
    main()
