"""Simple guesses, answered like models: what a trained model has to beat.

Defined in frames at 15 a second, the rate of the published settings; at another rate the same velocities are read
from the resampled history and the same paths are followed.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from motioncast.core.card import ModelCard
from motioncast.core.forecast import Forecast
from motioncast.core.forecaster import Progress
from motioncast.core.resample import bridge, sample
from motioncast.core.scene import Scene
from motioncast.core.skeleton import STAND_INS, Skeleton
from motioncast.core.skeletons import MRT15
from motioncast.errors import InputError, SceneError
from motioncast.inference.lift import needed_frames
from motioncast.inference.stream import Stream

FPS = 15.0
MEMORY = 15
"""Frames at 15 a second that a guess looks back: one second."""
HORIZON = 45
DAMPING = 0.95


@dataclass(frozen=True, slots=True)
class Recent:
    """The last frames of a scene at 15 a second.

    Attributes:
        positions: ``(time, people, joints, 3)``; who came later stands where first seen before that.
        steps: Number of frame intervals in which each person was there, ``(people,)``.
        scene: The scene.
    """

    positions: np.ndarray
    steps: np.ndarray
    scene: Scene

    def velocity(self, track: np.ndarray, steps: int) -> np.ndarray:
        """Mean step over the last ``steps`` intervals, or as many as a person was there, ``(people, 3)``."""
        reach = np.clip(self.steps, 1, steps)
        earlier = track[len(track) - 1 - reach, np.arange(track.shape[1])]
        return (track[-1] - earlier) / reach[:, None]

    def place(self, landmark: str) -> np.ndarray:
        """Where a place of the body was, ``(time, people, 3)``; the middle of all joints where it has no joint."""
        for places in ((landmark,), *STAND_INS.get(landmark, ())):
            joints = [joint for joint in map(self.scene.skeleton.find, places) if joint is not None]
            if len(joints) == len(places):
                return self.positions[:, :, joints].mean(2)
        return self.positions.mean(2)


def zero_velocity(recent: Recent, ahead: np.ndarray) -> np.ndarray:
    """Everybody stays as they are."""
    return np.zeros((len(ahead), *recent.positions.shape[1:]))


def constant_velocity(recent: Recent, ahead: np.ndarray) -> np.ndarray:
    """Every joint goes on as it did between the last two frames."""
    return ahead[:, None, None, None] * (recent.positions[-1] - recent.positions[-2])


def neck_velocity(recent: Recent, ahead: np.ndarray) -> np.ndarray:
    """The last pose is carried along with the neck's mean velocity over three frames."""
    return ahead[:, None, None, None] * recent.velocity(recent.place("neck"), 3)[:, None]


def root_velocity_damped(recent: Recent, ahead: np.ndarray) -> np.ndarray:
    """The last pose is carried along with the root's mean velocity over seven frames, which fades by 0.95 a frame."""
    path = (1 - DAMPING**ahead) / (1 - DAMPING)  # 1 + 0.95 + 0.95^2 + ...: the first step is undamped
    return path[:, None, None, None] * recent.velocity(recent.place("pelvis"), 7)[:, None]


def replay(recent: Recent, ahead: np.ndarray) -> np.ndarray:
    """The last second runs backwards and forwards again: every pose is real, and nobody gets anywhere."""
    span = np.clip(recent.steps, 1, MEMORY - 1)
    back = np.abs((ahead[:, None] + span) % (2 * span) - span)  # 0, 1, ..., span, ..., 1, 0, 1, ...
    times, people = MEMORY - 1 - back, np.arange(len(span))
    before = np.minimum(times.astype(int), MEMORY - 2)
    share = (times - before)[..., None, None]
    poses = recent.positions[before, people] * (1 - share) + recent.positions[before + 1, people] * share
    return poses - recent.positions[-1]


Rule = Callable[[Recent, np.ndarray], np.ndarray]

RULES: dict[str, Rule] = {
    "zero-velocity": zero_velocity,
    "constant-velocity": constant_velocity,
    "neck-velocity": neck_velocity,
    "root-velocity-damped": root_velocity_damped,
    "replay": replay,
}
"""Guesses by name. A rule gets the last frames at 15 a second and how many such frames to look ahead."""

STRETCHING = {"rigid_bones": "each joint goes its own straight way, so limbs stretch"}


