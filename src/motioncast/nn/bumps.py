"""Heat that is told by a few places: where a token points, and how wide and how hot it is there.

Volumes that convolutions make of a token are blind to where a joint was until they have seen many poses. A bump around
the last place, moved by what the token says, knows it from the start.
"""

from __future__ import annotations

import torch
from torch import Tensor, nn

from motioncast.core.voxels import SIDE_M
from motioncast.nn.voxels import CLASSES, corners

WIDEST, NARROWEST = 0.5, 0.05
"""Standard deviations of bumps, in metres."""

SPREAD_M = 0.15
"""How far bumps lie from the last place in an untrained network; the first one does not."""

HIDDEN = 128


class Bumps(nn.Module):
    """Places that each token points to.

    Args:
        width: Channels of a token.
        count: Bumps for a token.
        cells: Voxels along an edge.
    """

    lower: Tensor

    def __init__(self, width: int, count: int, cells: int) -> None:
        super().__init__()
        self.count, self.cells = count, cells
        self.point = nn.Sequential(nn.Linear(width, HIDDEN), nn.GELU(), nn.Linear(HIDDEN, count * (4 + CLASSES)))
        last = self.point[-1]
        assert isinstance(last, nn.Linear)
        bias = torch.zeros(count, 4 + CLASSES)
        bias[1:, :3] = SPREAD_M * torch.randn(count - 1, 3)
        bias[:, 4:] = torch.arange(CLASSES) / CLASSES
        last.weight.data *= 0.3
        last.bias.data = bias.flatten()
        self.register_buffer("lower", corners(cells), persistent=False)

    def forward(self, tokens: Tensor, last: Tensor) -> tuple[Tensor, Tensor, Tensor]:
        """Bumps of every token.

        Args:
            tokens: ``(B, A, width)``.
            last: Where each joint was seen last, ``(B, A, 3)`` metres, hip-centred.

        Returns:
            Height of each bump in each voxel ``(B, A, bumps, V^3)``, what it says of each level ``(B, A, 10, bumps)``,
            and its place ``(B, A, bumps, 3)`` metres.
        """
        said = self.point(tokens).unflatten(-1, (self.count, -1))
        place = last[:, :, None] + said[..., :3]
        width = NARROWEST + (WIDEST - NARROWEST) * said[..., 3:4].sigmoid()
        middle = self.lower + SIDE_M / self.cells / 2
        x, y, z = (-0.5 * ((middle - place[..., None]) / width[..., None]) ** 2).exp().unbind(-2)
        plane = x[..., :, None] * y[..., None, :]
        height = (plane.flatten(-2)[..., None] * z[..., None, :]).flatten(-2)
        return height, said[..., 4:].transpose(-1, -2), place

    def offsets(self, height: Tensor, place: Tensor) -> Tensor:
        """From every voxel's lower corner to the bumps around it, at most one voxel, ``(B, A, 3, V, V, V)``."""
        cells, most = self.cells, SIDE_M / self.cells
        share = (height / (height.sum(2, keepdim=True) + 1e-3)).unflatten(-1, (cells, cells, cells))
        x, y, z = (place[..., None] - self.lower).clamp(-most, most).unbind(-2)
        along = x[..., :, None, None], y[..., None, :, None], z[..., None, None, :]
        return torch.stack([(share * axis).sum(2) for axis in along], 2)
