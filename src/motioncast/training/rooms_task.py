"""Learning from composed rooms by diffusion: everybody who is there is denoised, each sees the others' estimates."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import torch
from torch import Tensor

from motioncast.core.basis_points import WIDTH, codes, hip_frame
from motioncast.core.scene_object import SceneObject
from motioncast.core.skeleton import Skeleton
from motioncast.core.skeletons import SKELETONS
from motioncast.datasets.rooms import Room, rooms
from motioncast.training.ahead import ahead
from motioncast.training.recipe import Recipe

VALIDATION_ROOMS, VALIDATION_BATCHES, VALIDATION_SEED = 24, 12, 2026

MOST_PEOPLE = 6
"""Where more are there, so many of them are drawn."""

STILL_M = 0.5
"""Windows in which nobody comes this far from where he was are half as likely: people mostly stand about."""


Kept = tuple[np.ndarray, np.ndarray, tuple[SceneObject, ...]]
"""Positions, who is there when, objects."""


@dataclass(frozen=True, slots=True, eq=False)
class RoomBatch:
    """Windows of rooms with one number of people each.

    Attributes:
        positions: ``(windows, N, people, joints, 3)`` float32, metres, world.
        present: Who is there, ``(windows, N, people)``; everybody is in the last frame of history.
        codes: What each sees of each object, ``(windows, people, objects, 2061)``.
        there: Which objects there are, ``(windows, objects)``.
        step: Step of the diffusion, ``(windows, people)``.
        noise: ``(windows, people, F, joints, 3)``.
    """

    positions: np.ndarray
    present: np.ndarray
    codes: np.ndarray
    there: np.ndarray
    step: np.ndarray
    noise: np.ndarray


class RoomsTask:
    """Windows of rooms built from the training takes.

    Args:
        recipe: What is trained; ``rooms`` of them are built by its seed, ``batch`` people are seen a step.
        model: The model that learns.
        data: Folder with CMU's takes (``datasets.cmu``).
    """

    def __init__(self, recipe: Recipe, model: Any, data: Path) -> None:
        self.recipe, self.config = recipe, model.config
        self.skeleton = SKELETONS[self.config.skeleton]
        self.mirror = list(self.skeleton.mirror())
        self.train = keep(data, "train", recipe.rooms, recipe.seed, self.skeleton)
        held_out = keep(data, "validation", VALIDATION_ROOMS, VALIDATION_SEED, self.skeleton)
        random = np.random.default_rng(VALIDATION_SEED)
        # the same windows, steps and noise at every look
        self.checks = [self.batch(held_out, recipe.batch, random, mirror=0.0) for _ in range(VALIDATION_BATCHES)]
        model.fit_statistics(torch.from_numpy(self.whole_windows(np.random.default_rng(recipe.seed))))

    def batches(self, random: np.random.Generator) -> Iterator[RoomBatch]:
        """Batches without end, the next ones prepared beside the training."""

        def endless() -> Iterator[RoomBatch]:
            while True:
                yield self.batch(self.train, self.recipe.batch, random, self.recipe.mirror)

        return ahead(endless())

    def batch(self, built: list[Kept], asked: int, random: np.random.Generator, mirror: float) -> RoomBatch:
        """Windows with about ``asked`` people in all, the same number each: that of the first one that is drawn."""
        config = self.config
        first = self.window(built, random, mirror)
        people = min(first[0].shape[1], MOST_PEOPLE)
        drawn = [first]
        while len(drawn) < max(1, asked // people):
            other = self.window(built, random, mirror)
            if other[0].shape[1] >= people:
                drawn.append(other)
        scenes = len(drawn)
        things = max(len(objects) for _, _, objects in drawn)
        positions = np.zeros((scenes, config.frames, people, len(self.skeleton), 3), np.float32)
        present = np.zeros((scenes, config.frames, people), bool)
        seen = np.zeros((scenes, people, things, WIDTH), np.float32)
        there = np.zeros((scenes, things), bool)
        for row, (whole, mask, objects) in enumerate(drawn):
            chosen = random.permutation(whole.shape[1])[:people]
            positions[row], present[row] = whole[:, chosen], mask[:, chosen]
            if config.scene:
                now = positions[row, config.history - 1]
                seen[row, :, : len(objects)] = codes(objects, *hip_frame(now, self.skeleton))
            there[row, : len(objects)] = True
        step = np.broadcast_to(random.integers(0, config.steps, (scenes, 1)), (scenes, people)).copy()
        noise = random.standard_normal((scenes, people, config.horizon, len(self.skeleton), 3), np.float32)
        return RoomBatch(positions, present, seen, there, step, noise)

    def window(self, built: list[Kept], random: np.random.Generator, mirror: float) -> Kept:
        """A window of a room, of those who are there at now."""
        return draw(built, self.config.history, self.config.frames, self.mirror, mirror, random)

    def whole_windows(self, random: np.random.Generator, count: int = 1000) -> np.ndarray:
        """Windows of people who are there from the first frame to the last, ``(n, N, joints, 3)``."""
        found = []
        while len(found) < count:
            whole, mask, _ = self.window(self.train, random, self.recipe.mirror)
            found += [whole[:, person] for person in np.flatnonzero(mask.all(0))]
        return np.stack(found)

    def loss(self, model: Any, batch: RoomBatch, place: Callable[[np.ndarray], Tensor]) -> Tensor:
        """The model's own loss of a batch, whose arrays ``place`` brings to the model's device."""
        return model.loss(*(place(array) for array in arrays(batch)))

    @torch.no_grad()
    def scores(self, model: Any) -> dict[str, float]:
        """The loss on the validation windows at little, medium and much noise."""
        device = next(model.parameters()).device
        found = {"little": [], "medium": [], "much": []}
        names = list(found)
        for batch in self.checks:
            for number, name in enumerate(names):
                third = self.config.steps // 3
                shifted = replace(batch, step=batch.step % third + number * third)
                with torch.autocast(device.type, torch.bfloat16):
                    loss = model.loss(*(torch.from_numpy(array).to(device) for array in arrays(shifted)))
                found[name].append(float(loss))
        return {name: float(np.mean(values)) for name, values in found.items()}


def keep(data: Path, split: str, count: int, seed: int, skeleton: Skeleton) -> list[Kept]:
    """What is kept of so many rooms of a split."""
    return [_kept(room, skeleton) for room in rooms(data, split, count, seed)]


def _kept(room: Room, skeleton: Skeleton) -> Kept:
    scene = room.scene.on(skeleton)
    return scene.positions, room.here, scene.objects


def draw(
    built: list[Kept], history: int, length: int, swapped: list[int], mirror: float, random: np.random.Generator
) -> Kept:
    """A window of a room, of those who are there at now.

    Args:
        built: The rooms.
        history: Frames up to now.
        length: Frames of the window.
        swapped: Joints in the order that a mirror shows them in.
        mirror: Share of windows that are mirrored.
        random: Source of chance.
    """
    while True:
        positions, present, objects = built[random.integers(len(built))]
        start = random.integers(0, len(positions) - length + 1)
        here = np.flatnonzero(present[start + history - 1])
        if not len(here):
            continue
        whole, mask = positions[start : start + length][:, here], present[start : start + length][:, here]
        root = whole[:, :, 0, :2]
        moved = np.linalg.norm(root - root[history - 1], axis=-1)[mask].max()
        if moved < STILL_M and random.random() < 0.5:
            continue
        if random.random() < mirror:
            whole = whole[:, :, swapped] * np.array([-1, 1, 1], np.float32)
            objects = tuple(mirrored(thing) for thing in objects)
        return whole, mask, objects


def arrays(batch: RoomBatch) -> tuple[np.ndarray, ...]:
    """A batch as the model's loss takes it."""
    return batch.positions, batch.present, batch.codes, batch.there, batch.step, batch.noise


def mirrored(thing: SceneObject) -> SceneObject:
    """An object that stands, as a mirror along x shows it; boxes and cylinders look alike in it."""
    return replace(
        thing, position=thing.position * np.array([-1, 1, 1]), rotation=thing.rotation * np.array([1, 1, -1, -1])
    )
