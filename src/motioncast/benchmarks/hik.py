"""Humans in Kitchens, by its owners' list: 961 items of kitchen D, each ten seconds of what somebody goes on to do.

What the owners leave open is settled so: the acting person is scored, as they do, and beside it everybody who is there;
people of D who are in the training kitchens too are told from those who are not; intervals are over people, since items
of one person overlap. A model is handed the history alone, and the furniture as it stood at now.
"""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import asdict, dataclass, replace
from hashlib import sha256
from pathlib import Path

import numpy as np

from motioncast.benchmarks.protocol import Protocol, as_asked, tenths_mm
from motioncast.benchmarks.result import Result, Row, commit
from motioncast.benchmarks.rooms.tally import Mean, Ratio, Tally, rows
from motioncast.core.forecaster import Forecaster
from motioncast.core.scene import Scene
from motioncast.datasets import hik
from motioncast.datasets.hik_furniture import pieces
from motioncast.errors import InputError
from motioncast.metrics.position import joint_errors

MOMENTS = (5, 15, 25, 50, 100, 150, 200, 250)
"""The owners print the first three, 0.2 to 1 s; the others go on to their ten seconds."""

PROTOCOL = Protocol(
    "hik", "hik29", hik.FPS, hik.HISTORY, hik.HORIZON, MOMENTS, MOMENTS, "mpjpe",
    "the owners' list of kitchen D, the acting person", stride=0,
)  # fmt: skip

NEVER_IN_TRAINING = frozenset((2, 4, 6, 12, 15, 16, 17, 26))
"""People of D who are in none of the kitchens A, B and C, by the owners' table of identities: 8 of 24."""


@dataclass(frozen=True, slots=True, eq=False)
class HikWindow:
    """An item of the list.

    Attributes:
        item: What it names.
        scene: Ten seconds of those who are there at now, the acting person first, and the furniture.
        future: What they did then, ``(time, people, joints, 3)`` metres.
        seen: Whether they were there, ``(time, people)``.
    """

    item: hik.Item
    scene: Scene
    future: np.ndarray
    seen: np.ndarray


def hik_windows(data: Path) -> list[HikWindow]:
    """The items of kitchen D whose acting person is there at now, in the list's order.

    Raises:
        InputError: If there is none.
        FormatError: If a file is damaged.
    """
    present, furniture, found = hik.stays(data, hik.TEST), pieces(data, *hik.TEST), []
    for item in hik.items(data):
        whole = hik.window(present, item)
        now = hik.HISTORY - 1
        there = [person for person, seen in zip(whole.people, np.all(whole.observed[now], -1), strict=True) if seen]
        if whole.people[0] not in there:
            continue  # nobody can tell how one goes on who only then comes in
        known = whole.select(there)
        things = tuple(piece.at(item.frame - 1) for piece in furniture)
        past, future = replace(known[: hik.HISTORY], objects=things, floor_m=0.0), known[hik.HISTORY :]
        found.append(HikWindow(item, past, future.positions, np.all(future.observed, -1)))
    if not found:
        raise InputError(
            f"{data} has no stay of kitchen D that the list names; give the folder with poses and test.json"
        )
    return found


def evaluate_hik(
    model: Forecaster, data: Path, alone: bool = False, progress: Callable[[float], None] | None = None
) -> Result:
    """Measure a model by the owners' list; arguments as of :func:`motioncast.benchmarks.run.evaluate`."""
    windows, answers = hik_windows(data), []
    for number, window in enumerate(windows):
        scene = window.scene.select(window.scene.people[:1]) if alone else window.scene
        future = model.forecast(scene, horizon_s=hik.HORIZON / hik.FPS, seed=PROTOCOL.seed + number).best
        answers.append(as_asked(future, hik.HORIZON, len(scene.people)))
        if progress is not None:
            progress((number + 1) / len(windows))
    card, checksum = model.card, sha256(b"".join(map(digest, windows))).hexdigest()
    told = json.dumps(asdict(PROTOCOL), sort_keys=True) + checksum
    return Result(
        model=f"{card.name} (others hidden)" if alone else card.name,
        benchmark=PROTOCOL.name,
        protocol=sha256(told.encode()).hexdigest()[:16],
        data=checksum,
        setting={**asdict(PROTOCOL), "moments_ms": PROTOCOL.moments_ms, "split": "test"},
        windows=len(windows),
        takes=len({window.item.person for window in windows}),
        independent=f"{len({window.item.person for window in windows})} people",
        weights=card.checksum,
        parameters=card.parameters,
        training=card.training,
        command=f"motioncast evaluate {card.name} {PROTOCOL.name} --data DIR{' --alone' * alone}",
        commit=commit(),
        seed=PROTOCOL.seed,
        rows=tuple(score(windows, answers)),
    )


def digest(window: HikWindow) -> bytes:
    """SHA-256 of what an item holds, at 0.1 mm."""
    return sha256(tenths_mm(window.scene.positions) + tenths_mm(window.future) + window.seen.tobytes()).digest()


def score(windows: list[HikWindow], answers: list[np.ndarray]) -> list[Row]:
    """The rows of a result: errors of the acting person, by kind, and of everybody; last the ratio to standing still.

    Args:
        windows: What happened.
        answers: What was forecast, ``(time, people, joints, 3)``, the acting person first.
    """
    tally, still = Tally(len(windows), hik.HORIZON), Tally(len(windows), hik.HORIZON)
    for number, (window, answer) in enumerate(zip(windows, answers, strict=True)):
        item, people = window.item, answer.shape[1]
        known = "unseen" if item.person in NEVER_IN_TRAINING else "seen"
        off, held = (
            1000 * np.where(window.seen[:, :people, None], joint_errors(body, window.future[:, :people]), np.nan)
            for body in (answer, window.scene.positions[-1:, :people])
        )
        for frame in MOMENTS:
            acting = off[frame - 1, 0]
            tally.add(number, "mpjpe_at", acting, "mm", frame)
            tally.add(number, f"mpjpe_at_of_{known}_people", acting, "mm", frame)
            tally.add(number, f"mpjpe_at_{item.action}", acting, "mm", frame)
            tally.add(number, "mpjpe_at_of_everybody", off[frame - 1], "mm", frame)
            still.add(number, "mpjpe_at", held[frame - 1, 0], "mm", frame)
    figures = tally.figures()
    forecast, zero = (Mean("mpjpe", part["mpjpe_at"]) for part in (figures, still.figures()))
    found = [figure for name in sorted(figures) for figure in figures[name]]
    people = [str(window.item.person) for window in windows]
    return rows([*found, Ratio("ratio_to_zero_velocity", forecast, zero)], people, hik.FPS)
