"""HisRep (HRI): motion attention over the history, then LTD's graph network.

Paper: Mao, Liu, Salzmann, "History Repeats Itself: Human Motion Prediction via Motion Attention", 2020.

The last M frames ask which earlier M frames were like them (two convolutions each for query and keys); the DCT of the
M + S frames that begin there is averaged with the answers as weights, not a softmax but shares of the sum (Sec. 3.1);
a graph network changes the DCT of the last M frames, padded over the next S, given that average (Sec. 3.2). A longer
horizon is answered in steps of S frames, and the answer becomes history (Sec. 3.1). The network is the paper's. What
differs here:

- The paper's poses are joint angles or hip-centred positions. Ours are seen in the person's own frame: every
  sub-sequence, and the last frames too, from pelvis and heading at the end of its first M frames. A motion that is
  repeated elsewhere, or in another direction, is a repetition.
- Earlier frames must hold M + S frames. The paper has 50 frames at 25 fps, M = S = 10, where the kernels of the two
  convolutions are 6 and 5. Good at 15 frames to 45 at 15 fps are M = 5 and S = 9 (two sub-sequences to begin with,
  five steps), at 25 to 25 at 25 fps M = 8 and S = 13 (five sub-sequences, two steps).
- The paper trains on one step and rolls on at test. So do we by default, since own frames make all steps alike;
  ``trained_steps`` says how many are trained on.
- The loss prints a square and is called MPJPE, which has none; the release has none, and neither has ours. It counts
  the M frames of history as well as the future, as in the paper.

Shapes: B scenes, H history, F horizon, P people, J joints, M kernel, S step, C coefficients, d width.
"""

from __future__ import annotations

from dataclasses import dataclass

import torch
from torch import Tensor, nn

from motioncast.core.skeletons import SKELETONS
from motioncast.nn.dct import dct_matrix, exact
from motioncast.nn.folding import fold, unfold
from motioncast.nn.frames import stand, to_own, to_world
from motioncast.nn.gaps import fill_gaps
from motioncast.nn.graph import GraphNetwork
from motioncast.nn.reconstruction import with_reconstruction


@dataclass(frozen=True)
class HisRepConfig:
    """Sizes of the model; width, blocks and dropout are the paper's.

    Attributes:
        skeleton: Name of the skeleton.
        history: Frames read (the paper: 50), at least ``kernel + step``.
        horizon: Frames answered.
        fps: Frames a second.
        kernel: Frames M of a query or key (the paper: 10).
        step: Frames S answered at once (the paper: 10).
        coefficients: DCT coefficients C of M + S frames that are kept (the paper: all 20).
        width: Channels d of queries and keys and features of a node.
        blocks: Residual blocks of the graph network.
        dropout: Share of dropped features in training.
        trained_steps: Steps that training answers, at most (the paper: 1).
    """

    skeleton: str = "mrt15"
    history: int = 15
    horizon: int = 45
    fps: float = 15.0
    kernel: int = 5
    step: int = 9
    coefficients: int = 14
    width: int = 256
    blocks: int = 12
    dropout: float = 0.3
    trained_steps: int = 1


