"""A model of steps: what people do next and in which pose, asked again after each of its own answers.

Diller, Funkhouser, Dai, "FutureHuman3D" (CVPR 2024), Sec. 3.3: an answer is projected into the image, appended to the
past, and the graph is asked again. All samples of a question pass the graph together.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np
import onnxruntime

from motioncast.core.action_sequence import ActionSequence
from motioncast.core.action_steps import ActionSteps
from motioncast.core.card import ModelCard
from motioncast.core.forecaster import Progress
from motioncast.core.upper_body import NECK
from motioncast.datasets.action_windows import window_of
from motioncast.errors import InputError, SceneError
from motioncast.inference.shipped import opened

INPUTS = ("pixels", "seen", "actions", "objects", "camera", "depth", "noise")
"""What a graph is told, in the order of ``datasets.action_windows.ActionWindows.past``; noise comes last."""

MOST_STEPS = 100
"""Steps that a forecast may be asked for."""


@dataclass(slots=True)
class ActionForecaster:
    """A trained model of steps.

    Attributes:
        card: The model's card; its ``needs`` name the labels and objects that it knows.
        weights: The ONNX file.
        threads: Threads of one pass.
    """

    card: ModelCard
    weights: Path
    threads: int = 1
    _opened: list[onnxruntime.InferenceSession] = field(default_factory=list, repr=False)

    def forecast(
        self,
        sequence: ActionSequence,
        *,
        steps: int | None = None,
        samples: int = 1,
        seed: int = 0,
        progress: Progress | None = None,
    ) -> ActionSteps:
        """The next steps after the last one of a sequence.

        The first sample is the usual answer: no noise, and the most likely action at each step. The others have noise
        and an action drawn by its probability. A sample weighs as much as its actions are likely.

        Args:
            sequence: What was seen so far.
            steps: How many steps to look ahead. Default: as many as the model was trained for.
            samples: Number of different futures.
            seed: Seed of the samples.
            progress: Told how much is done.

        Raises:
            InputError: If an action or an object has a name that the model does not know, or none is told.
            SceneError: If there are more or fewer people than the model takes, or somebody is never seen.
        """
        steps = self.card.horizon if steps is None else steps
        self._refuse(sequence, steps, samples)
        known = self._in_own_words(sequence)
        window = window_of(known, self.card.history)
        past = [np.repeat(part, samples, 0) for part in window.past(self.card.history)]
        past[0][:, -1, :, NECK] = _last_necks(known.pixels)
        quiet = np.arange(samples) == 0
        done, chance, poses, places = self.roll(past, steps, quiet, np.random.default_rng(seed), progress)
        camera, depth = sequence.camera, window.depth[0]
        necks = camera.unproject(_last_necks(known.pixels), depth)
        return ActionSteps(
            labels=self.labels,
            actions=done,
            probabilities=chance,
            poses=camera.to_world(poses.astype(np.float64) + necks[:, None]).astype(np.float32),
            pixels=places,
            camera=camera,
            past_actions=known.actions,
            past_pixels=sequence.pixels,
            card=self.card,
            people=self.people,
            weights=_weights(chance, done),
            seed=seed,
            warnings=self._warnings(known),
        )

    def roll(
        self,
        past: Sequence[np.ndarray],
        steps: int,
        quiet: np.ndarray,
        random: np.random.Generator,
        progress: Progress | None = None,
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
        """Many pasts, continued side by side.

        Args:
            past: As ``datasets.action_windows.ActionWindows.past`` gives it.
            steps: How many steps to look ahead.
            quiet: Which rows have no noise and take the most likely action, ``(rows,)`` bool.
            random: Source of chance.
            progress: Told how much is done.

        Returns:
            Actions ``(rows, steps, people)``, their probabilities with labels last, poses ``(rows, steps, people, 9,
            3)`` along the camera's axes from the neck, and in the image ``(rows, steps, people, 9, 2)``.
        """
        pixels, seen, actions, *still = past
        found: list[list[np.ndarray]] = []
        for step in range(steps):
            noise = random.standard_normal((len(actions), self.card.people, self.card.needs["noise"]), np.float32)
            noise[quiet] = 0
            logits, poses, places = self.run(pixels, seen, actions, *still, noise)
            # the largest of logits with Gumbel noise is a draw by probability
            gumbel = random.gumbel(size=logits.shape)
            done = (logits + np.where(quiet[:, None, None], 0, gumbel)).argmax(-1)
            found.append([done, softmax(logits), poses, places])
            pixels = np.concatenate([pixels[:, 1:], places[:, None]], 1)
            seen = np.concatenate([seen[:, 1:], np.ones_like(seen[:, :1])], 1)
            actions = np.concatenate([actions[:, 1:], done[:, None]], 1)
            if progress is not None:
                progress((step + 1) / steps)
        done, chance, poses, places = (np.stack(part, 1) for part in zip(*found, strict=True))
        return done, chance, poses, places

    def run(self, *past: np.ndarray) -> Sequence[Any]:
        """One step by the graph: logits, poses along the camera's axes from the neck, and the poses in the image."""
        if not self._opened:
            self._opened = opened([self.weights], self.card.checksum, self.threads)
        (session,) = self._opened
        told = dict(zip(INPUTS, past, strict=True))
        # a graph lacks what its model does not read
        return session.run(None, {entry.name: told[entry.name] for entry in session.get_inputs()})

    def with_threads(self, threads: int) -> ActionForecaster:
        """The same model, computing with so many threads."""
        return replace(self, threads=threads, _opened=[])

    @property
    def labels(self) -> tuple[str, ...]:
        """The actions that the model knows."""
        return tuple(self.card.needs["labels"])

    @property
    def people(self) -> tuple[str, ...]:
        """Ids of the people that it answers for."""
        return tuple(f"person {number + 1}" for number in range(self.card.people))

    def _refuse(self, sequence: ActionSequence, steps: int, samples: int) -> None:
        name, wanted = self.card.name, self.card.people
        if sequence.actions.shape[1] != wanted:
            raise SceneError(
                f'{sequence.name} shows {sequence.actions.shape[1]} people; "{name}" looks at {wanted}; choose whom'
            )
        if not 1 <= steps <= MOST_STEPS or samples < 1:
            raise InputError(
                f"{steps} steps in {samples} samples were asked for; expected 1 to {MOST_STEPS} steps, and a sample"
            )
        if self.card.needs["objects"] and not sequence.objects.any():
            raise InputError(
                f'"{name}" must be told which objects are there and none is named; name some of '
                f"{', '.join(self.card.needs['objects'])}"
            )

    def _in_own_words(self, sequence: ActionSequence) -> ActionSequence:
        """The sequence with the model's labels and objects."""
        used = _numbers("action", sequence.labels, np.unique(sequence.actions), self.labels, self.card.name)
        things = tuple(self.card.needs["objects"])
        objects = np.zeros(len(things), bool)
        if things:
            named = np.flatnonzero(sequence.objects)
            objects[list(_numbers("object", sequence.things, named, things, self.card.name).values())] = True
        actions = np.vectorize(used.__getitem__, otypes=[np.int64])(sequence.actions)
        return replace(sequence, labels=self.labels, actions=actions, things=things, objects=objects)

    def _warnings(self, known: ActionSequence) -> tuple[str, ...]:
        if len(known) >= self.card.history:
            return ()
        return (f'"{self.card.name}" reads {self.card.history} past steps and was told {len(known)}',)


