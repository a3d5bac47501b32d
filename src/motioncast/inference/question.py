"""What a model is asked about a scene, on the model's joints and at its rate, and its answer brought back.

Every trained model goes this way: who is seen at last is asked about, on the joints and at the rate that the model
knows; where the model's horizon ends its own answer is its next history; who was seen too briefly is answered by a
simple guess.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from motioncast.core.card import ModelCard
from motioncast.core.forecast import Forecast
from motioncast.core.resample import bridge
from motioncast.core.scene import Scene
from motioncast.errors import SceneError
from motioncast.inference.baselines import frames_ahead, guess, present, root_velocity_damped
from motioncast.inference.lift import (
    Lift,
    between_frames,
    between_sightings,
    keep_lengths,
    last_pose,
    lower,
    needed_frames,
    reach,
    rigid_bones,
)

FEWEST_FRAMES = 6
"""Who is seen in fewer frames of the history is answered by a simple guess; 0.4 s at 15 a second."""

FARTHEST_M = 10_000.0
"""Coordinates beyond this are a mistake, or geographic: metres from far away lose their millimetres in float32."""

Pass = Callable[[np.ndarray, np.ndarray], np.ndarray]
"""A model's answer: history ``(history, people, joints, 3)`` and what of it may be believed ``(history, people,
joints)`` -> future ``(horizon, people, joints, 3)``."""


@dataclass(frozen=True, slots=True, eq=False)
class Question:
    """A scene as a model is asked about it.

    Attributes:
        card: The model's card.
        scene: The scene.
        asked: The people of its last frame, in the frames that matter.
        frames: Frames wanted, at the scene's rate.
        positions: Their history on the model's joints and at its rate, without gaps, ``(history, people, joints, 3)``.
        observed: What of it the model may believe, ``(history, people, joints)``; nothing of who was seen too briefly.
        brief: Who that is, ``(people,)``.
        lift: From the model's joints to the scene's.
    """

    card: ModelCard
    scene: Scene
    asked: Scene
    frames: int
    positions: np.ndarray
    observed: np.ndarray
    brief: np.ndarray
    lift: Lift

    @classmethod
    def of(cls, card: ModelCard, scene: Scene, horizon_s: float | None) -> Question:
        """The question that a scene with a history of any length puts to a model.

        Raises:
            SceneError: If nobody is seen at last, too many are, or numbers are absurd.
            SkeletonError: If the skeleton lacks a joint that the model needs.
            InputError: If the horizon is not a positive number of seconds.
        """
        recent = scene[-needed_frames(card.history, card.fps, scene.fps) :]
        asked = recent.select(present(scene))
        if len(asked.people) > card.people:
            raise SceneError(
                f'{len(asked.people)} people are seen in the last frame; model "{card.name}" takes at most '
                f"{card.people}, so forecast them in groups (scene.select)"
            )
        farthest = float(np.abs(asked.positions).max())
        if farthest > FARTHEST_M:
            raise SceneError(f"a joint is {farthest:.0f} m from the origin; expected metres within {FARTHEST_M:g} m")
        frames = frames_ahead(card, scene, horizon_s)
        past = lower(asked, card.joints, card.fps, card.history)
        brief = (past.observed.any(2).sum(0) < FEWEST_FRAMES) | ~past.observed[-1].any(-1)
        return cls(
            card, scene, asked, frames, bridge(past.positions, past.observed),
            between_sightings(past.observed) & ~brief[:, None], brief, Lift.between(card.joints, scene.skeleton),
        )  # fmt: skip

    @property
    def ratio(self) -> float:
        """Frames of the model for one of the scene."""
        return self.card.fps / self.scene.fps

    @property
    def model_frames(self) -> int:
        """Frames wanted at the model's rate."""
        return int(np.ceil((self.frames - 0.5) * self.ratio))  # half a frame more is not worth another pass

    @property
    def passes(self) -> int:
        """How often the model is asked, each time about its whole horizon."""
        return -(-self.model_frames // self.card.horizon)

    @property
    def held(self) -> np.ndarray:
        """The last poses, held, ``(model frames, people, model joints, 3)``."""
        return np.repeat(self.positions[-1:], self.model_frames, 0)

    def rolled(self, model: Pass) -> np.ndarray:
        """The model's answer, at least as long as wanted; its own answer becomes its history where it ends."""
        history, observed = self.positions, self.observed
        answers = [model(history, observed)]
        for _ in range(1, self.passes):
            history = np.concatenate([history, answers[-1]])[-self.card.history :]
            observed = np.broadcast_to(observed[-1:].any(-1, keepdims=True), history.shape[:-1])
            answers.append(model(history, observed))
        return np.concatenate(answers)

    def forecast(self, futures: Sequence[np.ndarray], rigid: bool, seed: int, warnings: Sequence[str]) -> Forecast:
        """The forecast of a model's answers, one a sample.

        Args:
            futures: Each ``(time, people, model joints, 3)``, at least as long as asked for.
            rigid: Whether bones that keep their length in the history keep it in the forecast.
            seed: Seed of the samples.
            warnings: What else the user should know.
        """
        samples = [self.lifted(future, rigid) for future in futures]
        return Forecast(
            np.stack(samples).astype(np.float32, "C"), self.scene, self.asked.people, self.card,
            radius_m=error_radius(self.card, self.lift, self.scene, self.frames), carried=self.lift.carried,
            guessed=self.brief, seed=seed, warnings=(*warnings, *self.warnings()),
        )  # fmt: skip

    def lifted(self, future: np.ndarray, rigid: bool) -> np.ndarray:
        """An answer on the joints and at the rate of the question, ``(frames, people, joints, 3)``."""
        whole = np.concatenate([self.positions[-reach(self.ratio) - 1 :], future])
        lifted = between_frames(self.lift(whole, last_pose(self.asked)), reach(self.ratio), self.ratio, self.frames)
        if rigid:
            lifted = keep_lengths(lifted, self.scene.skeleton, rigid_bones(self.asked))
        if self.brief.any():
            lifted[:, self.brief] = guess(root_velocity_damped, self.asked, self.frames)[:, self.brief]
        return lifted

    def warnings(self) -> list[str]:
        """What the user should know about the answer."""
        card, sentences = self.card, []
        if self.passes > 1 and not self.brief.all():
            wanted_s, known_s = self.frames / self.scene.fps, card.horizon / card.fps
            sentences.append(
                f'{wanted_s:.2f} s are beyond the {known_s:.2f} s of "{card.name}"; its own forecast was taken as '
                "history for the rest" + (", and the error radius there is extrapolated" if card.radius else "")
            )
        if self.brief.any():
            names = ", ".join(person for person, short in zip(self.asked.people, self.brief, strict=True) if short)
            sentences.append(
                f"{names}: seen too briefly for the model; their last motion, fading, is carried on"
                + (", and the error radius does not hold for them" if card.radius else "")
            )
        return sentences


def refuse_short(card: ModelCard, scene: Scene) -> None:
    """Refuses a history that is shorter than what a model reads.

    Raises:
        SceneError: If it is.
    """
    shortest_s = (card.history - 1) / card.fps
    if (scene.frames - 1) / scene.fps < shortest_s - 1e-6:
        raise SceneError(
            f'{scene.frames} frames at {scene.fps:g} a second came; model "{card.name}" reads '
            f"{shortest_s:.2f} s of history, so give at least {int(np.ceil(shortest_s * scene.fps)) + 1} frames"
        )


def error_radius(card: ModelCard, lift: Lift, scene: Scene, frames: int) -> Mapping[str, np.ndarray]:
    """The card's error radii at the frames and joints of a question, ``(frames, joints)``."""
    times = np.arange(1, frames + 1) / scene.fps
    model_times = np.arange(card.horizon + 1) / card.fps
    served = np.zeros(len(scene.skeleton), int)
    served[lift.known] = lift.served
    served[lift.carried] = served[lift.carriers[lift.carried, 0]]
    radii = {}
    for level, table in card.radius.get("levels", {}).items():
        table = np.concatenate([np.zeros((1, len(card.joints))), np.asarray(table, float)])
        back = max(0, len(table) - 16)  # the growth of the last second, or of a shorter horizon
        growth = (table[-1] - table[back]) / (model_times[-1] - model_times[back])
        beyond = np.maximum(times - model_times[-1], 0)[:, None] * np.maximum(growth, 0)
        known = np.stack([np.interp(times, model_times, column) for column in table.T], 1)
        radii[level] = (known + beyond)[:, served].astype(np.float32)
    return radii