class HisRep(nn.Module):
    """World-frame history with masks in; world-frame future of each person, from its own history alone, out."""

    dct: Tensor

    def __init__(self, config: HisRepConfig) -> None:
        super().__init__()
        self.config = config
        self.skeleton = SKELETONS[config.skeleton]
        if config.history < config.kernel + config.step:
            raise ValueError(
                f"history of {config.history} frames holds no sub-sequence of {config.kernel} + {config.step}; "
                "shorten kernel or step"
            )
        coordinates = 3 * len(self.skeleton)
        self.query = describe(coordinates, config.width, config.kernel)
        self.key = describe(coordinates, config.width, config.kernel)
        self.network = GraphNetwork(coordinates, 2 * config.coefficients, config.width, config.blocks, config.dropout)
        dct = dct_matrix(config.kernel + config.step)[: config.coefficients]
        self.register_buffer("dct", dct, persistent=False)

    def forward(self, history: Tensor, observed: Tensor) -> Tensor | list[Tensor]:
        """The future of all people.

        Args:
            history: ``(B, H, P, J, 3)`` metres, world, z up.
            observed: ``(B, H, P, J)`` bool.

        Returns:
            ``(B, F, P, J, 3)`` metres, world. In training a list: how far each step's M frames of history were
            missed, ``(B, steps * M, P, J, 3)``, and the future as far as the trained steps go.
        """
        config = self.config
        frames = fill_gaps(history, observed)
        needed = -(-config.horizon // config.step)
        steps = min(needed, config.trained_steps) if self.training else needed
        missed = []
        for number in range(steps):
            repeated = self.attend(frames, config.history + number * config.step)
            error, future = self.next_frames(frames[:, -config.kernel :], repeated)
            missed.append(error)
            frames = torch.cat([frames, future], 1)
        future = frames[:, config.history : config.history + config.horizon]
        return [torch.cat(missed, 1), future] if self.training else future

    def attend(self, frames: Tensor, length: int) -> Tensor:
        """Coefficients of what followed when the last frames were alike, ``(B * P, 3 J, C)`` (Eq. 2-4).

        Args:
            frames: Motion so far, ``(B, length, P, J, 3)``.
            length: Its frames.
        """
        kernel, whole = self.config.kernel, self.config.kernel + self.config.step
        starts = torch.arange(length - whole + 1, device=frames.device)
        index = starts[:, None] + torch.arange(whole, device=frames.device)
        pieces = frames[:, index].permute(0, 2, 3, 1, 4, 5).flatten(2, 3)  # B, M + S, P * starts, J, 3
        earlier, _, _ = self.own(pieces)
        now, _, _ = self.own(frames[:, -kernel:])
        keys = self.key(earlier[..., :kernel]).view(-1, len(starts), self.config.width)
        values = exact(earlier, self.dct.T).view(keys.shape[0], len(starts), -1)
        scores = (keys @ self.query(now)).float() + 1e-15  # shares of nothing are equal shares
        shares = scores / scores.sum(1, keepdim=True)
        return exact(shares.transpose(1, 2), values).view(now.shape[0], now.shape[1], -1)

    def next_frames(self, history: Tensor, repeated: Tensor) -> tuple[Tensor, Tensor]:
        """How far the last M frames are missed, and the next S frames, ``(B, S, P, J, 3)``."""
        kernel = self.config.kernel
        padded = torch.cat([history, history[:, -1:].expand(-1, self.config.step, -1, -1, -1)], 1)
        own, origin, heading = self.own(padded)
        coefficients = self.network(torch.cat([exact(own, self.dct.T), repeated], -1))
        whole = exact(coefficients[..., : self.config.coefficients], self.dct)
        people = history.shape[2]
        missed = unfold((whole - own)[..., :kernel], people)
        return missed, to_world(unfold(whole[..., kernel:], people), origin, heading)

    def own(self, motion: Tensor) -> tuple[Tensor, Tensor, Tensor]:
        """Trajectories ``(B * P, 3 J, T)`` in the person's frame after M frames, and that frame."""
        origin, heading = stand(motion[:, self.config.kernel - 1], self.skeleton)
        return fold(to_own(motion, origin, heading)), origin, heading

    def loss(self, answer: list[Tensor], truth: Tensor, observed: Tensor) -> Tensor:
        """Mean distance of the joints over the last frames of history and the future (Eq. 6)."""
        return with_reconstruction(answer, truth, observed)


def describe(coordinates: int, width: int, kernel: int) -> nn.Sequential:
    """Two convolutions that make of M frames one non-negative vector: ``(N, 3 J, M)`` to ``(N, d, 1)``."""
    first = kernel // 2 + 1
    return nn.Sequential(
        nn.Conv1d(coordinates, width, first, bias=False),
        nn.ReLU(),
        nn.Conv1d(width, width, kernel - first + 1, bias=False),
        nn.ReLU(),
    )


MODEL, CONFIG = HisRep, HisRepConfig
