"""The answer of a model of goals: poses in which what people are about to do may culminate, free of any time."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from motioncast.core.card import ModelCard
from motioncast.core.scene import Scene
from motioncast.core.skeleton import Skeleton
from motioncast.core.voxels import SIDE_M, corner_of, numbered, turned
from motioncast.errors import SceneError


@dataclass(frozen=True, slots=True, eq=False)
class GoalPoses:
    """Poses that each person may be heading for; world and skeleton are those of the question.

    A pose says how the body is held, not where: its hip is above the place where it was last seen.

    Attributes:
        poses: Positions in metres, ``(goals, people, joints, 3)``, float32; for each person the most likely first.
        history: The scene that was asked about, up to the last observed frame.
        people: Ids of the people who are answered for: those seen in the last frame of the history.
        card: The card of the model that answers.
        weights: Probability of each goal, ``(goals, people)``; each person's sum to 1.
        heat: Where a hand may come to be: ``right_wrist`` and ``left_wrist`` -> ``(people, cells, cells, cells)``, the
            probability of each voxel of a cube; each person's sum to 1.
        heat_origin: The middles of the cubes, the hips, ``(people, 3)`` metres.
        heat_across: The horizontal directions of the cubes' x axes, ``(people, 2)``; z is up.
        heat_side_m: Their edge.
        carried: ``(joints,)`` bool: joints that the model does not know and that were carried along rigidly.
        guessed: ``(people,)`` bool: people seen too briefly, whose last pose stands in.
        seed: Seed of the samples.
        warnings: What the user should know, one sentence each.
    """

    poses: np.ndarray
    history: Scene
    people: tuple[str, ...]
    card: ModelCard
    weights: np.ndarray
    heat: Mapping[str, np.ndarray]
    heat_origin: np.ndarray
    heat_across: np.ndarray
    carried: np.ndarray
    guessed: np.ndarray
    heat_side_m: float = SIDE_M
    seed: int = 0
    warnings: tuple[str, ...] = field(default=())

    def __post_init__(self) -> None:
        poses = np.asarray(self.poses, np.float32)
        joints, people = len(self.history.skeleton), len(self.people)
        if poses.ndim != 4 or not len(poses) or poses.shape[1:] != (people, joints, 3):
            raise SceneError(
                f"the goal poses have shape {poses.shape}; expected (goals, {people} people, {joints} joints, 3)"
            )
        if not np.isfinite(poses).all():
            raise SceneError(f'model "{self.card.name}" answered with numbers that are not finite')
        for person in self.people:
            if person not in self.history.people:
                raise SceneError(f'a goal is of "{person}"; the history has {", ".join(self.history.people)}')
        for name, given, wanted in (
            ("weights", self.weights, (len(poses), people)),
            ("origins of the heat", self.heat_origin, (people, 3)),
            ("directions of the heat", self.heat_across, (people, 2)),
            ("carried joints", self.carried, (joints,)),
            ("guessed people", self.guessed, (people,)),
            *((f"heat of {hand}", heat[..., 0, 0, 0], (people,)) for hand, heat in self.heat.items()),
        ):
            if np.shape(given) != wanted:
                raise SceneError(f"the {name} of the goal poses have shape {np.shape(given)}; expected {wanted}")
        object.__setattr__(self, "poses", poses)

    @property
    def skeleton(self) -> Skeleton:
        """The skeleton: that of the history."""
        return self.history.skeleton

    @property
    def best(self) -> np.ndarray:
        """Each person's most likely goal, ``(people, joints, 3)``."""
        return self.poses[0]

    def scene(self, goal: int = 0) -> Scene:
        """One goal of everybody as a scene of one frame; things stand where they were last seen."""
        return Scene(
            self.poses[[goal]],
            self.skeleton,
            self.history.fps,
            people=self.people,
            source=f"goal {goal + 1} by {self.card.name}",
            objects=tuple(thing.at(-1) for thing in self.history.objects),
            floor_m=self.history.floor_m,
        )

    def heat_points(self, hand: str, least: float = 0.0) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """The voxels of a hand's heat as points of the world.

        Args:
            hand: ``right_wrist`` or ``left_wrist``.
            least: Voxels with a smaller probability are left out.

        Returns:
            Person of each point ``(points,)``, middles of voxels ``(points, 3)`` metres, probabilities ``(points,)``.
        """
        heat = self.heat[hand]
        cells = heat.shape[-1]
        middles = corner_of(numbered(cells) + 0.5, cells)
        person, voxel = np.nonzero(heat.reshape(len(heat), -1) >= max(least, 1e-9))
        place = turned(middles[voxel], self.heat_across[person]) + self.heat_origin[person]
        return person, place, heat.reshape(len(heat), -1)[person, voxel]
