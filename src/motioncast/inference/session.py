"""A shipped graph and its card, answering for any scene."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np
import onnxruntime

from motioncast.core.card import ModelCard
from motioncast.core.forecast import Forecast
from motioncast.core.forecaster import Progress
from motioncast.core.resample import bridge
from motioncast.core.scene import Scene
from motioncast.core.skeleton import Skeleton
from motioncast.errors import InputError, SceneError
from motioncast.inference.baselines import frames_ahead, guess, one_future, present, root_velocity_damped
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
from motioncast.inference.stream import Stream

FEWEST_FRAMES = 6
"""Who is seen in fewer frames of the history is answered by a simple guess; 0.4 s at 15 a second."""

FARTHEST_M = 10_000.0
"""Coordinates beyond this are a mistake, or geographic: metres from far away lose their millimetres in float32."""


@dataclass(slots=True)
class GraphForecaster:
    """A trained graph that answers for scenes of any skeleton, rate, place and number of people.

    Attributes:
        card: The model's card.
        weights: The ONNX file.
        threads: Threads of one pass.
        rigid: Whether bones that keep their length in the history keep it in the forecast.
    """

    card: ModelCard
    weights: Path
    threads: int = 1
    rigid: bool = True
    _session: onnxruntime.InferenceSession | None = field(default=None, repr=False)

    def forecast(
        self,
        scene: Scene,
        *,
        horizon_s: float | None = None,
        samples: int = 1,
        seed: int = 0,
        progress: Progress | None = None,
    ) -> Forecast:
        """See :class:`motioncast.core.forecaster.Forecaster`.

        Raises:
            SceneError: If the history is shorter than the model's, nobody is seen at last, or numbers are absurd.
            SkeletonError: If the skeleton lacks a joint that the model needs.
        """
        shortest_s = (self.card.history - 1) / self.card.fps
        if (scene.frames - 1) / scene.fps < shortest_s - 1e-6:
            raise SceneError(
                f'{scene.frames} frames at {scene.fps:g} a second came; model "{self.card.name}" reads '
                f"{shortest_s:.2f} s of history, so give at least {int(np.ceil(shortest_s * scene.fps)) + 1} frames"
            )
        return self.answer(scene, horizon_s, samples, seed, progress)

    def answer(
        self,
        scene: Scene,
        horizon_s: float | None = None,
        samples: int = 1,
        seed: int = 0,
        progress: Progress | None = None,
    ) -> Forecast:
        """As :meth:`forecast`, for a history of any length: who was seen too briefly is answered by a simple guess."""
        card = self.card
        warnings = list(one_future(card, samples))
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
        ratio = card.fps / scene.fps
        model_frames = int(np.ceil((frames - 0.5) * ratio))  # half a frame more is not worth another pass
        past = lower(asked, card.joints, card.fps, card.history)
        brief = (past.observed.any(2).sum(0) < FEWEST_FRAMES) | ~past.observed[-1].any(-1)
        positions = bridge(past.positions, past.observed)
        lift = Lift.between(card.joints, scene.skeleton)
        lifted = np.zeros((frames, len(asked.people), len(scene.skeleton), 3))
        if not brief.all():
            if model_frames > card.horizon:
                warnings.append(
                    f'{frames / scene.fps:.2f} s are beyond the {card.horizon / card.fps:.2f} s of "{card.name}"; '
                    "its own forecast was taken as history for the rest"
                    + (", and the error radius there is extrapolated" if card.radius else "")
                )
            future = self.roll(positions, between_sightings(past.observed) & ~brief[:, None], model_frames, progress)
            whole = lift(np.concatenate([positions[-reach(ratio) - 1 :], future]), last_pose(asked))
            lifted = between_frames(whole, reach(ratio), ratio, frames)
            if self.rigid:
                lifted = keep_lengths(lifted, scene.skeleton, rigid_bones(asked))
        if brief.any():
            names = ", ".join(person for person, short in zip(asked.people, brief, strict=True) if short)
            warnings.append(
                f"{names}: seen too briefly for the model; their last motion, fading, is carried on"
                + (", and the error radius does not hold for them" if card.radius else "")
            )
            lifted[:, brief] = guess(root_velocity_damped, asked, frames)[:, brief]
        return Forecast(
            lifted[None].astype(np.float32, "C"), scene, asked.people, card, radius_m=self.radius(lift, scene, frames),
            carried=lift.carried, guessed=brief, seed=seed, warnings=tuple(warnings),
        )  # fmt: skip

    def roll(
        self, history: np.ndarray, observed: np.ndarray, frames: int, progress: Progress | None = None
    ) -> np.ndarray:
        """The graph's answer, at least ``frames`` long; its own answer becomes its history where it ends.

        Args:
            history: ``(time, people, joints, 3)`` at the model's rate, without gaps.
            observed: ``(time, people, joints)``: what of it the model may believe.
            frames: Frames needed.
            progress: Told how much is done.
        """
        answers: list[np.ndarray] = []
        done = 0
        while done < frames:
            if done:
                history = np.concatenate([history, answers[-1]])[-self.card.history :]
                observed = np.broadcast_to(observed[-1:].any(-1, keepdims=True), history.shape[:-1])
            answers.append(self.run(history[None], observed[None])[0])
            done += len(answers[-1])
            if progress is not None:
                progress(min(1.0, done / frames))
        return np.concatenate(answers)

    def run(self, history: np.ndarray, observed: np.ndarray) -> np.ndarray:
        """One pass of the graph, batch first."""
        if self._session is None:
            self._session = self._open()
        middle = _middle(history, observed)  # far from the origin float32 loses millimetres
        near = {"history": (history - middle).astype(np.float32), "observed": np.ascontiguousarray(observed)}
        return self._session.run(None, near)[0] + middle

    def radius(self, lift: Lift, scene: Scene, frames: int) -> Mapping[str, np.ndarray]:
        """The card's error radii at the frames and joints of the question, ``(frames, joints)``."""
        times = np.arange(1, frames + 1) / scene.fps
        model_times = np.arange(self.card.horizon + 1) / self.card.fps
        served = np.zeros(len(scene.skeleton), int)
        served[lift.known] = lift.served
        served[lift.carried] = served[lift.carriers[lift.carried, 0]]
        radii = {}
        for level, table in self.card.radius.get("levels", {}).items():
            table = np.concatenate([np.zeros((1, len(self.card.joints))), np.asarray(table, float)])
            back = max(0, len(table) - 16)  # the growth of the last second, or of a shorter horizon
            growth = (table[-1] - table[back]) / (model_times[-1] - model_times[back])
            beyond = np.maximum(times - model_times[-1], 0)[:, None] * np.maximum(growth, 0)
            known = np.stack([np.interp(times, model_times, column) for column in table.T], 1)
            radii[level] = (known + beyond)[:, served].astype(np.float32)
        return radii

    def stream(self, fps: float, skeleton: Skeleton | None = None, horizon_s: float | None = None) -> Stream:
        """A live forecast: push frames, read futures.

        Args:
            fps: Frames a second of the tracker.
            skeleton: Its joints. Default: the model's.
            horizon_s: How far to look ahead. Default: the model's horizon.
        """
        if self._session is None:
            self._session = self._open()  # now, so that no push waits for it
        memory = needed_frames(self.card.history, self.card.fps, fps)
        return Stream(lambda scene: self.answer(scene, horizon_s), skeleton or self.card.joints, fps, memory)

    def with_threads(self, threads: int) -> GraphForecaster:
        """The same model, computing with so many threads."""
        return replace(self, threads=threads, _session=None)

    def _open(self) -> onnxruntime.InferenceSession:
        weights = self.weights.read_bytes()
        if self.card.checksum and hashlib.sha256(weights).hexdigest() != self.card.checksum:
            raise InputError(f"{self.weights} is damaged: its checksum is not that of the card; install it again")
        options = onnxruntime.SessionOptions()
        options.intra_op_num_threads = self.threads
        options.inter_op_num_threads = 1
        options.log_severity_level = 3
        return onnxruntime.InferenceSession(weights, options, providers=["CPUExecutionProvider"])


def _middle(history: np.ndarray, observed: np.ndarray) -> np.ndarray:
    """Middle of the people in the last frame, per scene, ``(batch, 1, 1, 1, 3)``."""
    seen = observed[:, -1:, ..., None]
    total = np.where(seen, history[:, -1:], 0).sum((2, 3), keepdims=True, dtype=np.float64)
    return total / np.maximum(seen.sum((2, 3), keepdims=True), 1)
