"""Sequences of the kitchen as a camera sees them: poses in the image, labels, objects; and the truth to measure by."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from motioncast.core.action_sequence import ActionSequence
from motioncast.core.camera import Camera, look_at
from motioncast.core.rotation import from_euler, rotate
from motioncast.core.skeletons import UPPER9
from motioncast.core.upper_body import from_neck
from motioncast.datasets.kitchen.dishes import LABELS, OBJECTS, draw_objects, draw_pair, draw_steps
from motioncast.datasets.kitchen.motion import MEAN_S, Motion, draw_style, perform
from motioncast.errors import InputError

SPLITS = {"train": 0, "validation": 1, "test": 2, "bank": 3}
"""Number of each split in the seed of its sequences; the bank's cooks are in no other."""

MOMENTS = ("characteristic", "middle", "random")
"""Which pose stands for a step: the characteristic one, that in its middle, or any."""

FURTHEST_ASIDE = 0.8
"""Cameras stand within this angle of straight ahead, radians."""

NOISE_PX = (2.0, 5.0)
"""Standard deviation of a detector's errors, drawn for each sequence."""

APART_M = 1.3
"""Two cooks stand so far from each other."""


def sequence(
    split: str, number: int, seed: int = 0, people: int = 1, moments: str = "characteristic"
) -> ActionSequence:
    """One sequence; the same arguments give the same numbers.

    Args:
        split: ``train``, ``validation``, ``test`` or ``bank``.
        number: Which one.
        seed: Of the whole set.
        people: One cook or two.
        moments: Which pose stands for a step (``MOMENTS``).

    Raises:
        InputError: If there is no such split, or no such moments.

    Example:
        >>> one = sequence("train", 0)
        >>> one.pixels.shape == (len(one), 1, 9, 2)
        True
    """
    random, objects, motions, camera = scenery(split, number, seed, people)
    times = np.stack([moments_of(motion, moments, random) for motion in motions], 1)
    return seen_at(f"{split} {number}", times, objects, motions, camera, random)


def sequences(
    split: str, count: int, seed: int = 0, people: int = 1, moments: str = "characteristic"
) -> Iterator[ActionSequence]:
    """The first sequences of a split; arguments as of :func:`sequence`."""
    return (sequence(split, number, seed, people, moments) for number in range(count))


def uncoupled(
    split: str, count: int, history: int, steps: int, stride: int = 1, seed: int = 0
) -> Iterator[ActionSequence]:
    """Pieces of ``history + steps`` steps whose poses are taken at equal times, whatever is done there.

    The past ends where a step ends, and poses lie ``MEAN_S`` seconds apart before and after that moment.
    """
    for number in range(count):
        random, objects, motions, camera = scenery(split, number, seed, 1)
        for start in range(0, len(motions[0].steps) - history - steps + 1, stride):
            now = motions[0].ends_s[start + history - 1]
            times = np.clip(now + MEAN_S * (np.arange(-history, steps) + 0.5), 0, motions[0].ends_s[-1])
            piece = slice(start, start + history + steps)
            yield seen_at(f"{split} {number}", times[:, None], objects, motions, camera, random, piece)


def scenery(
    split: str, number: int, seed: int, people: int
) -> tuple[np.random.Generator, np.ndarray, tuple[Motion, ...], Camera]:
    """A source of chance, the objects, the motion of each cook, and the camera of a sequence.

    Raises:
        InputError: If there is no such split.
    """
    if split not in SPLITS:
        raise InputError(f'the kitchen has no split "{split}"; choose one of {", ".join(SPLITS)}')
    random = np.random.default_rng([seed, SPLITS[split], number, people])
    objects = draw_objects(random)
    if people == 1:
        motions = (perform(draw_steps(objects, random), draw_style(random), random),)
    else:
        fetching, working = draw_pair(objects, random)
        first = perform(fetching, draw_style(random, -1), random)
        motions = (first, perform(working, draw_style(random, 1), random, first.ends_s))
    return random, objects, motions, draw_camera(random, people)


