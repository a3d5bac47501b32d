"""Open benchmarks from CMU's takes: the couple (duet), single people (solo), composed scenes of three (crowd)."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from motioncast.core.scene import Scene
from motioncast.core.skeleton import Skeleton
from motioncast.datasets import cmu
from motioncast.datasets.mixer import arrange
from motioncast.datasets.windows import COMPOSED, Windows, cut, sampled
from motioncast.errors import InputError

CROWD_SCENES = 400
CROWD_SEED = 2026


def single_scenes(data: Path, split: str, fps: float, skeleton: Skeleton) -> list[Scene]:
    """The takes of single people of one split at a rate, on a skeleton."""
    takes = [take for take in cmu.takes(data, split) if take.subject not in cmu.COUPLE]
    return [sampled(scene, fps, skeleton) for scene in cmu.read(takes)]


def couple_scenes(data: Path, split: str, fps: float, skeleton: Skeleton) -> list[Scene]:
    """The couple's takes of one split at a rate, on a skeleton."""
    return [sampled(scene, fps, skeleton) for scene in cmu.couples(data, split)]


def all_but_test(data: Path, fps: float, skeleton: Skeleton) -> tuple[list[Scene], list[Scene]]:
    """Single people and couples of the training and validation takes."""
    splits = ("train", "validation")
    return (
        [scene for split in splits for scene in single_scenes(data, split, fps, skeleton)],
        [scene for split in splits for scene in couple_scenes(data, split, fps, skeleton)],
    )


def fold_of(scene: Scene, folds: int) -> int:
    """The part of the data that a take belongs to: by actor, the couple by take."""
    subject, take = (int(part) for part in scene.people[0].split("_"))
    return (take if subject in cmu.COUPLE else cmu.SAME_ACTOR.get(subject, subject)) % folds


def crowd(singles: list[Scene], couples: list[Scene], history: int, horizon: int) -> Windows:
    """Scenes of three people, seeded: in every second one two of them are the couple.

    A take is drawn by its number of windows, once a scene; windows without a gap only.

    Raises:
        InputError: If there are fewer than three takes of single people.
    """
    random = np.random.default_rng(CROWD_SEED)
    alone, together = cut(singles, history, horizon, 1), cut(couples, history, horizon, 1)
    whole = [np.flatnonzero(windows.observed.all((1, 2, 3))) for windows in (alone, together)]
    found = len({alone.takes[index] for index in whole[0]})
    if found < 3:
        raise InputError(f"{found} takes of single people have a window without a gap; scenes of three need three")
    positions, takes, starts, places = [], [], [], []
    while len(positions) < CROWD_SCENES:
        with_couple = len(positions) % 2 == 0
        drawn = [(alone, int(random.choice(whole[0]))) for _ in range(1 if with_couple else 3)]
        if with_couple:
            drawn.append((together, int(random.choice(whole[1]))))
        names = [windows.takes[index] for windows, index in drawn]
        if len(set(names)) < len(names):
            continue
        scene = arrange([windows.positions[index] for windows, index in drawn], history - 1, random)
        if scene is not None:
            positions.append(scene.positions)
            places.append(scene.places)
            takes.append(COMPOSED.join(names))
            starts.append(tuple(windows.starts[index][0] for windows, index in drawn))
    stacked = np.stack(positions)
    seen = np.ones(stacked.shape[:-1], bool)
    return Windows(stacked, seen, tuple(takes), tuple(starts), history, places=tuple(places))
