"""What a forecast of steps must be better than: rules for poses, and tables of what follows what."""

from __future__ import annotations

from collections import Counter, defaultdict
from dataclasses import dataclass

import numpy as np

from motioncast.core.upper_body import NECK, from_neck
from motioncast.datasets.action_windows import ActionWindows


@dataclass(frozen=True, slots=True, eq=False)
class Answer:
    """A forecast of windows; None where a model gives no such thing.

    Attributes:
        scores: Of each action, ``(windows, steps, people, labels)``.
        pixels: ``(windows, steps, people, 9, 2)``.
        poses: ``(windows, steps, people, 9, 3)`` metres along the camera's axes from the neck.
    """

    scores: np.ndarray | None = None
    pixels: np.ndarray | None = None
    poses: np.ndarray | None = None


def zero_velocity(windows: ActionWindows, history: int) -> Answer:
    """The last pose stays."""
    steps = windows.actions.shape[1] - history
    return Answer(pixels=np.repeat(windows.pixels[:, history - 1 : history], steps, 1))


def average(windows: ActionWindows, history: int, train: ActionWindows) -> Answer:
    """The mean pose of training, as large as the person is."""
    steps = windows.actions.shape[1] - history
    seen = train.seen[..., None]
    offsets = from_neck(train.pixels) * (train.depth / train.camera[:, :1])[:, None, :, None, None]
    mean = np.sum(offsets * seen, (0, 1)) / seen.sum((0, 1))
    necks = windows.pixels[:, history - 1, :, NECK : NECK + 1]
    held = necks + mean / (windows.depth / windows.camera[:, :1])[..., None, None]
    return Answer(pixels=np.repeat(held[:, None], steps, 1))


def repeat_last(windows: ActionWindows, history: int, labels: int) -> Answer:
    """The last action goes on; then the ones before it, the latest first."""
    steps = windows.actions.shape[1] - history
    past = windows.actions[:, :history]
    scores = np.zeros((len(windows), past.shape[2], labels))
    for age in range(history):
        row, person = np.indices(past[:, age].shape)
        scores[row, person, past[:, age]] = age + 1
    return Answer(scores=np.repeat(scores[:, None], steps, 1))


def markov(windows: ActionWindows, history: int, train: ActionWindows, labels: int, order: int) -> Answer:
    """How often an action followed the last ``order`` ones in training, one step after another.

    Order 0 is the most common action. What never occurred falls back to a shorter memory. The chain goes on with its
    own most likely action.
    """
    tables = [_followers(train, labels, memory) for memory in range(order + 1)]
    steps = windows.actions.shape[1] - history
    scores = np.zeros((*windows.actions[:, history:].shape, labels))
    for window, person in np.ndindex(len(windows), windows.actions.shape[2]):
        past = windows.actions[window, :history, person].tolist()
        for step in range(steps):
            memory = next(size for size in range(order, -1, -1) if tuple(past[len(past) - size :]) in tables[size])
            scores[window, step, person] = tables[memory][tuple(past[len(past) - memory :])]
            past.append(int(scores[window, step, person].argmax()))
    return Answer(scores=scores)


def _followers(train: ActionWindows, labels: int, memory: int) -> dict[tuple[int, ...], np.ndarray]:
    """Counts ``(labels,)`` of what followed the last ``memory`` actions."""
    counts: dict[tuple[int, ...], Counter[int]] = defaultdict(Counter)
    for actions in np.moveaxis(train.actions, 2, 1).reshape(-1, train.actions.shape[1]).tolist():
        for step in range(memory, len(actions)):
            counts[tuple(actions[step - memory : step])][actions[step]] += 1
    return {key: np.array([found[label] for label in range(labels)]) for key, found in counts.items()}
