"""What samplers and their steps make of SAST's futures, on validation rooms: nothing of this looks at the test rooms.

    python benchmarks/sampling.py --data DIR [--model sast] [--rooms 10]

For each sampler: processor seconds, jump of the velocity at the seam over its changes in real motion, jerk, distance
between two futures, error of one and of the better of two for a person, and the path that people go in ten seconds.
"""

from __future__ import annotations

import argparse
from pathlib import Path
from time import process_time

import numpy as np

from motioncast.core.scene import Scene
from motioncast.core.skeletons import SKELETONS
from motioncast.datasets.rooms import rooms
from motioncast.inference.denoiser import DiffusionForecaster
from motioncast.inference.registry import load

SAMPLINGS = (
    ("dpm-solver++", 5), ("dpm-solver++", 10), ("dpm-solver++", 20), ("dpm-solver++", 50),
    ("unipc", 10), ("ddim", 20), ("ddim", 50), ("ddpm", 100),
)  # fmt: skip
SEED, NOW_S = 2026, 6.0
COLUMNS = ("s", "seam over real", "jerk m/s3", "apart m", "error of one m", "better of two m", "path m", "true path m")


def questions(data: Path, count: int, model: DiffusionForecaster) -> list[tuple[Scene, Scene]]:
    """History and future of each room in which somebody is there at now and there is a future."""
    card, found = model.card, []
    for room in rooms(data, "validation", count, SEED):
        scene, now = room.scene.on(SKELETONS[card.skeleton]), round(NOW_S * card.fps)
        if scene.frames >= now + card.horizon and scene.observed[now - 1].any():
            found.append((scene[:now], scene[now : now + card.horizon]))
    return found


def measured(model: DiffusionForecaster, asked: list[tuple[Scene, Scene]]) -> list[float]:
    """The figures of one sampler, over the people who stay."""
    fps, begin = model.card.fps, process_time()
    seam, real, jerk, apart, one, better, path, true_path = ([] for _ in range(8))
    for history, future in asked:
        answer = model.forecast(history, samples=2)
        rows = [history.people.index(person) for person in answer.people]
        truth, stay = future.positions[:, rows], future.observed[:, rows].all((0, 2))
        samples = answer.samples[:, :, stay]
        joined = np.concatenate([history.positions[-2:, rows], answer.samples[0, :1]])
        seam.append(np.linalg.norm(np.diff(joined, n=2, axis=0), axis=-1).ravel())
        real.append(np.linalg.norm(np.diff(truth[:, stay], n=2, axis=0), axis=-1).ravel())
        jerk.append(np.linalg.norm(np.diff(samples[0], n=3, axis=0), axis=-1).ravel() * fps**3)
        apart.append(np.linalg.norm(samples[0] - samples[1], axis=-1).mean((0, 2)))
        errors = np.linalg.norm(samples - truth[:, stay], axis=-1).mean((1, 3))
        one.append(errors[0])
        better.append(errors.min(0))
        for motion, lengths in ((samples[0], path), (truth[:, stay], true_path)):
            lengths.append(np.linalg.norm(np.diff(motion[:, :, 0, :2], axis=0), axis=-1).sum(0))
    means = [float(np.concatenate(parts).mean()) for parts in (seam, real, jerk, apart, one, better, path, true_path)]
    return [process_time() - begin, means[0] / means[1], *means[2:]]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--data", type=Path, required=True, help="folder with the open motion data")
    parser.add_argument("--model", default="sast")
    parser.add_argument("--rooms", type=int, default=10)
    options = parser.parse_args()
    model = load(options.model)
    assert isinstance(model, DiffusionForecaster)
    asked = questions(options.data, options.rooms, model)
    print(f"| {len(asked)} rooms | " + " | ".join(COLUMNS) + " |\n|---|" + "---:|" * len(COLUMNS))
    for sampler, steps in SAMPLINGS:
        figures = measured(model.sampled_by(sampler, steps), asked)
        print(f"| {sampler}, {steps} | " + " | ".join(f"{figure:.2f}" for figure in figures) + " |", flush=True)


if __name__ == "__main__":
    main()
