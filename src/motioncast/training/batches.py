"""Training scenes, drawn without end: random starts, speeds, mirrors and sizes, people composed into one world."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from motioncast.core.scene import Scene
from motioncast.core.skeletons import SKELETONS
from motioncast.datasets.mixer import arrange, entries, turned
from motioncast.training.recipe import Recipe

STORED_FPS = 60.0
"""Takes are kept at this rate, so that a stretched clock reads real samples."""


@dataclass(frozen=True, slots=True, eq=False)
class Batch:
    """Scenes of one size.

    Attributes:
        positions: ``(scenes, time, people, joints, 3)`` float32: history and future.
        observed: ``(scenes, time, people, joints)`` bool; in the history also what is hidden on purpose.
        seen: The history as the model sees it: with noise.
    """

    positions: np.ndarray
    observed: np.ndarray
    seen: np.ndarray


class Sampler:
    """Draws batches from takes.

    Args:
        singles: Takes of one person at ``STORED_FPS``.
        couples: Takes of two people who belong together.
        recipe: Shares and ranges of every augmentation.
        history: Frames of history.
        horizon: Frames of future.
        fps: Frame rate of the model.
    """

    def __init__(
        self, singles: list[Scene], couples: list[Scene], recipe: Recipe, history: int, horizon: int, fps: float
    ) -> None:
        self.recipe, self.history, self.length = recipe, history, history + horizon
        self.step = STORED_FPS / fps
        self.groups = {1: _usable(singles, self.shortest), 2: _usable(couples, self.shortest)}
        # long takes count by the square root of their length: 29 equal walks must not outweigh one dance
        self.odds = {size: _shares([len(p) - self.shortest for p, _ in takes]) for size, takes in self.groups.items()}
        self.mirror = list(SKELETONS[recipe.sizes.get("skeleton", "mrt15")].mirror())

    @property
    def shortest(self) -> int:
        """Fewest stored frames that give a window at the lowest speed."""
        return int(np.ceil((self.length - 1) * self.step * self.recipe.speed[0])) + 2

    def batches(self, random: np.random.Generator) -> Iterator[Batch]:
        """Batches without end; of a recipe with a fixed number of scenes the same ones in random order."""
        once = np.random.default_rng(self.recipe.seed)
        fixed = [self.batch(once) for _ in range(self.recipe.scenes // self.recipe.batch)]
        while True:
            yield fixed[random.integers(len(fixed))] if fixed else self.batch(random)

    def batch(self, random: np.random.Generator) -> Batch:
        """A batch of new scenes."""
        people = int(random.choice(self.recipe.people))
        scenes = [self.scene(people, random) for _ in range(self.recipe.batch)]
        positions = np.stack([scene for scene, _ in scenes]).astype(np.float32)
        observed = np.stack([mask for _, mask in scenes])
        return self.worsened(positions, observed, random)

    def scene(self, people: int, random: np.random.Generator) -> tuple[np.ndarray, np.ndarray]:
        """One scene of so many people, and its mask."""
        recipe = self.recipe
        while True:
            couple = people >= 2 and random.random() < recipe.couple_share
            sizes = [2] * couple + [1] * (people - 2 * couple)
            drawn = [self.window(size, random) for size in sizes]
            if len(drawn) == 1:
                positions = drawn[0][0]
            else:
                arrangement = arrange([group for group, _ in drawn], self.history - 1, random)
                if arrangement is None:
                    continue
                positions = arrangement.positions
            observed = np.concatenate([mask for _, mask in drawn], 1)
            if recipe.yaw:
                positions = turned(positions, random.uniform(0, 2 * np.pi))
            order = random.permutation(people)
            return positions[:, order], observed[:, order]

    def window(self, size: int, random: np.random.Generator) -> tuple[np.ndarray, np.ndarray]:
        """One window of one person or the couple: ``(time, size, joints, 3)`` and its mask."""
        recipe = self.recipe
        while True:
            positions, observed = self.groups[size][random.choice(len(self.odds[size]), p=self.odds[size])]
            fastest = min(recipe.speed[1], (len(positions) - 2) / ((self.length - 1) * self.step))
            speed = np.exp(random.uniform(np.log(recipe.speed[0]), np.log(max(fastest, recipe.speed[0]))))
            stride = self.step * speed
            start = random.uniform(0, len(positions) - 1 - (self.length - 1) * stride)
            times = start + np.arange(self.length) * stride
            before = times.astype(int)
            share = (times - before).astype(np.float32)[:, None, None, None]
            after = np.minimum(before + 1, len(positions) - 1)
            window = positions[before] * (1 - share) + positions[after] * share
            mask = observed[before] & observed[after]
            if random.random() < recipe.reverse:
                window, mask = window[::-1], mask[::-1]
            if random.random() < recipe.mirror:
                window, mask = window[:, :, self.mirror] * np.array([-1, 1, 1], np.float32), mask[:, :, self.mirror]
            if mask[self.history - 1].all():
                return window * np.float32(random.uniform(*recipe.scale)), mask

    def worsened(self, positions: np.ndarray, observed: np.ndarray, random: np.random.Generator) -> Batch:
        """The batch as a tracker would see it: noise, joints not seen, people who enter late or are not there."""
        recipe, h = self.recipe, self.history
        seen = positions[:, :h] + random.normal(0, recipe.noise_m, positions[:, :h].shape).astype(np.float32)
        observed = observed.copy()
        observed[:, :h] &= random.random(observed[:, :h].shape) >= recipe.drop
        people = (len(positions), positions.shape[2])
        entry = entries(people, h, recipe.late, random)
        observed[:, :h] &= np.arange(h)[:, None, None] >= entry[:, None, :, None]
        absent = random.random(people) < recipe.hide
        absent[:, 0] = False
        observed &= ~absent[:, None, :, None]
        return Batch(positions, observed, seen)


def _usable(scenes: list[Scene], shortest: int) -> list[tuple[np.ndarray, np.ndarray]]:
    return [(scene.positions, scene.observed) for scene in scenes if scene.frames > shortest]


def _shares(lengths: list[int]) -> np.ndarray:
    roots = np.sqrt(np.array(lengths, float))
    return roots / roots.sum()
