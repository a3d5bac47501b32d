"""The usual code of a place in a sequence."""

from __future__ import annotations

import torch
from torch import Tensor


def sinusoids(place: Tensor, width: int) -> Tensor:
    """The usual code of a place, ``(..., width)``, for whole numbers ``(...)``."""
    channel = torch.arange(width, device=place.device)
    angle = place[..., None] / 10000 ** (2 * (channel // 2) / width)
    return torch.where(channel % 2 == 0, angle.sin(), angle.cos())
