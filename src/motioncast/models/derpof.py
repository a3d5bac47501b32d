"""DeRPoF: the path of the hips and the pose about them, forecast apart; each person alone.

Paper: Parsaeifard, Saadatnejad, Liu, Mordan, Alahi, "Learning Decoupled Representations for Human Pose Forecasting",
2021, Sec. 3.

Steps from frame to frame are split into those of the middle of the hips, the path, and what the joints do besides,
the pose. An LSTM encoder-decoder goes on with the path. A variational auto-encoder goes on with the pose: an LSTM of
two layers sums the steps up as a normal distribution, and an LSTM decoder begins with a sample of it. Both decoders
are fed their own last step; the answer is the last pose plus the sum of the steps. Sizes, dropout and the weights of
the loss are the public code's, whose 133,962 parameters at 13 joints these are.

What differs here:

- Theirs draws from the distribution also when it is tested, so that two runs differ. Ours draws in training and
  answers with the mean.
- Theirs sums the divergence from the prior over the batch, so that its weight grows with the batch. Ours takes the
  mean over people.
- Where there is a pelvis, it is one of the joints; the path is that of the hips all the same.

Nothing is centred: steps do not depend on where a person is. They do depend on which way is north.

Shapes: B scenes, H history, F horizon, P people, J joints, N = B P.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import torch
from torch import Tensor, nn

from motioncast.core.skeletons import SKELETONS
from motioncast.nn.frames import side_joints
from motioncast.nn.gaps import fill_gaps
from motioncast.nn.losses import mean_over

POSE_WEIGHT = 0.1
"""Weight of the pose's loss beside the path's."""

DIVERGENCE_WEIGHT = 0.01
"""Weight of the divergence from the prior within the pose's loss."""


@dataclass(frozen=True)
class DeRPoFConfig:
    """Sizes of the model.

    Attributes:
        skeleton: Name of the skeleton.
        history: Frames read.
        horizon: Frames answered.
        fps: Frames a second.
        embedding: Channels of a step of the path.
        hidden: Channels of the LSTMs.
        latent: Channels of the pose's distribution.
        dropout: Share of channels dropped between the layers of the pose's encoder in training.
    """

    skeleton: str = "mrt15"
    history: int = 15
    horizon: int = 45
    fps: float = 15.0
    embedding: int = 8
    hidden: int = 64
    latent: int = 32
    dropout: float = 0.2


class Answer(NamedTuple):
    """What the loss needs of an answer.

    Attributes:
        last: The last pose seen, ``(B, 1, P, J, 3)``.
        path: Steps of the middle of the hips, ``(B, F, P, 1, 3)``.
        pose: Steps of the joints beside those of the path, ``(B, F, P, J, 3)``.
        mean: Mean of the distribution, ``(B, P, latent)``.
        log_variance: Logarithm of its variance, ``(B, P, latent)``.
    """

    last: Tensor
    path: Tensor
    pose: Tensor
    mean: Tensor
    log_variance: Tensor


class PathModel(nn.Module):
    """An LSTM encoder-decoder of the steps of a point.

    Args:
        config: Sizes.
    """

    def __init__(self, config: DeRPoFConfig) -> None:
        super().__init__()
        self.horizon = config.horizon
        self.embed = nn.Sequential(nn.Linear(3, config.embedding), nn.Tanh())
        self.encoder = nn.LSTM(config.embedding, config.hidden)
        self.decoder = nn.LSTM(config.embedding, config.hidden)
        self.step = nn.Linear(config.hidden, 3)

    def forward(self, steps: Tensor) -> Tensor:
        """Steps ``(H - 1, N, 3)`` to come, ``(F, N, 3)``."""
        _, state = self.encoder(self.embed(steps))
        step, answer = steps[-1:], []
        for _ in range(self.horizon):
            hidden, state = self.decoder(self.embed(step), state)
            step = self.step(hidden)
            answer.append(step)
        return torch.cat(answer)


