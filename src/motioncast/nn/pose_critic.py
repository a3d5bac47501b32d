"""A critic that tells real 3D poses from made-up ones, without knowing which pose belongs to which video.

Joints pass one branch. The other sees the kinematic chain: with the bones as columns of B, Psi = B'B holds squared bone
lengths on its diagonal and the angles between bones beside it (RepNet; FutureHuman3D, Sec. 4.4.2 and 4.7.10). It learns
by the Wasserstein distance with a gradient penalty (Gulrajani et al. 2017).
"""

from __future__ import annotations

from itertools import pairwise

import torch
from torch import Tensor, nn

from motioncast.core.skeleton import Skeleton

SCALE_M = 0.3
"""Unit in which poses are read: about the length of a bone."""


class PoseCritic(nn.Module):
    """Scores poses ``(N, J, 3)`` in metres from the root joint: high for real ones.

    Args:
        skeleton: Joints and bones.
        width: Features of a layer.
    """

    def __init__(self, skeleton: Skeleton, width: int = 100) -> None:
        super().__init__()
        self.bones = skeleton.bones
        chain = len(self.bones) ** 2
        self.joints = layers(3 * len(skeleton), *(width,) * 4)
        self.chain = layers(chain, *(width,) * 3)
        self.join = nn.Sequential(nn.Linear(2 * width, width), nn.LeakyReLU(0.2), nn.Linear(width, 1))

    def forward(self, poses: Tensor) -> Tensor:
        """Scores ``(N,)``."""
        poses = poses / SCALE_M
        chain = kinematic_chain(poses, self.bones)
        return self.join(torch.cat([self.joints(poses.flatten(1)), self.chain(chain.flatten(1))], 1))[:, 0]

    def loss(self, real: Tensor, made: Tensor, penalty: float = 10.0) -> Tensor:
        """What the critic lowers: scores of made-up poses over those of real ones, and slopes other than 1 between."""
        share = torch.rand(len(real), 1, 1, device=real.device)
        between = torch.lerp(real, made, share).requires_grad_()
        (slope,) = torch.autograd.grad(self(between).sum(), between, create_graph=True)
        steepness = (slope * SCALE_M).flatten(1).norm(dim=1)
        return self(made).mean() - self(real).mean() + penalty * (steepness - 1).square().mean()


def layers(*widths: int) -> nn.Sequential:
    """Linear layers, each with a leaky ReLU."""
    found: list[nn.Module] = []
    for wide, narrow in pairwise(widths):
        found += [nn.Linear(wide, narrow), nn.LeakyReLU(0.2)]
    return nn.Sequential(*found)


def kinematic_chain(poses: Tensor, bones: tuple[tuple[int, int], ...]) -> Tensor:
    """Psi of poses ``(N, J, 3)``: inner products of all bones, ``(N, bones, bones)``."""
    ends, starts = map(list, zip(*bones, strict=True))
    vectors = poses[:, ends] - poses[:, starts]
    return vectors @ vectors.transpose(1, 2)
