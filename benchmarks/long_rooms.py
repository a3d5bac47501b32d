"""Do people drift apart, freeze or leave when a model is rolled on for a minute? On validation rooms only.

    python benchmarks/long_rooms.py --data DIR [--model sast] [--seconds 60] [--rooms 24]

For each five seconds: mean speed over the ground, people who do not leave a circle of 10 cm, distance to the nearest
wall, people outside the walls, change of bone lengths. Real people of the same rooms stand beside them.
"""

from __future__ import annotations

import argparse
from collections import defaultdict
from pathlib import Path

import numpy as np

from motioncast.core.scene import Scene
from motioncast.core.scene_object import SceneObject
from motioncast.core.shapes import surface_distance
from motioncast.core.skeletons import SKELETONS
from motioncast.datasets.rooms import rooms
from motioncast.inference.registry import load
from motioncast.metrics.furniture import WALL_M
from motioncast.metrics.paths import root_path
from motioncast.metrics.physical import bone_length_drift

SEED, NOW_S, PART_S = 2026, 6.0, 5.0
FROZEN_M = 0.1
COLUMNS = (
    ("m/s", "speed", 1, 2), ("real", "real speed", 1, 2), ("frozen, %", "frozen", 100, 0),
    ("real, %", "real frozen", 100, 0), ("to a wall, m", "to a wall", 1, 2), ("outside, %", "outside", 100, 1),
    ("bones, mm", "bones", 1000, 1),
)  # fmt: skip
"""Heads, figures, factors and digits."""


def paces(path: np.ndarray, fps: float) -> tuple[np.ndarray, np.ndarray]:
    """Mean speed of paths ``(time, people, 2)``, and who stays within a small circle, ``(people,)`` each."""
    speed = np.linalg.norm(np.diff(path, axis=0), axis=-1).mean(0) * fps
    return speed, np.linalg.norm(path - path.mean(0), axis=-1).max(0) < FROZEN_M


def walls_of(scene: Scene) -> list[SceneObject]:
    return [thing for thing in scene.objects if thing.category == "occluder" and thing.size[2] >= WALL_M]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--data", type=Path, required=True, help="folder with the open motion data")
    parser.add_argument("--model", default="sast")
    parser.add_argument("--seconds", type=float, default=60.0)
    parser.add_argument("--rooms", type=int, default=24)
    asked = parser.parse_args()
    model = load(asked.model)
    fps, skeleton = model.card.fps, SKELETONS[model.card.skeleton]
    hips = [skeleton.index("left_hip"), skeleton.index("right_hip")]
    now, part, parts = round(NOW_S * fps), round(PART_S * fps), int(asked.seconds / PART_S)
    found: dict[tuple[int, str], list[np.ndarray]] = defaultdict(list)
    asked_about = 0
    for room in rooms(asked.data, "validation", asked.rooms, SEED):
        scene = room.scene.on(skeleton)
        walls = walls_of(scene)
        if scene.frames <= now or not scene.observed[now - 1].any() or not walls:
            continue
        history = scene[:now]
        answer = model.forecast(history, horizon_s=asked.seconds)
        asked_about += 1
        last = history.select(answer.people).positions[-1]
        corners = np.concatenate([wall.corners[:, :2] for wall in walls])
        for number in range(parts):
            frames = slice(number * part, (number + 1) * part)
            body = answer.samples[0, frames]
            path = root_path(body, hips)
            speed, frozen = paces(path, fps)
            place = body[::5, :, hips].mean(2).reshape(-1, 3)
            outside = ((place[:, :2] < corners.min(0)) | (place[:, :2] > corners.max(0))).any(-1)
            drift = bone_length_drift(body.swapaxes(0, 1), last, skeleton.bones)
            figures = {
                "speed": speed, "frozen": frozen, "outside": outside, "bones": drift.ravel(),
                "to a wall": np.min([surface_distance(wall, place) for wall in walls], 0),
            }  # fmt: skip
            then = slice(now + frames.start, now + frames.stop)
            stay = scene.observed[then].all((0, 2))
            if scene.frames >= then.stop and stay.any():
                real = paces(root_path(scene.positions[then][:, stay], hips), fps)
                figures |= dict(zip(("real speed", "real frozen"), real, strict=True))
            for name, values in figures.items():
                found[number, name].append(values)
    print(
        f"| {asked_about} rooms, seconds | {' | '.join(head for head, *_ in COLUMNS)} |\n|---|" + "---:|" * len(COLUMNS)
    )
    for number in range(parts):
        cells = [
            f"{factor * np.concatenate(values).mean():.{digits}f}" if (values := found[number, name]) else ""
            for _, name, factor, digits in COLUMNS
        ]
        print(f"| {number * PART_S:g} to {(number + 1) * PART_S:g} | {' | '.join(cells)} |")


if __name__ == "__main__":
    main()
