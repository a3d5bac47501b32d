"""``cmu-actions``: exercises of CMU's takes, seen as 2D only, strung into long sequences: a demonstration, no more.

Labels of five takes come from mocap6 (``action_labels.csv``: runs of nine exercises, 120 frames a second; Fox, Hughes,
Sudderth, Jordan 2014, BSD 2-Clause), those of swordplay from the takes' descriptions. A run holds several repetitions;
each characteristic moment in it (``moments``) is a step. A *session* strings runs of one split together: it begins with
a jumping jack or a jog, goes on with any other run but the one before, and keeps two to five steps of each. Everybody
is set to the origin and faces +x at the start of a run; one camera a session looks at them as in the kitchen.

Splits keep whole takes together. They are this set's own: its takes of subjects 13 and 14 are *test* takes of every
other benchmark. What learns here is never evaluated on, or carried into, those. The critic's poses are of subjects in
none of these takes. 3D positions are handed out for measuring only.
"""

from __future__ import annotations

import csv
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from motioncast.core.action_sequence import ActionSequence
from motioncast.core.rotation import from_euler, rotate
from motioncast.core.scene import Scene
from motioncast.core.skeletons import UPPER9
from motioncast.datasets import cmu
from motioncast.datasets.kitchen.sequences import NOISE_PX, draw_camera, turned_at_random
from motioncast.datasets.moments import moments
from motioncast.errors import FormatError, InputError
from motioncast.formats.files import read_text

LABELS = (
    "arm circle", "jog", "jumping jack", "knee raise", "squat", "swordplay", "toe touch one hand",
    "toe touch two hands", "twist", "up-down",
)  # fmt: skip

SPLITS = {
    "13_29": "train", "14_14": "train", "14_20": "train", "02_07": "train",
    "13_30": "validation", "02_08": "validation",
    "13_31": "test", "02_09": "test",
}  # fmt: skip

DESCRIBED = {"02_07": "swordplay", "02_08": "swordplay", "02_09": "swordplay"}
"""Takes that hold one action, by their description."""

BEGINNINGS = ("jumping jack", "jog")
STEPS_OF_A_RUN = (2, 5)
SESSION_STEPS = 16
ABOVE_FLOOR_M = 0.95
"""Where the hip is set."""

BANK_FPS = 6.0
"""Poses a second that the bank takes of other takes."""


@dataclass(frozen=True, slots=True, eq=False)
class Run:
    """One exercise, done several times.

    Attributes:
        take: Name of the take.
        action: Its label.
        poses: The pose of each characteristic moment, ``(steps, 9, 3)`` metres, the hip of the first above the origin,
            facing +x.
    """

    take: str
    action: str
    poses: np.ndarray


def runs(data: str | Path, split: str) -> list[Run]:
    """The labelled runs of a split, in the order of takes and time.

    Args:
        data: Folder that holds CMU's takes and ``action_labels.csv`` (``cmu.takes``).
        split: ``train``, ``validation`` or ``test``.

    Raises:
        InputError: If takes or labels are missing, or there is no such split.
        FormatError: If a file is damaged.
    """
    if split not in SPLITS.values():
        raise InputError(f'cmu-actions has no split "{split}"; choose one of train, validation, test')
    labels = read_labels(Path(data))
    wanted = [take for take in cmu.takes(data) if SPLITS.get(take.name) == split]
    found: list[Run] = []
    for take, scene in zip(wanted, cmu.read(wanted), strict=True):
        spans = labels.get(take.name, []) or [(0, scene.frames, DESCRIBED[take.name])]
        found += [run for span in spans if (run := _run(take.name, scene, *span)) is not None]
    if not found:
        raise InputError(f"{data} holds none of the takes {', '.join(SPLITS)}; obtain them as docs/datasets.md says")
    return found


