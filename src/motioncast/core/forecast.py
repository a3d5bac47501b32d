"""The answer: what the people of a scene will do next, and how sure that is."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np

from motioncast.core import kinematics
from motioncast.core.card import ModelCard
from motioncast.core.goal_poses import GoalPoses
from motioncast.core.scene import Scene
from motioncast.core.skeleton import Skeleton
from motioncast.errors import SceneError


@dataclass(frozen=True, slots=True, eq=False)
class Forecast:
    """What the people of a scene will do next; world, rate and skeleton are those of the question.

    Frame 0 is the first frame after the last observed one.

    Attributes:
        samples: Positions in metres, ``(sample, time, people, joints, 3)``, float32.
        history: The scene that was asked about, up to the last observed frame.
        people: Ids of the people that are forecast: those seen in the last frame of the history.
        card: The card of the model that answers.
        weights: Probability of each sample; they sum to 1.
        radius_m: Level ("0.5", "0.9") -> ``(time, joints)``: radius around a forecast joint meant to hold the
            truth in that share of cases. Empty where the model states none.
        carried: ``(joints,)`` bool: joints that the model does not know and that were carried along rigidly.
        guessed: ``(people,)`` bool: people for whom a simple guess stands in, since their history is too short.
        seed: Seed of the samples.
        warnings: What the user should know, one sentence each.
        goals: Of futures that each end in a goal: those goals, in the order of the samples.
    """

    samples: np.ndarray
    history: Scene
    people: tuple[str, ...]
    card: ModelCard
    weights: np.ndarray = None  # pyright: ignore[reportAssignmentType]  # filled on construction
    radius_m: Mapping[str, np.ndarray] = field(default_factory=dict)
    carried: np.ndarray = None  # pyright: ignore[reportAssignmentType]  # filled on construction
    guessed: np.ndarray = None  # pyright: ignore[reportAssignmentType]  # filled on construction
    seed: int = 0
    warnings: tuple[str, ...] = ()
    goals: GoalPoses | None = None

    def __post_init__(self) -> None:
        samples = np.asarray(self.samples, np.float32)
        joints = len(self.history.skeleton)
        if samples.ndim != 5 or not len(samples) or samples.shape[2:] != (len(self.people), joints, 3):
            raise SceneError(
                f"the forecast has shape {samples.shape}; expected (sample, time, {len(self.people)} people, "
                f"{joints} joints, 3)"
            )
        if not np.isfinite(samples).all():
            raise SceneError(f'model "{self.card.name}" answered with numbers that are not finite')
        for person in self.people:
            if person not in self.history.people:
                raise SceneError(f'the forecast is of "{person}"; the history has {", ".join(self.history.people)}')
        count, frames = samples.shape[:2]
        weights = np.full(count, 1 / count, np.float32) if self.weights is None else np.asarray(self.weights)
        carried = np.zeros(joints, bool) if self.carried is None else self.carried
        guessed = np.zeros(len(self.people), bool) if self.guessed is None else self.guessed
        for name, given, wanted in (
            ("weights", weights, (count,)),
            ("carried joints", carried, (joints,)),
            ("guessed people", guessed, (len(self.people),)),
            *(("error radii", radius, (frames, joints)) for radius in self.radius_m.values()),
        ):
            if np.shape(given) != wanted:
                raise SceneError(f"the {name} of the forecast have shape {np.shape(given)}; expected {wanted}")
        set_field = object.__setattr__
        set_field(self, "samples", samples)
        set_field(self, "weights", weights)
        set_field(self, "carried", carried)
        set_field(self, "guessed", guessed)

    @property
    def fps(self) -> float:
        """Frames a second: those of the history."""
        return self.history.fps

    @property
    def skeleton(self) -> Skeleton:
        """The skeleton: that of the history."""
        return self.history.skeleton

    @property
    def horizon_s(self) -> float:
        """Length of the forecast in seconds."""
        return self.samples.shape[1] / self.fps

    @property
    def times_s(self) -> np.ndarray:
        """Time of each frame, in seconds after the last observed one.

        The first forecast frame is one frame interval ahead.
        """
        return np.arange(1, self.samples.shape[1] + 1) / self.fps

    @property
    def best(self) -> np.ndarray:
        """The most probable sample, ``(time, people, joints, 3)``."""
        return self.samples[int(np.argmax(self.weights))]

    def scene(self, sample: int | None = None) -> Scene:
        """One sample (default: the most probable) as a scene of its own, without the history.

        Things stand where they were last seen.
        """
        positions = self.best if sample is None else self.samples[sample]
        return Scene(
            positions,
            self.skeleton,
            self.fps,
            people=self.people,
            source=f"forecast by {self.card.name}",
            objects=tuple(thing.at(-1) for thing in self.history.objects),
            floor_m=self.history.floor_m,
        )

    def continued(self, sample: int | None = None) -> Scene:
        """History and one sample (default: the most probable) as one scene that goes on without a step.

        It holds the people who are forecast. Where the history has rotations the forecast gets them too.
        """
        past, future = self.history.select(self.people), self.scene(sample)
        frames = past.frames + future.frames
        rotations = None
        if past.rotations is not None:
            future = kinematics.fit_rotations(future, past)
            assert future.rotations is not None
            rotations = np.concatenate([past.rotations, future.rotations])
        return replace(
            past,
            positions=np.concatenate([past.positions, future.positions]),
            observed=np.concatenate([past.observed, future.observed]),
            rotations=rotations,
            source=f"{past.source}, continued by {self.card.name}",
            objects=tuple(thing[np.minimum(np.arange(frames), past.frames - 1)] for thing in past.objects),
        )
