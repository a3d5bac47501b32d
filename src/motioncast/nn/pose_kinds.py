"""What kind of thing somebody is doing, told from one pose: the classifier of the inception score.

Diller, Funkhouser and Dai (CVPR 2022) use "a simple skeleton-based action classifier" that was not released. Here it is
a perceptron on a pose as seen from itself, which learns the coarse kinds of CMU's takes (``datasets.cmu_goals``) from
the true characteristic poses of the training takes. A pose says little about the kind of its take (a step of a dance is
a step), so a score compares answers, and says nothing by itself.
"""

from __future__ import annotations

import copy
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import torch
from torch import Tensor, nn
from torch.nn import functional

from motioncast.core.skeleton import Skeleton
from motioncast.core.voxels import across, turned_back

WIDTH, DROPOUT, LEARNING_RATE, EPOCHS, BATCH = 256, 0.2, 1e-3, 60, 64


@dataclass(frozen=True, slots=True)
class PoseKinds:
    """A trained classifier.

    Attributes:
        network: From poses ``(N, 3 J)`` to scores ``(N, kinds)``.
        kinds: What it tells apart.
        skeleton: Which joint is which.
    """

    network: nn.Module
    kinds: tuple[str, ...]
    skeleton: Skeleton

    @torch.no_grad()
    def probabilities(self, poses: np.ndarray) -> np.ndarray:
        """Probability of each kind, ``(..., kinds)``, of poses ``(..., J, 3)`` metres around the hip."""
        scores = self.network(seen_from_itself(poses, self.skeleton))
        return torch.softmax(scores, -1).numpy().reshape(*poses.shape[:-2], -1)

    def accuracy(self, poses: np.ndarray, kinds: Sequence[str]) -> float:
        """Share of poses ``(N, J, 3)`` whose kind it tells right."""
        told = np.array(self.kinds)[self.probabilities(poses).argmax(-1)]
        return float(np.mean(told == np.array(kinds)))


def seen_from_itself(poses: np.ndarray, skeleton: Skeleton) -> Tensor:
    """Poses ``(..., J, 3)`` turned until their own right lies along +x, ``(N, 3 J)``."""
    own = turned_back(poses, across(poses, skeleton)[..., None, :])
    return torch.from_numpy(own.reshape(-1, own.shape[-2] * 3).astype(np.float32))


def fit(
    poses: np.ndarray,
    kinds: Sequence[str],
    checks: np.ndarray,
    check_kinds: Sequence[str],
    skeleton: Skeleton,
    seed: int = 0,
) -> PoseKinds:
    """A classifier trained on poses ``(N, J, 3)``; the epoch is that of the lowest loss on the checks."""
    torch.manual_seed(seed)
    names = tuple(sorted(set(kinds)))
    given, labels = seen_from_itself(poses, skeleton), torch.tensor([names.index(kind) for kind in kinds])
    known = [row for row, kind in enumerate(check_kinds) if kind in names]
    asked = seen_from_itself(checks[known], skeleton)
    truth = torch.tensor([names.index(check_kinds[row]) for row in known])
    network = nn.Sequential(
        nn.Linear(given.shape[1], WIDTH), nn.ReLU(), nn.Dropout(DROPOUT),
        nn.Linear(WIDTH, WIDTH), nn.ReLU(), nn.Dropout(DROPOUT), nn.Linear(WIDTH, len(names)),
    )  # fmt: skip
    optimiser = torch.optim.Adam(network.parameters(), LEARNING_RATE)
    best, kept = np.inf, network
    for _ in range(EPOCHS):
        network.train()
        for rows in torch.randperm(len(given)).split(BATCH):
            optimiser.zero_grad()
            functional.cross_entropy(network(given[rows]), labels[rows]).backward()
            optimiser.step()
        network.eval()
        with torch.no_grad():
            loss = float(functional.cross_entropy(network(asked), truth))
        if loss < best:
            best, kept = loss, copy.deepcopy(network)
    return PoseKinds(kept.eval(), names, skeleton)
