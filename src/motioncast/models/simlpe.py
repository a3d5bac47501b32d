"""siMLPe: the DCT of the history through layers that mix time, and nothing else.

Paper: Guo, Du, Shen, Lepetit, Alameda-Pineda, Moreno-Noguer, "Back to MLP: A Simple Baseline for Human Motion
Prediction", 2023.

The history's DCT coefficients pass a linear layer over coordinates, blocks that mix coefficients by one linear layer
and a normalisation over coordinates, and a linear layer over coordinates; the inverse DCT of the result, a motion as
long as the history, is read from its start as the change from the last pose (Sec. 3). There is no activation.
A longer horizon is answered in steps: the answer is appended, the oldest frames are dropped, and the network is asked
again (Sec. 4.2). The network and its loss are the paper's. What differs here:

- The paper's poses are hip-centred. Ours are seen in the person's own frame, pelvis and heading in the last frame of
  each step's history. So the path is forecast too.
- The paper answers 10 frames of 50 a step, trains on one step and rolls on at test. So do we, since own frames make
  all steps alike; ``trained_steps`` can say otherwise. From 15 frames to 45, steps of 15 are good; from 25 to 25, one
  of 25: as long as the history, which is all that its inverse DCT has.
- A later state of the release adds the input of the blocks to their result once more; the paper does not.

Shapes: B scenes, H history, F horizon, P people, J joints.
"""

from __future__ import annotations

from dataclasses import dataclass

import torch
from torch import Tensor, nn

from motioncast.core.skeletons import SKELETONS
from motioncast.nn.dct import dct_matrix
from motioncast.nn.folding import fold, unfold
from motioncast.nn.frames import stand, to_own, to_world
from motioncast.nn.gaps import fill_gaps
from motioncast.nn.losses import mean_distance


@dataclass(frozen=True)
class SiMLPeConfig:
    """Sizes of the model.

    Attributes:
        skeleton: Name of the skeleton.
        history: Frames read (the paper: 50).
        horizon: Frames answered.
        fps: Frames a second.
        blocks: Time-mixing blocks.
        step: Frames answered at once, at most ``history`` (the paper: 10).
        trained_steps: Steps that training answers, at most (the paper: 1).
    """

    skeleton: str = "mrt15"
    history: int = 15
    horizon: int = 45
    fps: float = 15.0
    blocks: int = 48
    step: int = 15
    trained_steps: int = 1


class TimeMixing(nn.Module):
    """A linear layer over time and a normalisation over coordinates, added to the input (Eq. 5)."""

    def __init__(self, frames: int, coordinates: int) -> None:
        super().__init__()
        self.mix = nn.Linear(frames, frames)
        self.norm = nn.LayerNorm(coordinates)
        nn.init.xavier_uniform_(self.mix.weight, gain=1e-8)
        nn.init.zeros_(self.mix.bias)

    def forward(self, features: Tensor) -> Tensor:
        """Features ``(N, frames, coordinates)``, changed."""
        return features + self.norm(self.mix(features.transpose(1, 2)).transpose(1, 2))


class SiMLPe(nn.Module):
    """World-frame history with masks in; world-frame future of each person, from its own history alone, out."""

    dct: Tensor

    def __init__(self, config: SiMLPeConfig) -> None:
        super().__init__()
        self.config = config
        self.skeleton = SKELETONS[config.skeleton]
        coordinates = 3 * len(self.skeleton)
        self.enter = nn.Linear(coordinates, coordinates)
        self.blocks = nn.Sequential(*(TimeMixing(config.history, coordinates) for _ in range(config.blocks)))
        self.leave = nn.Linear(coordinates, coordinates)
        nn.init.xavier_uniform_(self.leave.weight, gain=1e-8)  # untrained, the model repeats the last pose
        nn.init.zeros_(self.leave.bias)
        self.register_buffer("dct", dct_matrix(config.history), persistent=False)

    def forward(self, history: Tensor, observed: Tensor) -> Tensor:
        """The future of all people.

        Args:
            history: ``(B, H, P, J, 3)`` metres, world, z up.
            observed: ``(B, H, P, J)`` bool.

        Returns:
            ``(B, F, P, J, 3)`` metres, world; in training only the frames of the trained steps.
        """
        config = self.config
        frames = fill_gaps(history, observed)
        needed = -(-config.horizon // config.step)
        steps = min(needed, config.trained_steps) if self.training else needed
        for _ in range(steps):
            frames = torch.cat([frames, self.next_frames(frames[:, -config.history :])], 1)
        return frames[:, config.history : config.history + config.horizon]

    def next_frames(self, history: Tensor) -> Tensor:
        """The next ``step`` frames, ``(B, step, P, J, 3)``."""
        origin, heading = stand(history[:, -1], self.skeleton)
        own = to_own(history, origin, heading)
        # a bf16 network would see joints a centimetre from where they are; it is small enough to do without
        with torch.autocast(history.device.type, enabled=False):
            coefficients = self.dct @ fold(own).transpose(1, 2)
            change = self.dct.T @ self.leave(self.blocks(self.enter(coefficients)))
        change = unfold(change[:, : self.config.step].transpose(1, 2), history.shape[2])
        return to_world(own[:, -1:] + change, origin, heading)

    def loss(self, answer: Tensor, truth: Tensor, observed: Tensor) -> Tensor:
        """Mean distance of the joints plus mean distance of their steps from frame to frame (Eq. 7-9)."""
        truth, observed = truth[:, : answer.shape[1]], observed[:, : answer.shape[1]]
        both = observed[:, 1:] & observed[:, :-1]
        return mean_distance(answer, truth, observed) + mean_distance(answer.diff(dim=1), truth.diff(dim=1), both)


MODEL, CONFIG = SiMLPe, SiMLPeConfig
