"""In the spirit of FutureMotion, of which no code and few facts are public: not to be quoted as its result.

After: Wang et al., "Simple Baseline for Single Human Motion Forecasting", 2021, winner of the SoMoF challenge.
Known: LTD's graph network, with a joint and not a coordinate as a node; single persons; training on more data, played
backwards too. Ours: the sizes, the own frame, the loss.

Shapes: B scenes, H history, F horizon, P people, J joints, C coefficients.
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
from motioncast.nn.losses import mean_distance


@dataclass(frozen=True)
class FutureMotionLikeConfig:
    """Sizes of the model.

    Attributes:
        skeleton: Name of the skeleton.
        history: Frames read.
        horizon: Frames answered.
        fps: Frames a second.
        width: Features of a joint.
        blocks: Residual blocks of two graph convolutions each.
        coefficients: DCT coefficients C of a trajectory that are kept.
        dropout: Share of dropped features in training.
    """

    skeleton: str = "mrt15"
    history: int = 15
    horizon: int = 45
    fps: float = 15.0
    width: int = 128
    blocks: int = 6
    coefficients: int = 30
    dropout: float = 0.1


class FutureMotionLike(nn.Module):
    """World-frame history with masks in; world-frame future of each person, from its own history alone, out."""

    dct: Tensor

    def __init__(self, config: FutureMotionLikeConfig) -> None:
        super().__init__()
        self.config = config
        self.skeleton = SKELETONS[config.skeleton]
        features = 3 * config.coefficients
        self.network = GraphNetwork(len(self.skeleton), features, config.width, config.blocks, config.dropout)
        dct = dct_matrix(config.history + config.horizon)[: config.coefficients]
        self.register_buffer("dct", dct, persistent=False)

    def forward(self, history: Tensor, observed: Tensor) -> Tensor:
        """The future of all people, ``(B, F, P, J, 3)`` metres, world.

        Args:
            history: ``(B, H, P, J, 3)`` metres, world, z up.
            observed: ``(B, H, P, J)`` bool.
        """
        history = fill_gaps(history, observed)
        origin, heading = stand(history[:, -1], self.skeleton)
        own = to_own(history, origin, heading)
        padded = torch.cat([own, own[:, -1:].expand(-1, self.config.horizon, -1, -1, -1)], 1)
        coefficients = exact(fold(padded), self.dct.T)  # B * P, 3 J, C
        joints = coefficients.view(-1, len(self.skeleton), 3 * self.config.coefficients)
        change = (self.network(joints) - joints).view(-1, 3 * len(self.skeleton), self.config.coefficients)
        change = unfold(exact(change, self.dct[:, self.config.history :]), history.shape[2])
        return to_world(own[:, -1:] + change, origin, heading)

    def loss(self, answer: Tensor, truth: Tensor, observed: Tensor) -> Tensor:
        """Mean distance of the joints."""
        return mean_distance(answer, truth, observed)


MODEL, CONFIG = FutureMotionLike, FutureMotionLikeConfig
