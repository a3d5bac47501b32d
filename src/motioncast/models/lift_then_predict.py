"""A baseline of FutureHuman3D: poses are lifted to 3D one by one, and the next lifted pose is learnt from.

In the spirit of what the paper compares with (RepNet of Wandt and Rosenhahn 2019, and a forecaster of its 3D poses):
the lifter sees one 2D pose, and learns by its projection and the critic; the forecaster is FutureHuman3D's network, and
learns by the distance to the lifted pose of the next step, which is told nothing of the past.
"""

from __future__ import annotations

import torch
from torch import Tensor, nn

from motioncast.core.skeletons import UPPER9
from motioncast.core.upper_body import NECK
from motioncast.models.futurehuman3d import UNIT_M, FutureHuman3D, FutureHuman3DConfig, Past, ResidualBlock, Step


class LiftThenPredict(FutureHuman3D):
    """FutureHuman3D whose poses are taught by a lifter instead of by the image and the critic."""

    def __init__(self, config: FutureHuman3DConfig) -> None:
        super().__init__(config)
        wide, joints = config.pose_width, len(UPPER9)
        self.lifter = nn.Sequential(nn.Linear(3 * joints, wide), *(ResidualBlock(wide) for _ in "12"))
        self.lifted = nn.Linear(wide, 3 * joints)

    def start_from(self, pose: Tensor) -> None:
        """As FutureHuman3D does; the lifter answers the pose, too."""
        super().start_from(pose)
        with torch.no_grad():
            self.lifted.bias.copy_(pose.flatten())

    def lift(self, past: Past, pixels: Tensor, seen: Tensor) -> Step:
        """The poses of one step ``(B, P, J, 2)``, in 3D and again in the image."""
        _, scale = self.view(past)
        offsets = (pixels - pixels[:, :, NECK : NECK + 1]) * scale[:, :, None] * seen[..., None]
        told = torch.cat([offsets, seen[..., None].to(offsets.dtype)], -1).flatten(2)
        poses = self.lifted(self.lifter(told)).unflatten(-1, (len(UPPER9), 3))
        return self.in_image(past, poses - poses[:, :, NECK : NECK + 1])

    def pose_loss(self, step: Step, past: Past, pixels: Tensor, seen: Tensor) -> Tensor:
        """The lifter's losses, and the distance of the answer to the lifted pose."""
        lifted = self.lift(past, pixels, seen)
        distance = ((step.poses - lifted.poses.detach()) / UNIT_M).square().sum(-1).mean()
        return super().pose_loss(lifted, past, pixels, seen) + self.config.pose_weight * distance

    def made(self, past: Past, noise: Tensor, pixels: Tensor, seen: Tensor) -> Tensor:
        """The lifted poses: it is the lifter that the critic teaches."""
        return self.lift(past, pixels, seen).poses.flatten(0, 1)


MODEL, CONFIG = LiftThenPredict, FutureHuman3DConfig
