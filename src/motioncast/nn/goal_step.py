"""Which frame of a forecast is the characteristic one: a head that trajectory models need to answer with a pose.

Diller, Funkhouser and Dai (CVPR 2022), appendix, give such a head to each of their baselines. That of DLow makes ten
features of each forecast frame and a score of each frame from all of them; LTD's and HisRep's read the features of the
last graph convolution. Here one head serves all three: DLow's.

Shapes: N forecasts, F frames, J joints.
"""

from __future__ import annotations

import torch
from torch import Tensor, nn
from torch.nn import functional

FEATURES = 10
"""Of each frame."""


class GoalStep(nn.Module):
    """Scores of the frames of a forecast.

    Args:
        frames: Frames of a forecast, F.
        joints: Joints, J.

    Example:
        >>> GoalStep(100, 17)(torch.zeros(2, 100, 17, 3)).shape
        torch.Size([2, 100])
    """

    def __init__(self, frames: int, joints: int) -> None:
        super().__init__()
        self.features = nn.Linear(3 * joints, FEATURES)
        self.scores = nn.Linear(frames * FEATURES, frames)

    def forward(self, poses: Tensor) -> Tensor:
        """Scores ``(N, F)`` from poses around their hips, ``(N, F, J, 3)`` metres."""
        return self.scores(torch.relu(self.features(poses.flatten(2))).flatten(1))

    def loss(self, poses: Tensor, step: Tensor) -> Tensor:
        """Cross entropy against the true frame, ``(N,)`` from 0."""
        return functional.cross_entropy(self(poses), step)

    def pick(self, poses: Tensor) -> Tensor:
        """The pose in the frame of the highest score, ``(N, J, 3)``."""
        return poses[torch.arange(len(poses)), self(poses).argmax(1)]
