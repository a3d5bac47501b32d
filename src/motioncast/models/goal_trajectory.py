"""LTD and HisRep (HRI) as forecasters of characteristic poses: the pose in the frame that a head picks of a trajectory.

The baselines of Diller, Funkhouser, Dai, "Forecasting Characteristic 3D Poses of Human Actions", CVPR 2022, Sec. 3.6:
10 frames in, 100 out, and a head that says which of the 100 is the characteristic one, trained jointly. The head is
``nn.goal_step``; the trajectory models are the project's own (``models.ltd``, ``models.hisrep``). HisRep's step is 5
frames, as many as 10 frames of history allow beside its kernel of 5.

Shapes: B histories, T frames, F frames of the future, J joints.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import torch
from torch import Tensor, nn

from motioncast.models.goal_head import around_hip
from motioncast.models.hisrep import HisRep, HisRepConfig
from motioncast.models.ltd import LTD, LTDConfig
from motioncast.nn.goal_step import GoalStep

ROLLED = 8
"""Histories of a batch that HisRep forecasts whole for the head: twenty steps each, ten times the work of training."""


@dataclass(frozen=True)
class GoalTrajectoryConfig:
    """Sizes of the model.

    Attributes:
        system: The trajectory model.
        skeleton: Name of the skeleton.
        joints: Joints, J.
        history: Frames read, T.
        horizon: Frames forecast, F.
        fps: Frames a second.
        width: Features of a node.
        blocks: Residual blocks.
        coefficients: Of LTD's DCT.
        dropout: Share of dropped features in training.
        step_weight: Weight of the head's cross entropy beside the trajectory's mean distance in metres.
    """

    system: Literal["ltd", "hisrep"] = "ltd"
    skeleton: str = "h36m17"
    joints: int = 17
    history: int = 10
    horizon: int = 100
    fps: float = 30.0
    width: int = 64
    blocks: int = 4
    coefficients: int = 30
    dropout: float = 0.3
    step_weight: float = 0.02


class GoalTrajectory(nn.Module):
    """A history in, the pose in the frame of the forecast that the head picks out."""

    def __init__(self, config: GoalTrajectoryConfig) -> None:
        super().__init__()
        self.config = config
        shared = (config.skeleton, config.history, config.horizon, config.fps)
        self.trajectory = (
            LTD(LTDConfig(*shared, config.width, config.blocks, config.coefficients, config.dropout))
            if config.system == "ltd"
            else HisRep(HisRepConfig(*shared, 5, 5, 10, config.width, config.blocks, config.dropout, trained_steps=2))
        )
        self.step = GoalStep(config.horizon, config.joints)

    def forward(self, history: Tensor) -> Tensor:
        """The future ``(B, F, J, 3)`` of a history ``(B, T, J, 3)`` metres."""
        answer = self.trajectory(history[:, :, None], torch.ones_like(history[:, :, None, :, 0], dtype=torch.bool))
        return answer[:, :, 0]

    def loss(self, history: Tensor, future: Tensor, seen: Tensor, step: Tensor) -> Tensor:
        """The trajectory's own loss over frames that were seen, and the head's; see ``training.goal_baselines``."""
        observed = torch.ones_like(history[:, :, None, :, 0], dtype=torch.bool)
        answer = self.trajectory(history[:, :, None], observed)
        frames = answer[-1].shape[1]  # HisRep trains on its first steps alone
        mask = seen[:, :frames, None, None].expand(-1, -1, 1, self.config.joints)
        moved = self.trajectory.loss(answer, future[:, :frames, None], mask)
        if frames == self.config.horizon:
            read, asked = answer[-1][:, :, 0], step
        else:
            read, asked = self.rolled(history[:ROLLED]), step[:ROLLED]
        return moved + self.config.step_weight * self.step.loss(around_hip(read), asked)

    @torch.no_grad()
    def rolled(self, history: Tensor) -> Tensor:
        """The whole future as it is at test, for the head of a model that is trained on its first steps."""
        self.trajectory.eval()
        future = self(history)
        self.trajectory.train()
        return future

    def goals(self, history: Tensor) -> Tensor:
        """One goal, ``(B, 1, J, 3)`` metres around the hip."""
        return self.step.pick(around_hip(self(history)))[:, None]

    def goals_at(self, history: Tensor, step: Tensor) -> Tensor:
        """The same, told the true frame (the paper's Table 3.2): ``step`` ``(B,)`` from 0."""
        future = around_hip(self(history))
        return future[torch.arange(len(step)), step.clamp(max=self.config.horizon - 1)][:, None]


MODEL, CONFIG = GoalTrajectory, GoalTrajectoryConfig