class PoseModel(nn.Module):
    """A variational auto-encoder of the steps of a pose.

    Args:
        config: Sizes.
        coordinates: 3 J.
    """

    def __init__(self, config: DeRPoFConfig, coordinates: int) -> None:
        super().__init__()
        self.horizon = config.horizon
        self.encoder = nn.LSTM(coordinates, config.hidden, num_layers=2, dropout=config.dropout)
        self.mean = nn.Linear(config.hidden, config.latent)
        self.log_variance = nn.Linear(config.hidden, config.latent)
        self.begin = nn.Linear(config.latent, config.hidden)
        self.decoder = nn.LSTM(coordinates, config.hidden)
        self.step = nn.Linear(config.hidden, coordinates)

    def forward(self, steps: Tensor) -> tuple[Tensor, Tensor, Tensor]:
        """Steps ``(H - 1, N, 3 J)`` to come, ``(F, N, 3 J)``, with mean and log variance ``(N, latent)``."""
        summary = self.encoder(steps)[0][-1]
        mean, log_variance = self.mean(summary), self.log_variance(summary)
        sample = mean + torch.randn_like(mean) * (log_variance / 2).exp() if self.training else mean
        hidden = self.begin(sample)[None]
        state = hidden, torch.zeros_like(hidden)
        step, answer = steps[-1:], []
        for _ in range(self.horizon):
            hidden, state = self.decoder(step, state)
            step = self.step(hidden)
            answer.append(step)
        return torch.cat(answer), mean, log_variance


class DeRPoF(nn.Module):
    """World-frame history with masks in; world-frame future of each person, from its own history alone, out."""

    def __init__(self, config: DeRPoFConfig) -> None:
        super().__init__()
        self.config = config
        skeleton = SKELETONS[config.skeleton]
        self.hips = list(side_joints(skeleton)[0])
        self.path = PathModel(config)
        self.pose = PoseModel(config, 3 * len(skeleton))

    def forward(self, history: Tensor, observed: Tensor) -> Tensor | Answer:
        """The future of all people.

        Args:
            history: ``(B, H, P, J, 3)`` metres, world, z up.
            observed: ``(B, H, P, J)`` bool.

        Returns:
            ``(B, F, P, J, 3)`` metres, world; in training what the loss needs.
        """
        frames = fill_gaps(history, observed)
        steps = (frames[:, 1:] - frames[:, :-1]).transpose(0, 1)
        path = steps[..., self.hips, :].mean(3, keepdim=True)
        size = steps.shape[1:]
        # a bf16 network would round every step; it is small enough to do without
        with torch.autocast(history.device.type, enabled=False):
            path_answer = self.path(path.flatten(1, 3))
            pose_answer, mean, log_variance = self.pose((steps - path).flatten(3).flatten(1, 2))
        path_answer = path_answer.view(-1, size[0], size[1], 1, 3).transpose(0, 1)
        pose_answer = pose_answer.view(-1, *size).transpose(0, 1)
        if self.training:
            people = mean.view(size[0], size[1], -1), log_variance.view(size[0], size[1], -1)
            return Answer(frames[:, -1:], path_answer, pose_answer, *people)
        return frames[:, -1:] + (path_answer + pose_answer).cumsum(1)

    def loss(self, answer: Answer, truth: Tensor, observed: Tensor) -> Tensor:
        """Squared error of the path's steps, error of the pose's and divergence of its distribution.

        The path's is the mean over coordinates, the pose's the length of the vector of all coordinates of a pose;
        both are means over frames. The divergence is that of Kullback and Leibler from a standard normal
        distribution, mean over people.
        """
        steps = torch.cat([answer.last, truth], 1).diff(dim=1)
        seen = torch.cat([observed[:, :1], observed[:, 1:] & observed[:, :-1]], 1)
        hips_seen = seen[..., self.hips].all(-1)
        path = steps[..., self.hips, :].mean(3, keepdim=True)
        path_loss = mean_over((answer.path - path).square().mean((3, 4)), hips_seen)
        off = (answer.pose - (steps - path)).square().sum(-1) * seen
        # a tiny constant keeps the gradient finite where the error is zero
        pose_loss = mean_over((off.sum(-1) + 1e-8).sqrt(), hips_seen)
        spread = answer.log_variance.exp() + answer.mean.square() - 1 - answer.log_variance
        divergence = mean_over(spread.sum(-1) / 2, hips_seen.any(1))
        return path_loss + POSE_WEIGHT * (pose_loss + DIVERGENCE_WEIGHT * divergence)


MODEL, CONFIG = DeRPoF, DeRPoFConfig
