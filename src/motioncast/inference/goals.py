"""A model of goals: the poses in which what people are about to do may culminate.

Diller, Funkhouser, Dai, "Forecasting Characteristic 3D Poses of Human Actions" (CVPR 2022), Sec. 3.5: the right hand is
sampled from its heatmap, the left hand given the right one, all other joints given both; then each pose is made whole
(``refine``). Ten poses take three passes of the graph, with 1, 5 and 10 hypotheses.
"""

from __future__ import annotations

import hashlib
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Literal, NamedTuple

import numpy as np
import onnxruntime

from motioncast.core.card import ModelCard
from motioncast.core.forecaster import Progress
from motioncast.core.goal_poses import GoalPoses
from motioncast.core.scene import Scene
from motioncast.core.voxels import across, corner_of, hip_centred, turned
from motioncast.errors import InputError
from motioncast.inference.lift import keep_lengths, last_pose, rigid_bones
from motioncast.inference.question import Question, refuse_short
from motioncast.inference.refine import PoseEnergy, lowered
from motioncast.inference.shipped import opened

HANDS = ("right_wrist", "left_wrist")
"""In the order in which they are sampled."""

TEMPERATURE = 0.025
"""Of the softmax that makes probabilities of heat (Sec. 3.4.1)."""

LEFT_EACH = 2
"""Left hands for each right hand."""

ANGLES, CLOSENESS = 0.02, 0.0
"""Weights of angles and closeness in Eq. 3.2, where the text has 0.4 and 0.1: those draw hands back by decimetres from
where they were sampled, towards the last pose."""

BLUR = 2
"""Voxels on either side over which the heat of the other joints is averaged before they are drawn (the release's)."""


class Said(NamedTuple):
    """What the graph says of the asked joints of each hypothesis.

    Attributes:
        heat: From 0 to 1, ``(people, hypotheses, asked, cells, cells, cells)``.
        level: The likeliest of ten levels, the same shape.
        offsets: ``(people, hypotheses, asked, 3, voxels)`` metres.
    """

    heat: np.ndarray
    level: np.ndarray
    offsets: np.ndarray

    @property
    def probability(self) -> np.ndarray:
        """Of each voxel, ``(people, hypotheses, asked, voxels)``."""
        return softmax(self.heat.reshape(*self.heat.shape[:3], -1) / TEMPERATURE)

    def at(self, voxel: np.ndarray) -> np.ndarray:
        """Where joints are in these voxels ``(people, hypotheses, asked, n)``, ``(..., n, 3)`` metres, hip-centred."""
        cells = self.heat.shape[-1]
        corner = corner_of(np.stack(np.unravel_index(voxel, (cells,) * 3), -1), cells)
        offset = np.take_along_axis(self.offsets, voxel[..., None, :], -1)
        return corner + offset.swapaxes(-1, -2)


