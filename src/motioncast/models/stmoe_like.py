"""In the spirit of ST-MoE; facts are few, so it is not to be quoted as its result.

After: "ST-MoE", a spatio-temporal mixture of experts for multi-person motion, 2026. Known: graph networks before and
after one layer of four experts, all of them active, that scan the motion in both directions along time or along the
joints. Ours: the sizes, people's own frames, gated recurrent units where the original has Mamba, linear layers where it
has graph networks, and an attention between people.

Shapes: B scenes, H history, F horizon, P people, J joints, d channels.
"""

from __future__ import annotations

from dataclasses import dataclass

import torch
from torch import Tensor, nn

from motioncast.core.skeletons import SKELETONS
from motioncast.nn.frames import stand, to_own, to_world
from motioncast.nn.gaps import fill_gaps
from motioncast.nn.losses import mean_distance
from motioncast.nn.social import PeopleAttention

EXPERTS = (("time",), ("joints",), ("time", "joints"), ("joints", "time"))
"""Along what each expert scans."""


@dataclass(frozen=True)
class STMoELikeConfig:
    """Sizes of the model.

    Attributes:
        skeleton: Name of the skeleton.
        history: Frames read.
        horizon: Frames answered.
        fps: Frames a second.
        width: Channels d of a joint in a frame.
    """

    skeleton: str = "mrt15"
    history: int = 15
    horizon: int = 45
    fps: float = 15.0
    width: int = 32


class Scan(nn.Module):
    """Both ways along time or along the joints.

    Args:
        width: Channels.
        along: ``time`` or ``joints``.
    """

    def __init__(self, width: int, along: str) -> None:
        super().__init__()
        self.along = along
        self.units = nn.GRU(width, width // 2, batch_first=True, bidirectional=True)

    def forward(self, features: Tensor) -> Tensor:
        """Features ``(N, frames, joints, d)``."""
        lines = features.transpose(1, 2) if self.along == "time" else features
        _, rows, length, width = lines.shape
        scanned = self.units(lines.reshape(-1, length, width))[0].view(-1, rows, length, width)
        return scanned.transpose(1, 2) if self.along == "time" else scanned


class STMoELike(nn.Module):
    """World-frame history with masks in; world-frame future of all people out."""

    def __init__(self, config: STMoELikeConfig) -> None:
        super().__init__()
        self.config = config
        self.skeleton = SKELETONS[config.skeleton]
        joints, frames, d = len(self.skeleton), config.history + config.horizon, config.width
        self.embed = nn.Linear(3, d)
        self.frame = nn.Parameter(torch.randn(frames, 1, d) * 0.02)
        self.joint = nn.Parameter(torch.randn(joints, d) * 0.02)
        self.message = PeopleAttention(d)
        self.gate = nn.Linear(d, len(EXPERTS))
        self.experts = nn.ModuleList(nn.Sequential(*(Scan(d, along) for along in expert)) for expert in EXPERTS)
        self.norm = nn.LayerNorm(d)
        self.head = nn.Linear(d, 3)
        nn.init.zeros_(self.head.weight)  # untrained, the model repeats the last pose
        nn.init.zeros_(self.head.bias)

    def forward(self, history: Tensor, observed: Tensor) -> Tensor:
        """The future of all people, ``(B, F, P, J, 3)`` metres, world.

        Args:
            history: ``(B, H, P, J, 3)`` metres, world, z up.
            observed: ``(B, H, P, J)`` bool.
        """
        people = history.shape[2]
        history = fill_gaps(history, observed)
        origin, heading = stand(history[:, -1], self.skeleton)
        own = to_own(history, origin, heading)
        padded = torch.cat([own, own[:, -1:].expand(-1, self.config.horizon, -1, -1, -1)], 1)
        features = self.embed(padded.permute(0, 2, 1, 3, 4).flatten(0, 1)) + self.frame + self.joint
        persons = features.mean((1, 2)).view(-1, people, self.config.width)
        messages = self.message(persons, origin, heading, observed[:, -1].any(-1))
        persons = (persons + messages).flatten(0, 1)[:, None, None]
        features = features + persons
        shares = self.gate(persons).softmax(-1)
        mixed = torch.stack([expert(features) for expert in self.experts], -1) * shares[..., None, :]
        change = self.head(self.norm(features + mixed.sum(-1)))[:, self.config.history :].float()
        change = change.view(-1, people, self.config.horizon, len(self.skeleton), 3).permute(0, 2, 1, 3, 4)
        return to_world(own[:, -1:] + change, origin, heading)

    def loss(self, answer: Tensor, truth: Tensor, observed: Tensor) -> Tensor:
        """Mean distance of the joints plus mean distance of their steps from frame to frame."""
        both = observed[:, 1:] & observed[:, :-1]
        return mean_distance(answer, truth, observed) + mean_distance(answer.diff(dim=1), truth.diff(dim=1), both)


MODEL, CONFIG = STMoELike, STMoELikeConfig
