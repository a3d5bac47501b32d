"""The deterministic head: the encoder of Characteristic 3D Poses with one pose as its answer, no heatmap, no sampling.

Paper: Diller, Funkhouser, Dai, "Forecasting Characteristic 3D Poses of Human Actions", CVPR 2022, Table 3.3 ("MLP
head"). A recurrent unit reads each joint's path; the joints attend to one another (Eq. 3.1); a perceptron makes of each
joint's token how far the joint goes from where it is. The paper gives no sizes of its head.

Shapes: B histories, T frames, J joints, d width.
"""

from __future__ import annotations

from dataclasses import dataclass

import torch
from torch import Tensor, nn

from motioncast.nn.losses import mean_distance


@dataclass(frozen=True)
class GoalHeadConfig:
    """Sizes of the model.

    Attributes:
        skeleton: Name of the skeleton.
        joints: Joints, J.
        history: Frames read, T.
        fps: Frames a second.
        width: Features of a token, d.
        dropout: Share of dropped features in training.
    """

    skeleton: str = "h36m17"
    joints: int = 17
    history: int = 10
    fps: float = 30.0
    width: int = 64
    dropout: float = 0.25


class GoalHead(nn.Module):
    """A history around the hip in, one characteristic pose around the hip out."""

    def __init__(self, config: GoalHeadConfig) -> None:
        super().__init__()
        self.config, width = config, config.width
        self.read = nn.GRU(3, width, batch_first=True)
        self.place = nn.Parameter(torch.randn(config.joints, width) * 0.1)
        self.attend = nn.MultiheadAttention(width, 1, dropout=config.dropout, batch_first=True)
        self.norm = nn.LayerNorm(width)
        self.answer = nn.Sequential(
            nn.Linear(2 * width, 2 * width), nn.ReLU(), nn.Dropout(config.dropout), nn.Linear(2 * width, 3)
        )

    def forward(self, history: Tensor) -> Tensor:
        """The pose, ``(B, J, 3)`` metres, from a history ``(B, T, J, 3)`` metres, each frame around its hip."""
        paths = history.transpose(1, 2).flatten(0, 1)  # B J, T, 3
        tokens = self.read(paths)[1][0].view(-1, self.config.joints, self.config.width) + self.place
        gathered = self.norm(tokens + self.attend(tokens, tokens, tokens, need_weights=False)[0])
        return history[:, -1] + self.answer(torch.cat([tokens, gathered], -1))

    def loss(self, history: Tensor, future: Tensor, seen: Tensor, step: Tensor) -> Tensor:
        """Mean distance of the joints from the pose in frame ``step`` of the future (``training.goal_baselines``)."""
        target = future[torch.arange(len(step)), step]
        target = target - target[:, :1]
        return mean_distance(self(around_hip(history)), target, torch.ones_like(target[..., 0], dtype=torch.bool))

    def goals(self, history: Tensor) -> Tensor:
        """One goal, ``(B, 1, J, 3)`` metres around the hip."""
        return self(around_hip(history))[:, None]


def around_hip(motion: Tensor) -> Tensor:
    """Each frame of a motion ``(..., J, 3)`` around its own hip, joint 0."""
    return motion - motion[..., :1, :]


MODEL, CONFIG = GoalHead, GoalHeadConfig
