"""A loss that asks a model for the history as well as for the future."""

from __future__ import annotations

import torch
from torch import Tensor

from motioncast.nn.losses import mean_distance


def with_reconstruction(answer: list[Tensor], truth: Tensor, observed: Tensor) -> Tensor:
    """Mean distance of the joints over the frames of history that a model gave back and those that it forecast.

    Args:
        answer: How far the history was missed, ``(B, K, P, J, 3)`` metres, and the future, ``(B, F, P, J, 3)``.
        truth: The true future, at least as long.
        observed: ``(B, >= F, P, J)`` bool.
    """
    missed, future = answer
    frames = future.shape[1]
    seen = torch.ones_like(missed[..., 0], dtype=torch.bool)  # gaps were filled before the model was asked
    past = mean_distance(missed, torch.zeros_like(missed), seen)
    ahead = mean_distance(future, truth[:, :frames], observed[:, :frames])
    return (missed.shape[1] * past + frames * ahead) / (missed.shape[1] + frames)