def seen_at(
    name: str,
    times: np.ndarray,
    objects: np.ndarray,
    motions: tuple[Motion, ...],
    camera: Camera,
    random: np.random.Generator,
    steps: slice = slice(None),
) -> ActionSequence:
    """What a camera sees of cooks at moments ``(steps, people)`` in seconds, and a detector finds."""
    poses = [moved(motion.at(times[:, person]), person, len(motions)) for person, motion in enumerate(motions)]
    positions = np.stack(poses, 1)
    exact = camera.project(positions)
    return ActionSequence(
        name=name,
        labels=LABELS,
        actions=np.stack([motion.actions for motion in motions], 1)[steps],
        pixels=exact + random.normal(0, random.uniform(*NOISE_PX), exact.shape),
        camera=camera,
        things=OBJECTS,
        objects=objects,
        positions=positions,
    )


def moved(pose: np.ndarray, person: int, people: int) -> np.ndarray:
    """A cook's pose in the world: two stand side by side, the first one to the left."""
    return pose if people == 1 else pose + np.array([0.0, APART_M * (0.5 - person), 0.0])


def moments_of(motion: Motion, moments: str, random: np.random.Generator) -> np.ndarray:
    """When each step is looked at, ``(steps,)`` seconds."""
    if moments not in MOMENTS:
        raise InputError(f'no pose of a step is called "{moments}"; choose one of {", ".join(MOMENTS)}')
    if moments == "characteristic":
        return motion.peak_s
    share = 0.5 if moments == "middle" else random.random(len(motion.steps))
    return motion.ends_s - share * np.diff(motion.ends_s, prepend=0)


def draw_camera(random: np.random.Generator, people: int = 1) -> Camera:
    """A camera 3 to 4 m away, 1.5 m high, that looks at the cook from ahead."""
    angle, distance = random.uniform(-FURTHEST_ASIDE, FURTHEST_ASIDE), random.uniform(3, 4) + 0.8 * (people - 1)
    place = np.array([distance * np.cos(angle), distance * np.sin(angle), 1.5 + random.normal(0, 0.05)])
    return look_at(place, np.array([0.2, 0.0, 1.15]) + random.normal(0, 0.05, 3))


def bank(count: int, seed: int = 0, poses_of_one: int = 128) -> np.ndarray:
    """Real poses that belong to no video: cooks of their own at any moment, mirrored or not, turned at random.

    Nobody is turned farther from the camera than kitchens have them, since a camera is put up to see what is done.

    Args:
        count: Number of poses.
        seed: Of the whole set.
        poses_of_one: Poses taken from one sequence.

    Returns:
        ``(count, 9, 3)`` metres along a camera's axes, the neck at the origin.
    """
    found = []
    for number in range(-(-count // poses_of_one)):
        random, _, (motion,), camera = scenery("bank", number, seed, 1)
        poses = motion.at(random.uniform(0, motion.ends_s[-1], poses_of_one))
        found.append(turned_at_random(poses, camera, random))
    return np.concatenate(found)[:count]


def turned_at_random(poses: np.ndarray, camera: Camera, random: np.random.Generator) -> np.ndarray:
    """Poses ``(n, 9, 3)`` of a world, half of them mirrored, each turned at random, along a camera's axes."""
    mirrored = poses[:, list(UPPER9.mirror())] * np.array([1.0, -1.0, 1.0])
    poses = np.where(random.random((len(poses), 1, 1)) < 0.5, mirrored, poses)
    ahead = np.arctan2(camera.position[1], camera.position[0])
    yaw = from_euler(ahead + random.uniform(-FURTHEST_ASIDE, FURTHEST_ASIDE, (len(poses), 1, 1)), "z")
    return from_neck(camera.seen(rotate(yaw, poses))).astype(np.float32)
