"""LTD: trajectories as DCT coefficients, a graph network over all coordinates.

Paper: Mao, Liu, Salzmann, Li, "Learning Trajectory Dependencies for Human Motion Prediction", 2019.

The history is padded with its last pose over the horizon; each coordinate's trajectory is one node that holds its
DCT coefficients (Sec. 3.1); a graph network with learned edges changes them (Sec. 3.2, 3.3); one pass answers all
frames. The network is the paper's. What differs here:

- The paper's poses are joint angles or hip-centred positions. Ours are positions in the person's own frame: pelvis
  and heading in the last frame of history. So the path is forecast too.
- The loss prints a square and is called MPJPE, which has none; the release has none, and neither has ours. It counts
  the frames of history as well as those of the future, as in the paper.
- The release keeps 15 of 20 coefficients for short horizons; the default here keeps all.

Shapes: B scenes, H history, F horizon, P people, J joints.
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
class LTDConfig:
    """Sizes of the model; the defaults are the paper's, at 15 frames in and 45 out.

    Attributes:
        skeleton: Name of the skeleton.
        history: Frames read.
        horizon: Frames answered.
        fps: Frames a second.
        width: Features of a node.
        blocks: Residual blocks of two graph convolutions each.
        coefficients: DCT coefficients of a trajectory that are kept; at most history + horizon.
        dropout: Share of dropped features in training.
    """

    skeleton: str = "mrt15"
    history: int = 15
    horizon: int = 45
    fps: float = 15.0
    width: int = 256
    blocks: int = 12
    coefficients: int = 60
    dropout: float = 0.5


class LTD(nn.Module):
    """World-frame history with masks in; world-frame future of each person, from its own history alone, out."""

    dct: Tensor

    def __init__(self, config: LTDConfig) -> None:
        super().__init__()
        self.config = config
        self.skeleton = SKELETONS[config.skeleton]
        self.network = GraphNetwork(
            3 * len(self.skeleton), config.coefficients, config.width, config.blocks, config.dropout
        )
        dct = dct_matrix(config.history + config.horizon)[: config.coefficients]
        self.register_buffer("dct", dct, persistent=False)

    def forward(self, history: Tensor, observed: Tensor) -> Tensor | list[Tensor]:
        """The future of all people.

        Args:
            history: ``(B, H, P, J, 3)`` metres, world, z up.
            observed: ``(B, H, P, J)`` bool.

        Returns:
            ``(B, F, P, J, 3)`` metres, world. In training a list: how far the history was missed,
            ``(B, H, P, J, 3)``, and the future.
        """
        history = fill_gaps(history, observed)
        origin, heading = stand(history[:, -1], self.skeleton)
        own = to_own(history, origin, heading)
        padded = torch.cat([own, own[:, -1:].expand(-1, self.config.horizon, -1, -1, -1)], 1)
        coefficients = self.network(exact(fold(padded), self.dct.T))
        whole = unfold(exact(coefficients, self.dct), history.shape[2])
        future = to_world(whole[:, self.config.history :], origin, heading)
        return [whole[:, : self.config.history] - own, future] if self.training else future

    def loss(self, answer: list[Tensor], truth: Tensor, observed: Tensor) -> Tensor:
        """Mean distance of the joints over history and future (Eq. 7)."""
        return with_reconstruction(answer, truth, observed)


MODEL, CONFIG = LTD, LTDConfig
