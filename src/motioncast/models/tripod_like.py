"""In the spirit of TRiPOD, of which no code and few facts are public: not to be quoted as its result.

After: Adeli, Ehsanpour, Reid, Niebles, Savarese, Adeli, Rezatofighi, "TRiPOD: Human Trajectory and Pose Dynamics
Forecasting in the Wild", 2021. Known: graph attention among joints, message passing between people (and objects), a
recurrent encoder and decoder. Ours: the sizes, people's own frames, an attention for the message, no objects, and a
decoder that is given the same code at every frame instead of its own last answer.

Shapes: B scenes, H history, F horizon, P people, J joints, d channels.
"""

from __future__ import annotations

from dataclasses import dataclass

import torch
from torch import Tensor, nn

from motioncast.core.skeletons import SKELETONS
from motioncast.nn.attention import EncoderLayer
from motioncast.nn.frames import stand, to_own, to_world
from motioncast.nn.gaps import fill_gaps
from motioncast.nn.losses import mean_distance
from motioncast.nn.social import PeopleAttention


@dataclass(frozen=True)
class TripodLikeConfig:
    """Sizes of the model.

    Attributes:
        skeleton: Name of the skeleton.
        history: Frames read.
        horizon: Frames answered.
        fps: Frames a second.
        joint_width: Channels of a joint in a frame.
        width: Channels d of a person.
    """

    skeleton: str = "mrt15"
    history: int = 15
    horizon: int = 45
    fps: float = 15.0
    joint_width: int = 32
    width: int = 192


class TripodLike(nn.Module):
    """World-frame history with masks in; world-frame future of all people out."""

    def __init__(self, config: TripodLikeConfig) -> None:
        super().__init__()
        self.config = config
        self.skeleton = SKELETONS[config.skeleton]
        joints, narrow, d = len(self.skeleton), config.joint_width, config.width
        self.embed = nn.Linear(6, narrow)
        self.joint = nn.Parameter(torch.randn(joints, narrow) * 0.02)
        self.body = EncoderLayer(narrow, 4, 2 * narrow, 0.0, norm_first=True)
        self.gather = nn.Linear(joints * narrow, d)
        self.encoder = nn.GRU(d, d, batch_first=True)
        self.message = PeopleAttention(d)
        self.decoder = nn.GRU(d, d, batch_first=True)
        self.head = nn.Linear(d, 3 * joints)
        nn.init.zeros_(self.head.weight)  # untrained, the model repeats the last pose
        nn.init.zeros_(self.head.bias)

    def forward(self, history: Tensor, observed: Tensor) -> Tensor:
        """The future of all people, ``(B, F, P, J, 3)`` metres, world.

        Args:
            history: ``(B, H, P, J, 3)`` metres, world, z up.
            observed: ``(B, H, P, J)`` bool.
        """
        batch, frames, people, joints = observed.shape
        history = fill_gaps(history, observed)
        origin, heading = stand(history[:, -1], self.skeleton)
        own = to_own(history, origin, heading)
        steps = torch.cat([own[:, :1] * 0, own[:, 1:] - own[:, :-1]], 1) * self.config.fps
        tokens = self.embed(torch.cat([own, steps], -1)) + self.joint
        tokens = tokens.permute(0, 2, 1, 3, 4).reshape(batch * people * frames, joints, self.config.joint_width)
        bodies = self.gather(self.body(tokens, tokens.new_zeros(1, 1, 1, 1)).flatten(1))
        codes = self.encoder(bodies.view(batch * people, self.config.history, -1))[0][:, -1]
        codes = codes.view(batch, people, self.config.width)
        codes = (codes + self.message(codes, origin, heading, observed[:, -1].any(-1))).flatten(0, 1)
        going_on = self.decoder(codes[:, None].expand(-1, self.config.horizon, -1))[0]
        velocity = self.head(going_on).float().view(batch, people, self.config.horizon, joints, 3)
        change = (velocity / self.config.fps).cumsum(2).permute(0, 2, 1, 3, 4)
        return to_world(own[:, -1:] + change, origin, heading)

    def loss(self, answer: Tensor, truth: Tensor, observed: Tensor) -> Tensor:
        """Mean distance of the joints."""
        return mean_distance(answer, truth, observed)


MODEL, CONFIG = TripodLike, TripodLikeConfig