@dataclass(frozen=True, slots=True)
class SimpleGuess:
    """A simple guess, answered like a model.

    Example:
        >>> from motioncast.core.skeletons import MRT15
        >>> scene = Scene(np.ones((15, 1, 15, 3), np.float32), MRT15, 15)
        >>> SimpleGuess("zero-velocity").forecast(scene, horizon_s=1).samples.shape
        (1, 15, 1, 15, 3)
    """

    name: str

    @property
    def card(self) -> ModelCard:
        """The card of the guess."""
        return ModelCard(
            self.name, "simple guess", "forecast", "any", MEMORY, HORIZON, FPS,
            source=(RULES[self.name].__doc__ or "").strip(), data="none", licence="Apache-2.0",
            exceptions=STRETCHING if self.name == "constant-velocity" else {},
        )  # fmt: skip

    def forecast(
        self,
        scene: Scene,
        *,
        horizon_s: float | None = None,
        samples: int = 1,
        seed: int = 0,
        progress: Progress | None = None,
    ) -> Forecast:
        """See :class:`motioncast.core.forecaster.Forecaster`."""
        frames = frames_ahead(self.card, scene, horizon_s)
        asked = scene.select(present(scene))
        moved = guess(RULES[self.name], asked, frames)
        warnings = one_future(self.card, samples)
        return Forecast(moved[None], scene, asked.people, self.card, seed=seed, warnings=warnings)

    def stream(self, fps: float, skeleton: Skeleton | None = None, horizon_s: float | None = None) -> Stream:
        """See :class:`motioncast.core.forecaster.LiveForecaster`; default joints: the 15 of ``MRT15``."""
        memory = needed_frames(MEMORY, FPS, fps)
        return Stream(lambda scene: self.forecast(scene, horizon_s=horizon_s), skeleton or MRT15, fps, memory)


def guess(rule: Rule, scene: Scene, frames: int) -> np.ndarray:
    """Positions of the next frames by a rule, ``(frames, people, joints, 3)``; history of any length.

    A joint that is not seen at last is carried from where it was seen last.
    """
    window = scene[-(int(MEMORY * scene.fps / FPS) + 4) :]
    positions = bridge(window.positions, window.observed)
    step = scene.fps / FPS
    times = len(positions) - 1 - step * np.arange(MEMORY - 1, -1, -1)
    first = window.observed.any(-1).argmax(0)  # frame in which each person appears
    steps = np.floor((len(positions) - 1 - first) / step + 1e-6).astype(int)
    recent = Recent(sample(positions, np.maximum(times, 0), step), steps, scene)
    ahead = np.arange(1, frames + 1) / step
    return (recent.positions[-1] + rule(recent, ahead)).astype(np.float32)


def present(scene: Scene) -> list[str]:
    """The people who are seen in the last frame.

    Raises:
        SceneError: If there is no frame or nobody is seen.
    """
    if not scene.frames:
        raise SceneError("the scene has no frame; give at least a second of motion")
    seen = scene.observed[-1].any(-1)
    if not seen.any():
        ever = np.flatnonzero(scene.observed.any((1, 2)))
        last = f"the last one with somebody is {ever[-1]} of {scene.frames}" if len(ever) else "nor in any other"
        raise SceneError(f"nobody is observed in the last frame ({last}); cut the motion where people are still seen")
    return [person for person, there in zip(scene.people, seen, strict=True) if there]


def frames_ahead(card: ModelCard, scene: Scene, horizon_s: float | None) -> int:
    """Frames of the scene's rate that a horizon spans, at least one; the card's own horizon by default.

    Raises:
        InputError: If the horizon is not a positive number of seconds.
    """
    if horizon_s is None:
        return max(1, int(card.horizon / card.fps * scene.fps + 1e-6))
    if not (np.isfinite(horizon_s) and horizon_s > 0):
        raise InputError(f"the horizon is {horizon_s} s; expected a positive number of seconds, such as 3")
    return max(1, round(horizon_s * scene.fps))


def one_future(card: ModelCard, samples: int) -> tuple[str, ...]:
    """What is said to a user who asks a model of one future for several.

    Raises:
        InputError: If fewer than one is asked for.
    """
    if samples < 1:
        raise InputError(f"{samples} samples were asked for; ask for at least 1")
    if samples == 1 or card.stochastic:
        return ()
    doubt = "; its doubt is the error radius" if card.radius else ""
    return (f'model "{card.name}" has one future, not {samples}{doubt}',)