@dataclass(slots=True)
class GoalForecaster:
    """A trained model of goals, for scenes of any skeleton, rate, place and number of people.

    Attributes:
        card: The model's card.
        weights: The ONNX file.
        threads: Threads of one pass.
        sampling: How hands are chosen: evenly among all voxels of the highest level (``plateau``), or by chance
            (``temperature``).
        refine: Whether poses are made whole by Eq. 3.2.
        rigid: Whether bones that keep their length in the history keep it in the goals.
    """

    card: ModelCard
    weights: Path
    threads: int = 1
    sampling: Literal["plateau", "temperature"] = "plateau"
    refine: bool = True
    rigid: bool = True
    _opened: list[onnxruntime.InferenceSession] = field(default_factory=list, repr=False)

    def forecast(
        self, scene: Scene, *, samples: int = 10, seed: int = 0, progress: Progress | None = None
    ) -> GoalPoses:
        """The poses that the people who are seen in the last frame of a scene may be heading for.

        Args:
            scene: The motion so far; its last frame is now.
            samples: Number of poses.
            seed: Seed of what is drawn by chance.
            progress: Told how much is done.

        Raises:
            InputError: If fewer than one is asked for.
            SceneError: If the history is shorter than the model's, nobody is seen at last, or numbers are absurd.
            SkeletonError: If the skeleton lacks a joint that the model needs.
        """
        if samples < 1:
            raise InputError(f"{samples} samples were asked for; ask for at least 1")
        refuse_short(self.card, scene)
        question = Question.of(self.card, scene, None)
        history = question.positions.swapaxes(0, 1)  # person by person
        axis, hip = across(history[:, -1], self.card.joints), history[:, -1, 0]
        own = hip_centred(history, axis)
        goals = self.goals(own, question.asked.people, samples, seed, progress or (lambda share: None))
        poses = grounded(goals.poses, own[:, -1])
        world = turned(poses, axis[:, None, None]) + hip[:, None, None]
        world[question.brief] = history[question.brief, -1][:, None]
        lifted = question.lift(world.swapaxes(0, 1), last_pose(question.asked))
        if self.rigid:
            lifted = keep_lengths(lifted, scene.skeleton, rigid_bones(question.asked))
        origin = hip + np.array([0, 0, 1]) * poses[:, 0, 0]
        return GoalPoses(
            lifted.astype(np.float32, "C"), scene, question.asked.people, self.card, goals.weights.T, goals.heat,
            origin, axis, question.lift.carried, question.brief, seed=seed, warnings=_warnings(question),
        )  # fmt: skip

    def goals(
        self, history: np.ndarray, people: tuple[str, ...], samples: int, seed: int, progress: Progress
    ) -> _Goals:
        """So many goals of each person, hip-centred, the likeliest first.

        Args:
            history: ``(people, time, joints, 3)`` metres, hip-centred.
            people: Their ids; each has chances of its own.
            samples: Number of poses.
            seed: Seed of what is drawn by chance.
            progress: Told how much is done.
        """
        hands = [self.card.joints.landmarks.index(hand) for hand in HANDS]
        rest = [joint for joint in range(len(self.card.joints)) if joint not in hands]
        chances = [chance_of(person, seed) for person in people]
        rights, lefts = -(-samples // LEFT_EACH), min(LEFT_EACH, samples)
        right_of, left_of = np.arange(samples) // LEFT_EACH, np.arange(samples) % LEFT_EACH

        known = np.zeros((len(people), 1, 2, 3))
        right = self.ask(history, known, 0, hands[:1])
        right_voxel = self.chosen(right, rights, chances)[:, 0]  # people, rights
        known = np.repeat(known, rights, 1)
        known[:, :, 0] = right.at(right_voxel[:, None, None])[:, 0, 0]
        progress(0.1)
        left = self.ask(history, known, 1, hands[1:])
        left_voxel = self.chosen(left, lefts, chances)  # people, rights, lefts
        known = known[:, right_of]
        known[:, :, 1] = left.at(left_voxel[:, :, None])[:, right_of, 0, left_of].reshape(len(people), samples, 3)
        progress(0.4)
        others = self.ask(history, known, 2, rest)
        rest_voxel = drawn(softmax(blurred(others.heat) / TEMPERATURE), chances)
        progress(0.8)

        poses = np.empty((len(people), samples, len(self.card.joints), 3))
        poses[:, :, hands], poses[:, :, rest] = known, others.at(rest_voxel[..., None])[..., 0, :]
        poses[:, :, 0] = 0  # the hip is the middle by definition
        right_chance, left_chance = right.probability[:, 0, 0], left.probability[:, :, 0]
        weights = np.take_along_axis(right_chance, right_voxel[:, right_of], 1)
        weights = weights * np.take_along_axis(left_chance, left_voxel, 2)[:, right_of, left_of]
        weights /= weights.sum(1, keepdims=True)
        if self.refine:
            heat = np.empty((len(people), samples, len(self.card.joints), *right.heat.shape[3:]), np.float32)
            heat[:, :, rest], heat[:, :, hands[0]], heat[:, :, hands[1]] = (
                others.heat, right.heat[:, :, 0], left.heat[:, right_of, 0],
            )  # fmt: skip
            poses = self.refined(poses, history[:, -1], hands, heat)
        progress(1.0)
        each_right = np.take_along_axis(right_chance, right_voxel, 1)
        each_right /= each_right.sum(1, keepdims=True)
        maps = right_chance, (each_right[..., None] * left_chance).sum(1)
        order = np.argsort(-weights, 1, kind="stable")
        return _Goals(
            np.take_along_axis(poses, order[..., None, None], 1),
            np.take_along_axis(weights, order, 1),
            {hand: map.reshape(-1, *right.heat.shape[3:]) for hand, map in zip(HANDS, maps, strict=True)},
        )

    def ask(self, history: np.ndarray, known: np.ndarray, stage: int, asked: list[int]) -> Said:
        """One pass of the graph for all hypotheses of everybody."""
        (graph,) = self.sessions()
        given = {
            "history": history.astype(np.float32), "known": known.astype(np.float32), "stage": np.array(stage),
            "asked": np.array(asked),
        }  # fmt: skip
        heat, level, offsets = map(np.asarray, graph.run(None, given))
        rows = known.shape[:2]
        return Said(
            heat.reshape(*rows, *heat.shape[1:]), level.reshape(*rows, *heat.shape[1:]),
            offsets.reshape(*rows, len(asked), 3, -1),
        )  # fmt: skip

    def chosen(self, said: Said, count: int, chances: list[np.random.Generator]) -> np.ndarray:
        """Voxels of a hand, ``(people, hypotheses, count)``."""
        if self.sampling == "temperature":
            spread = np.repeat(said.probability, count, 2)
            return drawn(spread, chances)
        levels = said.level.reshape(*said.level.shape[:2], -1)
        return np.apply_along_axis(plateau, -1, levels, count)

    def refined(self, poses: np.ndarray, last: np.ndarray, hands: list[int], heat: np.ndarray) -> np.ndarray:
        """Poses ``(people, goals, joints, 3)`` made whole, all at once."""
        people, count, joints, _ = poses.shape
        flat = poses.reshape(-1, joints, 3)
        last = np.repeat(last, count, 0)
        last[:, 0] = 0
        energy = PoseEnergy(
            self.card.joints,
            last,
            (hands[0], hands[1]),
            flat[:, hands],
            heat.reshape(-1, *heat.shape[2:]),
            ANGLES,
            CLOSENESS,
        )
        return lowered(energy, flat).reshape(people, count, joints, 3)

    def with_threads(self, threads: int) -> GoalForecaster:
        """The same model, computing with so many threads."""
        return replace(self, threads=threads, _opened=[])

    def sessions(self) -> list[onnxruntime.InferenceSession]:
        """The graph, opened when first asked for.

        Raises:
            InputError: If the file is missing or damaged.
        """
        if not self._opened:
            self._opened = opened([self.weights], self.card.checksum, self.threads)
        return self._opened


class _Goals(NamedTuple):
    """Goals of everybody: ``(people, goals, joints, 3)``, their weights ``(people, goals)``, the hands' heat."""

    poses: np.ndarray
    weights: np.ndarray
    heat: dict[str, np.ndarray]


def chance_of(person: str, seed: int) -> np.random.Generator:
    """A person's own source of chance, whoever else is there."""
    return np.random.default_rng(int.from_bytes(hashlib.sha256(f"{seed} {person}".encode()).digest()))


def plateau(levels: np.ndarray, count: int) -> np.ndarray:
    """So many voxels of the highest level, evenly spread over their numbers; the last again where there are fewer.

    Example:
        >>> plateau(np.array([1, 9, 9, 2, 9, 9, 9]), 3).tolist(), plateau(np.array([1, 9, 2, 9]), 3).tolist()
        ([1, 4, 6], [1, 3, 3])
    """
    highest = np.flatnonzero(levels == levels.max())
    if len(highest) < count:
        return highest[np.minimum(np.arange(count), len(highest) - 1)]
    return highest[np.linspace(0, len(highest) - 1, count).round().astype(int)]


def softmax(values: np.ndarray) -> np.ndarray:
    """Shares along the last axis that sum to 1."""
    odds = np.exp(values - values.max(-1, keepdims=True))
    return odds / odds.sum(-1, keepdims=True)


def drawn(shares: np.ndarray, chances: list[np.random.Generator]) -> np.ndarray:
    """A voxel by its share for each map, ``(people, ...)`` of ``(people, ..., voxels)``."""
    levels = np.stack([chance.random(shares.shape[1:-1]) for chance in chances])
    below = (np.cumsum(shares, -1) < levels[..., None] * shares.sum(-1, keepdims=True)).sum(-1)
    return np.minimum(below, shares.shape[-1] - 1)


def blurred(heat: np.ndarray) -> np.ndarray:
    """Heat averaged over nearby voxels, the outermost repeated, ``(..., voxels)``."""
    width, size = 2 * BLUR + 1, heat.shape[-1]
    padded = np.pad(heat, [(0, 0)] * (heat.ndim - 3) + [(BLUR, BLUR)] * 3, mode="edge")
    for axis in (-3, -2, -1):
        shifted = np.moveaxis(padded, axis, 0)
        mean = np.add.reduce([shifted[step : step + size] for step in range(width)]) / width
        padded = np.moveaxis(mean, 0, axis)
    return padded.reshape(*heat.shape[:-3], -1)


def grounded(poses: np.ndarray, last: np.ndarray) -> np.ndarray:
    """Poses whose lowest joint is as high as that of the last pose: who crouches does not hang in the air.

    Args:
        poses: ``(people, goals, joints, 3)``.
        last: ``(people, joints, 3)``.
    """
    drop = poses[..., 2].min(2) - last[:, None, :, 2].min(2)
    return poses - drop[..., None, None] * np.array([0, 0, 1])


def _warnings(question: Question) -> tuple[str, ...]:
    """Who was seen too briefly, in a sentence."""
    if not question.brief.any():
        return ()
    names = ", ".join(person for person, short in zip(question.asked.people, question.brief, strict=True) if short)
    return (f"{names}: seen too briefly for the model; their last pose stands for their goals",)
