"""Losses that more than one model uses."""

from __future__ import annotations

from collections.abc import Sequence

import torch
from torch import Tensor

LIMBS = ("hip", "knee", "ankle", "elbow", "wrist")
"""Places that end a bone of constant length."""


def mean_distance(answer: Tensor, truth: Tensor, observed: Tensor) -> Tensor:
    """Mean distance of the joints from the truth in metres, over joints that were seen.

    Args:
        answer: ``(..., 3)`` metres.
        truth: The same shape.
        observed: ``(...)`` bool.
    """
    # a tiny constant keeps the gradient finite where the distance is zero
    distance = ((answer - truth).square().sum(-1) + 1e-8).sqrt()
    return (distance * observed).sum() / observed.sum().clamp(min=1)


def with_true_lengths(answer: Tensor, truth: Tensor, bones: Sequence[tuple[int, int]]) -> Tensor:
    """The answer with bones as long as the true ones, from the root outwards: what a user sees of it.

    Args:
        answer: ``(..., joints, 3)`` metres.
        truth: The same shape.
        bones: Pairs (joint, parent), parents first.
    """
    joints = list(answer.unbind(-2))
    for joint, parent in bones:
        bone = joints[joint] - joints[parent]
        true = (truth[..., joint, :] - truth[..., parent, :]).norm(dim=-1, keepdim=True)
        joints[joint] = joints[parent] + bone * true / (bone.square().sum(-1, keepdim=True) + 1e-6).sqrt()
    return torch.stack(joints, -2)


def mean_over(values: Tensor, mask: Tensor) -> Tensor:
    """Mean of the values where the mask, of their shape, is set; zero if it is nowhere."""
    return (values * mask).sum() / mask.sum().clamp(min=1)