def _numbers(what: str, names: Sequence[str], used: np.ndarray, known: Sequence[str], model: str) -> dict[int, int]:
    """For each number that is used, that of the same name in the model's list."""
    lacking = [names[number] for number in used if names[number] not in known]
    if lacking:
        raise InputError(
            f'"{model}" knows no {what} "{lacking[0]}"; it knows {", ".join(known)}; rename it, or train another model'
        )
    return {int(number): known.index(names[number]) for number in used}


def _last_necks(pixels: np.ndarray) -> np.ndarray:
    """Where each neck was last seen, ``(people, 2)`` of ``(steps, people, 9, 2)``."""
    necks = pixels[..., NECK, :]
    last = len(necks) - 1 - np.isfinite(necks[::-1, :, 0]).argmax(0)
    return necks[last, np.arange(necks.shape[1])]


def _weights(chance: np.ndarray, done: np.ndarray) -> np.ndarray:
    """The probability of each sample's actions, over the sum of all samples."""
    said = np.take_along_axis(chance.astype(np.float64), done[..., None], -1)
    logs = np.log(np.maximum(said, 1e-12)).reshape(len(done), -1).sum(1)
    return softmax(logs)


def softmax(logits: np.ndarray) -> np.ndarray:
    """Probabilities along the last axis.

    Example:
        >>> softmax(np.array([0.0, 0.0])).tolist()
        [0.5, 0.5]
    """
    raised = np.exp(logits - logits.max(-1, keepdims=True))
    return raised / raised.sum(-1, keepdims=True)
