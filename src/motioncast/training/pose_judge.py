"""A classifier that tells real poses from made-up ones, trained once and frozen: the quality of FutureHuman3D.

Its paper trains a network of three layers on real poses and on what all methods predict at different times of their
training (appendix). Here the made-up half is what the models of a comparison predict, and real poses that were spoilt:
joints moved at random, by millimetres or by decimetres, and bones made longer or shorter.
"""

from __future__ import annotations

import numpy as np
import torch
from torch import nn
from torch.nn.functional import binary_cross_entropy_with_logits

from motioncast.core.skeletons import UPPER9
from motioncast.metrics.actions import in_shoulder_widths

WIDTH, STEPS, BATCH, LEARNING_RATE = 256, 2000, 256, 1e-3


def spoilt(poses: np.ndarray, random: np.random.Generator) -> np.ndarray:
    """Poses ``(n, 9, 3)`` with joints moved, half of them, and with other lengths of bones, the other half."""
    moved = poses + random.normal(0, 1, poses.shape) * random.uniform(0.01, 0.2, (len(poses), 1, 1))
    stretched = poses.copy()
    factors = np.exp(random.normal(0, 0.35, (len(poses), len(UPPER9))))
    for joint, parent in ((0, 1), (2, 1), (3, 2), (4, 3), (5, 1), (6, 5), (7, 6), (8, 1)):
        bone = poses[:, joint] - poses[:, parent]
        stretched[:, joint] = stretched[:, parent] + factors[:, joint : joint + 1] * bone
    return np.where(random.random((len(poses), 1, 1)) < 0.5, moved, stretched)


def judge_poses(real: np.ndarray, made: np.ndarray, seed: int = 0) -> list[tuple[np.ndarray, np.ndarray]]:
    """The weights of a classifier, as ``metrics.actions.looks_real`` takes them.

    Args:
        real: Real poses, ``(n, 9, 3)`` metres.
        made: Made-up poses, ``(m, 9, 3)``; as many of each kind are seen.
        seed: Of weights, batches and of how poses are spoilt.
    """
    torch.manual_seed(seed)
    random = np.random.default_rng(seed)
    width = in_shoulder_widths(real).shape[-1]
    network = nn.Sequential(nn.Linear(width, WIDTH), nn.ReLU(), nn.Linear(WIDTH, WIDTH), nn.ReLU(), nn.Linear(WIDTH, 1))
    optimiser = torch.optim.AdamW(network.parameters(), LEARNING_RATE, weight_decay=1e-3)
    target = torch.cat([torch.ones(BATCH), torch.zeros(2 * BATCH)])[:, None]
    weight = torch.cat([torch.full((BATCH,), 2.0), torch.ones(2 * BATCH)])[:, None]
    for _ in range(STEPS):
        drawn = [poses[random.integers(len(poses), size=BATCH)] for poses in (real, made, real)]
        drawn[2] = spoilt(drawn[2], random)
        told = torch.from_numpy(in_shoulder_widths(np.concatenate(drawn)).astype(np.float32))
        loss = binary_cross_entropy_with_logits(network(told), target, weight)
        optimiser.zero_grad()
        loss.backward()
        optimiser.step()
    linear = [layer for layer in network if isinstance(layer, nn.Linear)]
    return [(layer.weight.detach().numpy().T.copy(), layer.bias.detach().numpy().copy()) for layer in linear]
