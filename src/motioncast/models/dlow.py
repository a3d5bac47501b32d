"""DLow: ten futures from one latent draw, made to differ, as ten characteristic poses.

Papers: Yuan, Kitani, "DLow: Diversifying Latent Flows for Diverse Human Motion Prediction", ECCV 2020; as a baseline
with a head for the frame: Diller, Funkhouser, Dai, "Forecasting Characteristic 3D Poses of Human Actions", CVPR 2022.

A variational autoencoder learns futures given their history (Sec. 3.1): recurrent units read both, another writes the
future frame by frame. Then it is frozen, and a perceptron makes of the history ten affine maps of one Gaussian draw
(Eq. 3): ten latent codes, trained so that one of the futures is right and their poses lie apart (Eq. 8-10). A head
picks the frame of each. What differs here:

- Sizes are small, the maps diagonal (theirs are full matrices), and a frame is written as a change of the one before.
- The codes have no order; the first future is called the most likely one only because something must be.

Shapes: B histories, T frames, F frames of the future, K futures, J joints, z code, h width.
"""

from __future__ import annotations

from dataclasses import dataclass

import torch
from torch import Tensor, nn

from motioncast.models.goal_head import around_hip
from motioncast.nn.goal_step import GoalStep


@dataclass(frozen=True)
class DLowConfig:
    """Sizes and weights of the model.

    Attributes:
        skeleton: Name of the skeleton.
        joints: Joints, J.
        history: Frames read, T.
        horizon: Frames forecast, F.
        fps: Frames a second.
        goals: Futures, K.
        width: Features of the recurrent units, h.
        code: Numbers of a latent code, z.
        beta: Weight of the codes' divergence from the Gaussian in the autoencoder (the paper: 0.1).
        spread: Weight of the diversity of the futures (25).
        spread_m: Squared distance of two futures at which the diversity's pull has fallen to 1/e, over frames.
        best: Weight of the error of the best future (2).
        step_weight: Weight of the head's cross entropy.
    """

    skeleton: str = "h36m17"
    joints: int = 17
    history: int = 10
    horizon: int = 100
    fps: float = 30.0
    goals: int = 10
    width: int = 128
    code: int = 32
    beta: float = 0.01
    spread: float = 0.02
    spread_m: float = 0.1
    best: float = 2.0
    step_weight: float = 0.02


