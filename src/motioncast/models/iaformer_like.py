"""In the spirit of IAFormer; facts are few, so it is not to be quoted as its result.

After: "Multi-person pose forecasting with individual interaction perceptron and prior learning" (IAFormer), 2024.
Known: graph networks that encode and decode padded trajectories, and a codebook of 256 learned interaction priors.
Ours: the sizes, people's own frames, DCT over time (the release's is over coordinates), and how the codebook is read:
each pair of people asks it by attention, and the answers of those who are there are averaged.

Shapes: B scenes, H history, F horizon, P people, J joints, C coefficients, d channels.
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
from motioncast.nn.graph import UNIT_M, GraphConvolution, GraphLayer
from motioncast.nn.losses import mean_distance
from motioncast.nn.social import others, whereabouts


@dataclass(frozen=True)
class IAFormerLikeConfig:
    """Sizes of the model.

    Attributes:
        skeleton: Name of the skeleton.
        history: Frames read.
        horizon: Frames answered.
        fps: Frames a second.
        width: Features d of a joint.
        priors: Rows of the codebook.
        coefficients: DCT coefficients C of a trajectory that are kept.
        dropout: Share of dropped features in training.
    """

    skeleton: str = "mrt15"
    history: int = 15
    horizon: int = 45
    fps: float = 15.0
    width: int = 128
    priors: int = 256
    coefficients: int = 30
    dropout: float = 0.1


class IAFormerLike(nn.Module):
    """World-frame history with masks in; world-frame future of all people out."""

    dct: Tensor

    def __init__(self, config: IAFormerLikeConfig) -> None:
        super().__init__()
        self.config = config
        self.skeleton = SKELETONS[config.skeleton]
        joints, features, d = len(self.skeleton), 3 * config.coefficients, config.width
        self.encoder = nn.Sequential(
            GraphLayer(joints, features, d, config.dropout), GraphLayer(joints, d, d, config.dropout)
        )
        self.pair = nn.Sequential(nn.Linear(2 * d + 5, d), nn.GELU(), nn.Linear(d, d))
        self.priors = nn.Parameter(torch.randn(config.priors, d))
        self.tell = nn.Linear(d, d)
        self.decoder = nn.Sequential(GraphLayer(joints, d, d, config.dropout), GraphConvolution(joints, d, features))
        dct = dct_matrix(config.history + config.horizon)[: config.coefficients]
        self.register_buffer("dct", dct, persistent=False)

    def forward(self, history: Tensor, observed: Tensor) -> Tensor:
        """The future of all people, ``(B, F, P, J, 3)`` metres, world.

        Args:
            history: ``(B, H, P, J, 3)`` metres, world, z up.
            observed: ``(B, H, P, J)`` bool.
        """
        people, joints = history.shape[2], len(self.skeleton)
        history = fill_gaps(history, observed)
        origin, heading = stand(history[:, -1], self.skeleton)
        own = to_own(history, origin, heading)
        padded = torch.cat([own, own[:, -1:].expand(-1, self.config.horizon, -1, -1, -1)], 1)
        coefficients = exact(fold(padded), self.dct.T).view(-1, joints, 3 * self.config.coefficients)
        bodies = self.encoder(coefficients)
        persons = bodies.mean(1).view(-1, people, self.config.width)
        messages = self.interaction(persons, whereabouts(origin, heading), others(observed[:, -1].any(-1)))
        change = UNIT_M * self.decoder(bodies + messages.flatten(0, 1)[:, None]).float()
        change = exact(change.view(-1, 3 * joints, self.config.coefficients), self.dct[:, self.config.history :])
        return to_world(own[:, -1:] + unfold(change, people), origin, heading)

    def interaction(self, persons: Tensor, seen: Tensor, there: Tensor) -> Tensor:
        """What the priors say to each person of the others, ``(B, P, d)``; nothing if there is nobody.

        Args:
            persons: ``(B, P, d)``.
            seen: Where person k is for person i, ``(B, P, P, 5)``.
            there: Whether k counts for i, ``(B, P, P)`` bool.
        """
        people = persons.shape[1]
        me = persons[:, :, None].expand(-1, -1, people, -1)
        you = persons[:, None].expand(-1, people, -1, -1)
        asked = self.pair(torch.cat([me, you, seen], -1))
        known = (asked @ self.priors.T * self.config.width**-0.5).softmax(-1) @ self.priors
        counted = there[..., None].float()
        return self.tell((known * counted).sum(2) / counted.sum(2).clamp(min=1)) * counted.amax(2)

    def loss(self, answer: Tensor, truth: Tensor, observed: Tensor) -> Tensor:
        """Mean distance of the joints."""
        return mean_distance(answer, truth, observed)


MODEL, CONFIG = IAFormerLike, IAFormerLikeConfig
