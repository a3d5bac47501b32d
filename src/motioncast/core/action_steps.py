"""An answer in steps: what people will do next, one action and one pose a step, without a clock."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from motioncast.core.camera import Camera
from motioncast.core.card import ModelCard
from motioncast.core.scene import Scene
from motioncast.core.skeletons import UPPER9
from motioncast.errors import SceneError


@dataclass(frozen=True, slots=True, eq=False)
class ActionSteps:
    """The next actions of people and the pose that is characteristic of each; steps have no fixed length.

    Joints are those of ``core.skeletons.UPPER9``.

    Attributes:
        labels: Every action that the model knows.
        actions: What each person does, ``(samples, steps, people)``, indices of ``labels``.
        probabilities: Of every action when that step is reached, ``(samples, steps, people, labels)``.
        poses: ``(samples, steps, people, 9, 3)`` metres, world.
        pixels: The same poses in the image, ``(samples, steps, people, 9, 2)``.
        camera: The camera of the image.
        past_actions: What was done before, ``(past, people)``.
        past_pixels: In which poses, ``(past, people, 9, 2)``; NaN where a joint was not seen.
        card: The card of the model that answers.
        people: Ids of the people.
        weights: Probability of each sample; they sum to 1.
        seed: Seed of the samples.
        warnings: What the user should know, one sentence each.

    Raises:
        SceneError: If shapes disagree or a number is not finite.
    """

    labels: tuple[str, ...]
    actions: np.ndarray
    probabilities: np.ndarray
    poses: np.ndarray
    pixels: np.ndarray
    camera: Camera
    past_actions: np.ndarray
    past_pixels: np.ndarray
    card: ModelCard
    people: tuple[str, ...]
    weights: np.ndarray
    seed: int = 0
    warnings: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        samples, steps = np.shape(self.actions)[:2]
        people, past, joints = len(self.people), len(self.past_actions), len(UPPER9)
        for name, wanted in (
            ("actions", (samples, steps, people)),
            ("probabilities", (samples, steps, people, len(self.labels))),
            ("poses", (samples, steps, people, joints, 3)),
            ("pixels", (samples, steps, people, joints, 2)),
            ("past_actions", (past, people)),
            ("past_pixels", (past, people, joints, 2)),
            ("weights", (samples,)),
        ):
            value = np.asarray(getattr(self, name))
            if value.shape != wanted:
                raise SceneError(f"the {name} of the answer have shape {value.shape}; expected {wanted}")
            if name != "past_pixels" and not np.isfinite(value).all():
                raise SceneError(f'model "{self.card.name}" answered with {name} that are not finite')

    @property
    def best(self) -> int:
        """The most probable sample."""
        return int(np.argmax(self.weights))

    def told(self, sample: int, person: int = 0) -> list[str]:
        """The actions of a sample in words."""
        return [self.labels[action] for action in self.actions[sample, :, person]]

    def scene(self, sample: int | None = None) -> Scene:
        """The poses of a sample (default: the most probable) as a scene of one frame a step, a frame a second."""
        poses = self.poses[self.best if sample is None else sample]
        return Scene(poses, UPPER9, 1.0, people=self.people, source=f"steps forecast by {self.card.name}")