def read_labels(data: Path) -> dict[str, list[tuple[int, int, str]]]:
    """First frame, end frame and action of each labelled run, by take.

    Raises:
        InputError: If the table is missing.
        FormatError: If it is damaged, or names another action.
    """
    places = [place / "action_labels.csv" for place in (data, data / "cmu")]
    path = next((place for place in places if place.is_file()), None)
    if path is None:
        raise InputError(f"{data} holds no action_labels.csv; it comes beside cmu_NNN.tar.xz, see docs/datasets.md")
    found: dict[str, list[tuple[int, int, str]]] = {}
    for line, row in enumerate(csv.DictReader(read_text(path).splitlines()), 2):
        try:
            span = int(row["first_frame"]), int(row["end_frame"]), row["action"]
            LABELS.index(span[2])
        except (KeyError, ValueError, TypeError):
            expected = "name,first_frame,end_frame,action with an action of " + ", ".join(LABELS)
            raise FormatError(path, f"{row} is no labelled run; expected {expected}", line) from None
        found.setdefault(row["name"], []).append(span)
    return found


def _run(take: str, scene: Scene, first: int, end: int, action: str) -> Run | None:
    """A run of a take; None where it has no characteristic moment."""
    part = scene[first:end]
    frames = [moment.frame for moment in moments(part)]
    if not frames:
        return None
    poses = part.on(UPPER9).positions[:, 0].astype(np.float64)
    poses -= poses[0, 8] - [0, 0, ABOVE_FLOOR_M]
    left, right = (poses[0, UPPER9.index(f"{side}_shoulder")] for side in ("left", "right"))
    heading = np.arctan2(-(left - right)[0], (left - right)[1])
    return Run(take, action, rotate(from_euler(np.array([-heading]), "z"), poses[frames]))


def session(available: list[Run], number: int, seed: int = 0, name: str = "session") -> ActionSequence:
    """A long sequence strung from runs; the same arguments give the same numbers.

    Args:
        available: Runs of one split.
        number: Which session.
        seed: Of all sessions.
        name: What it is called.
    """
    random = np.random.default_rng([seed, number])
    actions: list[int] = []
    poses: list[np.ndarray] = []
    before: Run | None = None
    while len(actions) < SESSION_STEPS:
        open_ = [run for run in available if run is not before]
        if before is None:
            open_ = [run for run in open_ if run.action in BEGINNINGS] or open_
        before = open_[random.integers(len(open_))]
        most = min(len(before.poses), int(random.integers(STEPS_OF_A_RUN[0], STEPS_OF_A_RUN[1] + 1)))
        start = int(random.integers(len(before.poses) - most + 1))
        poses += list(before.poses[start : start + most])
        actions += [LABELS.index(before.action)] * most
    camera = draw_camera(random)
    positions = np.stack(poses[:SESSION_STEPS])[:, None]
    exact = camera.project(positions)
    return ActionSequence(
        name=f"{name} {number}",
        labels=LABELS,
        actions=np.array(actions[:SESSION_STEPS])[:, None],
        pixels=exact + random.normal(0, random.uniform(*NOISE_PX), exact.shape),
        camera=camera,
        positions=positions,
    )


def sessions(data: str | Path, split: str, count: int, seed: int = 0) -> Iterator[ActionSequence]:
    """The first sessions of a split; arguments as of :func:`runs`."""
    available = runs(data, split)
    return (session(available, number, seed, split) for number in range(count))


def bank(data: str | Path, seed: int = 0) -> np.ndarray:
    """Real poses of *other* subjects' training takes, mirrored or not, turned at random.

    Returns:
        ``(n, 9, 3)`` metres along a camera's axes, the neck at the origin.
    """
    labelled = {int(name[:2]) for name in SPLITS}
    others = [take for take in cmu.takes(data, "train") if take.subject not in labelled]
    random, found = np.random.default_rng(seed), []
    for scene in cmu.read(others):
        body = scene.on(UPPER9)
        stride = max(1, round(body.fps / BANK_FPS))
        poses, seen = body.positions[::stride, 0].astype(np.float64), body.observed[::stride, 0].all(-1)
        if seen.any():
            found.append(turned_at_random(_facing_ahead(poses[seen]), draw_camera(random), random))
    return np.concatenate(found)


def _facing_ahead(poses: np.ndarray) -> np.ndarray:
    """Poses ``(n, 9, 3)``, each turned so that the shoulders face +x, the hip above the origin."""
    across = poses[:, UPPER9.index("left_shoulder")] - poses[:, UPPER9.index("right_shoulder")]
    heading = np.arctan2(-across[:, 0], across[:, 1])
    turned = rotate(from_euler(-heading[:, None], "z")[:, None], poses - poses[:, 8:])
    return turned + np.array([0, 0, ABOVE_FLOOR_M])