class DLow(nn.Module):
    """A history in; ten futures and of each the pose in the frame that the head picks out."""

    def __init__(self, config: DLowConfig) -> None:
        super().__init__()
        self.config, pose, width = config, 3 * config.joints, config.width
        self.past = nn.GRU(pose, width, batch_first=True)
        self.future = nn.GRU(pose, width, batch_first=True)
        self.posterior = nn.Linear(2 * width, 2 * config.code)
        self.start = nn.Linear(width + config.code, width)
        self.write = nn.GRUCell(pose + config.code, width)
        self.change = nn.Linear(width, pose)
        self.maps = nn.Sequential(
            nn.Linear(width, 256), nn.ReLU(), nn.Linear(256, 128), nn.ReLU(),
            nn.Linear(128, 2 * config.goals * config.code),
        )  # fmt: skip
        self.step = GoalStep(config.horizon, config.joints)
        self.sampling = False

    def learn_sampling(self) -> None:
        """Freeze the autoencoder and the head; from here on the maps learn."""
        self.sampling = True
        for name, parameter in self.named_parameters():
            parameter.requires_grad_(name.startswith("maps"))

    def decode(self, history: Tensor, read: Tensor, code: Tensor) -> Tensor:
        """Futures ``(B, F, J, 3)`` around the hip from histories ``(B, T, J, 3)``, what was read of them, and codes."""
        pose = history[:, -1].flatten(1)
        hidden = torch.tanh(self.start(torch.cat([read, code], -1)))
        frames = []
        for _ in range(self.config.horizon):
            hidden = self.write(torch.cat([pose, code], -1), hidden)
            pose = pose + 0.1 * self.change(hidden)
            frames.append(pose)
        return torch.stack(frames, 1).unflatten(2, (-1, 3))

    def sampled(self, history: Tensor, noise: Tensor) -> tuple[Tensor, Tensor, Tensor]:
        """Ten futures of each history.

        Args:
            history: ``(B, T, J, 3)`` metres around the hip.
            noise: One draw of each history, ``(B, z)``; zero gives the middle of each map.

        Returns:
            Futures ``(B, K, F, J, 3)``; scale and shift of the maps, ``(B, K, z)``.
        """
        read = self.past(history.flatten(2))[1][0]
        scale, shift = self.maps(read).view(len(read), 2, self.config.goals, self.config.code).unbind(1)
        codes = (scale * noise[:, None] + shift).flatten(0, 1)
        repeated, known = (values.repeat_interleave(self.config.goals, 0) for values in (history, read))
        return self.decode(repeated, known, codes).unflatten(0, (len(read), -1)), scale, shift

    def loss(self, history: Tensor, future: Tensor, seen: Tensor, step: Tensor) -> Tensor:
        """The autoencoder's loss and the head's; after :meth:`learn_sampling` that of the maps.

        Args:
            history: ``(B, T, J, 3)`` metres, from where somebody stands.
            future: ``(B, F, J, 3)``.
            seen: Frames of it that are known, ``(B, F)``.
            step: The characteristic one, ``(B,)`` from 0.
        """
        history, future = around_hip(history), around_hip(future)
        return self.of_maps(history, future, step) if self.sampling else self.of_codes(history, future, seen, step)

    def of_codes(self, history: Tensor, future: Tensor, seen: Tensor, step: Tensor) -> Tensor:
        """Squared error over seen frames, divergence of the codes, cross entropy of the head."""
        read = self.past(history.flatten(2))[1][0]
        masked = torch.where(seen[..., None, None], future, history[:, -1:])
        told = self.future(masked.flatten(2))[1][0]
        mean, spread = self.posterior(torch.cat([read, told], -1)).chunk(2, -1)
        code = mean + torch.randn_like(mean) * (0.5 * spread).exp()
        answer = self.decode(history, read, code)
        error = ((answer - future).square().sum((-2, -1)) * seen).sum() / seen.sum()
        divergence = -0.5 * (1 + spread - mean.square() - spread.exp()).sum(-1).mean()
        return error + self.config.beta * divergence + self.config.step_weight * self.step.loss(answer, step)

    def of_maps(self, history: Tensor, future: Tensor, step: Tensor) -> Tensor:
        """The best pose's error, how alike the poses are, and the divergence of the codes, all at the true frame."""
        noise = torch.randn(len(history), self.config.code, device=history.device)
        futures, scale, shift = self.sampled(history, noise)
        rows = torch.arange(len(step))
        poses, truth = futures[rows, :, step], future[rows, step]  # B, K, J, 3 and B, J, 3
        error = (poses - truth[:, None]).square().sum((-2, -1)).min(1)[0].mean()
        apart = (poses[:, :, None] - poses[:, None]).square().sum((-2, -1))
        alike = (-apart / self.config.spread_m).exp().mean()
        divergence = 0.5 * (scale.square() + shift.square() - 1 - (scale.square() + 1e-6).log()).sum(-1).mean()
        return self.config.best * error + self.config.spread * alike + 0.1 * self.config.beta * divergence

    def goals(self, history: Tensor) -> Tensor:
        """K goals ``(B, K, J, 3)`` metres around the hip, with the draw at its middle: nothing is left to chance."""
        history = around_hip(history)
        futures, _, _ = self.sampled(history, history.new_zeros(len(history), self.config.code))
        return self.step.pick(futures.flatten(0, 1)).unflatten(0, futures.shape[:2])

    def goals_at(self, history: Tensor, step: Tensor) -> Tensor:
        """The same, told the true frame: ``step`` ``(B,)`` from 0."""
        history = around_hip(history)
        futures, _, _ = self.sampled(history, history.new_zeros(len(history), self.config.code))
        return futures[torch.arange(len(step)), :, step.clamp(max=self.config.horizon - 1)]


MODEL, CONFIG = DLow, DLowConfig
