"""What a denoiser is told of the noise: the code of a diffusion step."""

from __future__ import annotations

import math

import torch
from torch import Tensor, nn

CODE = 64
"""Numbers of a code."""


class FourierCode(nn.Module):
    """SAST's code of the whole-numbered step: sine and cosine of 32 fixed random multiples of it.

    With multiples around 1 the codes of neighbouring steps have nothing in common (mean cosine -0.07): each step that
    was trained has a name, and what lies between two of them has none.
    """

    frequencies: Tensor

    def __init__(self) -> None:
        super().__init__()
        self.frequencies = nn.Parameter(torch.randn(CODE // 2), requires_grad=False)

    def forward(self, step: Tensor) -> Tensor:
        """Steps ``(...)`` to codes ``(..., 64)``."""
        angle = 2 * math.pi * step[..., None] * self.frequencies
        return torch.cat([angle.sin(), angle.cos()], -1)


class LevelCode(nn.Module):
    """A code of the log signal-to-noise ratio, near for near levels: any step of any schedule has one."""

    frequencies: Tensor

    def __init__(self) -> None:
        super().__init__()
        # the slowest wave tells the levels of -20 to 10 apart, the fastest those of neighbouring steps
        frequencies = torch.logspace(math.log10(0.05), math.log10(3.0), CODE // 2)
        self.register_buffer("frequencies", frequencies, persistent=False)

    def forward(self, level: Tensor) -> Tensor:
        """Levels ``(...)`` to codes ``(..., 64)``."""
        angle = level[..., None] * self.frequencies
        return torch.cat([angle.sin(), angle.cos()], -1)
