"""Losses that more than one model uses."""

from __future__ import annotations

from torch import Tensor


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
