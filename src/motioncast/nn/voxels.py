"""What a network over voxels needs: targets and their classes, doubling a volume, and what was published as its twin.

Diller, Funkhouser and Dai, "Forecasting Characteristic 3D Poses of Human Actions" (CVPR 2022), Sec. 3.4 and appendix.
Transposed convolutions stand here as plain ones, which is exact, faster on a CPU, and exports.
"""

from __future__ import annotations

import math

import torch
from torch import Tensor, nn

from motioncast.core.voxels import SIDE_M

CLASSES = 10

FINE, COARSE = (2, 2.0), (1, 1.0)
"""Reach of the target's kernel in voxels and its sigma, for 16 voxels along an edge and for fewer."""

NOTHING_SHARE = 0.1
"""Weight of the class of voxels where nothing is."""

RELEASE_COUNTS = {16: {0: 3990, 5: 6, 9: 1}, 8: {0: 493, 3: 12, 5: 6, 9: 1}}
"""How often the release takes each class to occur, from a toy volume; classes that are not there carry no loss."""


def cells_of(points: Tensor, cells: int) -> Tensor:
    """The voxel of each point ``(..., 3)`` (metres, hip-centred), as ``core.voxels.cell_of``."""
    return ((points / SIDE_M + 0.5) * cells).floor().clamp(0, cells - 1)


def corners(cells: int) -> Tensor:
    """Lower corners of all voxels along one edge, ``(cells,)`` metres."""
    return (torch.arange(cells) / cells - 0.5) * SIDE_M


def heat_classes(points: Tensor, cells: int) -> Tensor:
    """Target classes around each point: a Gaussian of highest value 1 in ten steps.

    The published kernel is exp(-(d / 2 sigma)^2) along each axis, cut at its reach.

    Args:
        points: ``(..., 3)`` metres, hip-centred.
        cells: Voxels along an edge.

    Returns:
        ``(..., cells, cells, cells)`` whole numbers from 0 to 9.
    """
    reach, sigma = FINE if cells >= 16 else COARSE
    away = (torch.arange(cells, device=points.device) - cells_of(points, cells)[..., None]).abs()  # ..., 3, cells
    x, y, z = torch.where(away <= reach, (-((away / (2 * sigma)) ** 2)).exp(), 0.0).unbind(-2)
    heat = x[..., :, None, None] * y[..., None, :, None] * z[..., None, None, :]
    return (heat * CLASSES).floor().clamp(max=CLASSES - 1).long()


def class_weights(cells: int, release: bool = False) -> Tensor:
    """Weight of each class in the cross entropy: 1 / ln(1.2 + occurrence in a volume), less where nothing is.

    Args:
        cells: Voxels along an edge.
        release: As the release counts, which leaves most classes without a weight.
    """
    if release:
        weights = torch.zeros(CLASSES)
        for level, count in RELEASE_COUNTS[cells].items():
            weights[level] = 1 / math.log(1.2 + count)
        return weights
    counts = torch.bincount(heat_classes(torch.zeros(3), cells).flatten(), minlength=CLASSES)
    weights = 1 / (1.2 + counts).log()
    weights[0] = NOTHING_SHARE
    return weights


def offsets_to(points: Tensor, cells: int) -> Tensor:
    """From every voxel's lower corner to points, at most one voxel along each axis.

    Args:
        points: ``(..., 3)`` metres, hip-centred.
        cells: Voxels along an edge.

    Returns:
        ``(..., 3, cells, cells, cells)`` metres.
    """
    line, most = corners(cells).to(points.device), SIDE_M / cells
    x, y, z = (points[..., None] - line).clamp(-most, most).unbind(-2)
    volumes = x[..., :, None, None], y[..., None, :, None], z[..., None, None, :]
    return torch.stack([volume.expand(*points.shape[:-1], cells, cells, cells) for volume in volumes], -4)


class Doubling(nn.Module):
    """A volume of twice the edge: each voxel becomes eight (a transposed convolution of kernel 2 and stride 2).

    Args:
        inward: Channels that come in.
        outward: Channels that go out.
    """

    def __init__(self, inward: int, outward: int) -> None:
        super().__init__()
        self.outward = outward
        self.mix = nn.Conv3d(inward, 8 * outward, 1, bias=False)
        self.bias = nn.Parameter(torch.zeros(outward))

    def forward(self, volume: Tensor) -> Tensor:
        """``(batch, inward, x, y, z)`` to ``(batch, outward, 2x, 2y, 2z)``."""
        x, y, z = volume.shape[2:]
        parts = self.mix(volume).view(-1, self.outward, 2, 2, 2, x, y, z)
        whole = parts.permute(0, 1, 5, 2, 6, 3, 7, 4).reshape(-1, self.outward, 2 * x, 2 * y, 2 * z)
        return whole + self.bias[:, None, None, None]


def from_transposed(weight: Tensor) -> Tensor:
    """The kernel of a plain convolution that does what a transposed one with this kernel does.

    Args:
        weight: ``(inward, outward, 3, 3, 3)`` with padding 1, for a ``Conv3d``; or ``(inward, outward, 2, 2, 2)`` with
            stride 2, for :class:`Doubling`.
    """
    if weight.shape[-1] == 3:
        return weight.transpose(0, 1).flip(2, 3, 4).contiguous()
    return weight.permute(1, 2, 3, 4, 0).reshape(-1, weight.shape[0], 1, 1, 1)


class Block(nn.Module):
    """A convolution or doubling, normalised over the batch, and a leaky ramp.

    Args:
        inward: Channels that come in.
        outward: Channels that go out.
        doubling: Whether it doubles the edge.
        ramp: Whether the ramp follows.
    """

    def __init__(self, inward: int, outward: int, *, doubling: bool = False, ramp: bool = True) -> None:
        super().__init__()
        self.mix = Doubling(inward, outward) if doubling else nn.Conv3d(inward, outward, 3, padding=1)
        self.norm = nn.BatchNorm3d(outward)
        self.ramp = nn.LeakyReLU(0.01) if ramp else nn.Identity()

    def forward(self, volume: Tensor) -> Tensor:
        """``(batch, inward, x, y, z)`` to ``(batch, outward, ...)``."""
        return self.ramp(self.norm(self.mix(volume)))


class JointHeads(nn.Module):
    """A linear map in every voxel that answers for each joint, of which only those that are asked for are computed.

    Args:
        inward: Channels that come in.
        joints: Joints in all.
        each: Channels for a joint.
    """

    def __init__(self, inward: int, joints: int, each: int) -> None:
        super().__init__()
        whole = nn.Linear(inward, joints * each)
        self.each = each
        self.weight = nn.Parameter(whole.weight.detach().unflatten(0, (joints, each)))
        self.bias = nn.Parameter(whole.bias.detach().unflatten(0, (joints, each)))

    def forward(self, volume: Tensor, asked: Tensor) -> Tensor:
        """``(batch, inward, x, y, z)`` to ``(batch, asked joints, each, x, y, z)``.

        Args:
            volume: What comes in.
            asked: Numbers of the joints, ``(asked joints,)``.
        """
        weight, bias = self.weight[asked].flatten(0, 1), self.bias[asked].flatten()
        answer = weight @ volume.flatten(2) + bias[:, None]
        return answer.view(answer.shape[0], -1, self.each, *volume.shape[2:])
