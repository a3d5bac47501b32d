"""Judges of realism in rooms: classifiers trained on training rooms, asked about test rooms.

A judge that was trained on a model's own motion tells how well that model can be detected; the paper's judge is of
this kind. A judge that never saw the model tells how near to real motion it is. Both are asked here; neither says
anything about motion that was judged by another training.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
import torch
from torch import Tensor

from motioncast.benchmarks.rooms.scoring import FPS, HIPS, SECONDS, Samples
from motioncast.benchmarks.rooms.tally import Measured, Tally
from motioncast.benchmarks.rooms.windows import PROTOCOL, RoomWindow
from motioncast.nn.realism import FRAMES, HOP, Realism, fit, realism_until, snippets_of

SNIPPETS = 6_000
"""Real snippets of a training at most; as many are made up, of all models in equal parts."""


def stayed(windows: Sequence[RoomWindow], samples: Samples) -> np.ndarray:
    """The first futures of those who were there all the time, ``(people, time, joints, 3)``."""
    whole = (futures[0][:, window.seen.all(0)] for window, futures in zip(windows, samples, strict=True))
    return np.concatenate([motion.swapaxes(0, 1) for motion in whole])


def some(motion: np.ndarray, count: int, seed: int) -> Tensor:
    """That many snippets of motions, or all where there are fewer, ``(snippets, 50, joints, 3)``."""
    snippets = snippets_of(motion, HIPS).flatten(0, 1)
    order = np.random.default_rng(seed).permutation(len(snippets))[:count]
    return snippets[torch.from_numpy(order)]


def judge(real: np.ndarray, made_up: Mapping[str, np.ndarray], seed: int = 0) -> Realism:
    """A classifier of real motion against that of several models.

    Args:
        real: ``(people, time, joints, 3)`` metres at 25 fps.
        made_up: The same of each model.
        seed: Of what is drawn and of the training.
    """
    known = some(real, SNIPPETS, seed)
    share = -(-len(known) // len(made_up))
    return fit(known, torch.cat([some(motion, share, seed) for motion in made_up.values()]), seed)


def realism(judge: Realism, windows: Sequence[RoomWindow], samples: Samples) -> list[Measured]:
    """The realism score until 2, 3, ... 10 s, 0 to 1, of those who were there all the time."""
    tally = Tally(len(windows), PROTOCOL.horizon)
    for number, (window, futures) in enumerate(zip(windows, samples, strict=True)):
        motion = futures[0][:, np.all(window.seen, 0)].swapaxes(0, 1)
        if not len(motion):
            continue
        scores = realism_until(judge, motion, HIPS)
        for second in SECONDS[1:]:
            frame = round(second * FPS)
            tally.add(number, "realism_until", scores[:, (frame - FRAMES) // HOP], "1", frame)
    return tally.figures()["realism_until"]
