"""A model that denoises: several futures of everybody in a room, by a few passes of one graph for each.

SAST (Mueller, Tanke, Gall, 2024, Sec. 3.3): each person is a diffusion of its own, in its own frame, and what the
network takes for everybody's future in one step is what each sees of the others in the next (Eq. 10). The objects of
the scene do not change from step to step; a second graph reads them once.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from itertools import count
from pathlib import Path
from typing import NamedTuple

import numpy as np

from motioncast.core.basis_points import WIDTH, codes, hip_frame
from motioncast.core.forecaster import Progress
from motioncast.core.goal_poses import GoalPoses
from motioncast.core.scene import Scene
from motioncast.core.voxels import turned_back
from motioncast.errors import InputError
from motioncast.inference.diffusion import SAMPLERS, Noise, Schedule, noise_of
from motioncast.inference.guidance import kept_clear
from motioncast.inference.question import Question
from motioncast.inference.shipped import ShippedForecaster

SEAM_FRAMES, SEAM_FADES = 3, 0.85
"""Frames over which the last velocity seen gives way to the forecast's, and what is left of the detour after each
frame; on validation rooms the velocity then changes as it does within real motion."""

PULL_S = 1.0
"""Who has a goal is drawn to it over so long before the end."""


class Lead(NamedTuple):
    """What a future is led to.

    Attributes:
        goal: The pose of each person in the frame of its hips, ``(people, joints, 3)``.
        pull: From 0, free, to 1, there; ``(horizon, people)``.
    """

    goal: np.ndarray
    pull: np.ndarray


class Seen(NamedTuple):
    """What people see around them.

    Attributes:
        memory: Objects as the graph of the scene reads them, ``(people, objects, width)``.
        objects: Which of them there are, ``(objects,)``.
        floor_m: Height of the floor.
    """

    memory: np.ndarray
    objects: np.ndarray
    floor_m: float


@dataclass(slots=True)
class DiffusionForecaster(ShippedForecaster):
    """A trained denoiser, ``NAME.onnx``, and its reader of objects, ``NAME.scene.onnx``.

    Attributes:
        sampler: Name of the sampler (``SAMPLERS``). Default: the card's.
        steps: Passes of the denoiser for a sample. Default: the card's.
        guided: Whether futures are kept out of things and of strangers.
        goals: Poses that the futures end in, one each; None leaves them free.
    """

    sampler: str = ""
    steps: int = 0
    guided: bool = True
    goals: GoalPoses | None = None

    def __post_init__(self) -> None:
        stated = self.card.diffusion
        self.sampler = self.sampler or stated["sampler"]
        self.steps = self.steps or stated["sampling_steps"]

    def sampled_by(self, sampler: str | None, steps: int | None) -> DiffusionForecaster:
        """The same model with another sampler or number of steps; None leaves what is.

        Raises:
            InputError: If there is no such sampler, or the schedule has fewer steps.
        """
        most = self.card.diffusion["steps"]
        if sampler is not None and sampler not in SAMPLERS:
            raise InputError(f'there is no sampler "{sampler}"; use one of {", ".join(SAMPLERS)}')
        if steps is not None and not 1 <= steps <= most:
            raise InputError(f'{steps} steps were asked for; "{self.card.name}" takes 1 to {most}')
        return replace(self, sampler=sampler or self.sampler, steps=steps or self.steps)

    def led_to(self, goals: GoalPoses) -> DiffusionForecaster:
        """The same model, whose n-th future of the goals' scene ends in the n-th of them."""
        return replace(self, goals=goals)

    @property
    def files(self) -> list[Path]:
        """The reader of objects, and the denoiser."""
        return [self.weights.with_suffix(".scene.onnx"), self.weights]

    def futures(self, question: Question, samples: int, seed: int, progress: Progress) -> list[np.ndarray]:
        """So many futures; who was seen too briefly is not there for the model, and stands."""
        scene, known = question.scene, np.flatnonzero(~question.brief)
        people = [question.asked.people[person] for person in known]
        shape = (self.card.horizon, len(self.card.joints), 3)
        seen_now = self.seen(scene, question.positions[-1, known])
        things, floor_m = [thing.at(-1) for thing in scene.objects], seen_now.floor_m
        done, total = count(1), samples * question.passes * self.steps

        def tick() -> None:
            progress(next(done) / total)

        def future(number: int) -> np.ndarray:
            noise, begins = noise_of(people, shape, seed, number), count(0, self.card.horizon)

            def one_pass(history: np.ndarray, observed: np.ndarray) -> np.ndarray:
                answer = np.repeat(history[-1:], self.card.horizon, 0)
                rolled_on = history is not question.positions
                seen = self.seen(scene, history[-1, known]) if rolled_on else seen_now
                there = np.any(observed[:, known], -1)
                lead = self.lead(question, known, number, next(begins))
                future = self.sampled(history[:, known], there, seen, lead, noise, tick)
                if self.guided:
                    future = kept_clear(history[:, known], future, things, self.card.joints, self.card.fps, floor_m)
                answer[:, known] = future
                return answer

            return question.rolled(one_pass)

        return [future(number) for number in range(samples)]

    def lead(self, question: Question, known: np.ndarray, number: int, begin: int) -> Lead:
        """What the people of a question are led to in a pass.

        Args:
            question: The question.
            known: Numbers of the people who are denoised.
            number: Of the sample.
            begin: Frames of the model before this pass.
        """
        joints, horizon = self.card.joints, self.card.horizon
        if self.goals is None:
            return Lead(np.zeros((len(known), len(joints), 3), np.float32), np.zeros((horizon, len(known)), np.float32))
        pose = self.goals.scene(number).on(joints).positions[0, known]
        origin, across = hip_frame(pose, joints)
        floor = np.array([0, 0, question.scene.floor_m or 0.0])
        goal = turned_back(pose - origin[:, None] - floor, across[:, None])
        missing_s = (question.model_frames - 1 - begin - np.arange(horizon)) / self.card.fps
        pull = np.clip(1 - missing_s / PULL_S, 0, 1)
        pull = pull * pull * (3 - 2 * pull)
        return Lead(goal.astype(np.float32), np.repeat(pull[:, None], len(known), 1).astype(np.float32))

    def seen(self, scene: Scene, pose: np.ndarray) -> Seen:
        """What people in a pose ``(people, joints, 3)`` see of a scene, read once for all steps."""
        floor_m = scene.floor_m or 0.0
        origin, across = hip_frame(pose, self.card.joints)
        things = codes(scene.objects, origin + np.array([0, 0, floor_m]), across)
        there = np.ones(len(scene.objects), bool)
        if not scene.objects:  # graphs do not take a set of nothing
            things, there = np.zeros((len(pose), 1, WIDTH), np.float32), np.zeros(1, bool)
        objects, _ = self.sessions()
        (memory,) = objects.run(None, {"codes": things, "objects": there})
        return Seen(np.asarray(memory), there, floor_m)

    def sampled(
        self,
        history: np.ndarray,
        observed: np.ndarray,
        seen: Seen,
        lead: Lead,
        noise: Noise,
        tick: Callable[[], None],
    ) -> np.ndarray:
        """One future of everybody, as long as the model's horizon.

        Args:
            history: ``(history, people, joints, 3)`` at the model's rate, without gaps.
            observed: Who is there, ``(history, people)``.
            seen: What they see around them.
            lead: What they are led to.
            noise: Each person's noise, ``(people, horizon, joints, 3)``.
            tick: Called after each pass.

        Returns:
            ``(horizon, people, joints, 3)``.
        """
        _, denoiser = self.sessions()
        # the model's floor is at height 0, and far from the origin float32 loses millimetres
        shift = np.array([*history[-1, ..., :2].mean((0, 1)), seen.floor_m])
        near = (history - shift).astype(np.float32)
        always = {
            "history": near, "observed": observed, "memory": seen.memory, "objects": seen.objects, **lead._asdict(),
        }  # fmt: skip
        estimate = np.repeat(near[-1:], self.card.horizon, 0)  # at first everybody is taken to stand still
        log_snr = self.schedule.log_snr.astype(np.float32)

        def denoise(noisy: np.ndarray, step: int) -> np.ndarray:
            nonlocal estimate
            now = {"noisy": noisy.astype(np.float32), "estimate": estimate, "level": log_snr[step, ...]}
            clean, estimate = map(np.asarray, denoiser.run(None, {**always, **now}))
            tick()
            return clean.astype(np.float64)

        SAMPLERS[self.sampler](self.schedule.levels(self.steps), denoise, noise)
        return eased(near, estimate) + shift  # the last estimate is the answer of every sampler

    @property
    def schedule(self) -> Schedule:
        """The schedule of the training."""
        stated = self.card.diffusion
        return Schedule.cosine(stated["steps"], stated["shift"])


def eased(history: np.ndarray, future: np.ndarray) -> np.ndarray:
    """A future that goes on with the last step seen before it goes its own way; the detour fades within a second.

    Args:
        history: ``(time, people, joints, 3)``.
        future: What follows, in the same world.

    Example:
        >>> walk = np.arange(4.0)[:, None, None, None] * np.ones((1, 1, 1, 3))
        >>> stopped = np.repeat(walk[-1:], 3, 0)
        >>> eased(walk, stopped)[:, 0, 0, 0].round(3).tolist()
        [3.75, 4.062, 4.084]
    """
    steps = np.diff(future, axis=0, prepend=history[-1:])
    frame = np.arange(len(future))[:, None, None, None]
    share = np.maximum(1 - (frame + 1) / (SEAM_FRAMES + 1), 0)
    detour = np.cumsum(share * (history[-1] - history[-2] - steps), 0)
    return future + detour * SEAM_FADES**frame
