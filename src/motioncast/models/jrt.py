"""JRT, the joint-relation transformer: joints as tokens, and a relation for each pair of joints.

Paper: Xu, Mao, Gong, Xu, Chen, Xie, Zhang, Wang, "Joint-Relation Transformer for Multi-Person Motion Prediction",
2023, Sec. 3.

A joint is its past positions and steps. A relation is exp(-distance) in every past frame, whether the two joints make
a bone, and whether they are one person's. Each layer lets joints attend to one another, with scores to which
relations add, and then renews each relation from its two directions and its two joints. Everything is read out as
steps of the whole window, past and future, and as exp(-distance) of each pair over the window; the answer is the last
pose plus the sum of the future steps. The loss is on all of it: 10 for the future, 1 for the past, and 1 for what is
read out before the first and after every layer.

Where the public code, of 3,590,680 parameters for two people of 13 joints, differs:

- its nets that read in and out have no activation between their linear layers, which makes each a single one; they
  are nets here, with ReLU;
- it owns a norm that it never uses: 256 of the parameters;
- its bones are a list of its own, in which hips and shoulders make a trapezium; ours are the skeleton's.

What differs from both here:

- Theirs centres a scene on the first pose of the first person. Ours centres on the people of the last frame of the
  history; neither reads the future.
- Theirs is for two people, each with a row of a table. Ours numbers the people who are there through the rows of its
  table, again from the first when they are used up, and deals the rows anew in each step of training.
- People who are not there in the last frame are masked.

Shapes: B scenes, H history, F horizon, P people, J joints, N = P J, T = H + F, d width.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from typing import NamedTuple

import torch
from torch import Tensor, nn

from motioncast.core.skeletons import SKELETONS
from motioncast.nn.frames import middle_of_people
from motioncast.nn.gaps import fill_gaps
from motioncast.nn.losses import mean_distance, mean_over

FAR = -1e9
"""Attention score of a joint of somebody who is not there."""

FUTURE_WEIGHT = 10.0
"""Weight of the future in the loss, beside 1 for the past and 1 for each of the readings on the way."""


@dataclass(frozen=True)
class JRTConfig:
    """Sizes of the model.

    Attributes:
        skeleton: Name of the skeleton.
        history: Frames read.
        horizon: Frames answered.
        fps: Frames a second.
        people: Rows of the table of people.
        width: Channels d of a joint and of a relation.
        layers: Layers.
        heads: Attention heads.
        dropout: Share of the channels of the embeddings dropped in training.
    """

    skeleton: str = "mrt15"
    history: int = 15
    horizon: int = 45
    fps: float = 15.0
    people: int = 3
    width: int = 128
    layers: int = 4
    heads: int = 8
    dropout: float = 0.1


class Answer(NamedTuple):
    """What the loss needs of an answer.

    Attributes:
        history: The history without gaps, ``(B, H, P, J, 3)``.
        observed: What of it was seen, ``(B, H, P, J)``.
        steps: Each reading's steps of the whole window, ``(B, T, P, J, 3)``.
        nearness: Each reading's exp(-distance) of each pair, ``(B, T, N, N)``.
    """

    history: Tensor
    observed: Tensor
    steps: list[Tensor]
    nearness: list[Tensor]


class Layer(nn.Module):
    """Joints attend to one another, relations lending weight; then relations follow the joints.

    Args:
        width: Channels of a joint and of a relation.
        heads: Attention heads.
    """

    def __init__(self, width: int, heads: int) -> None:
        super().__init__()
        self.heads = heads
        self.project = nn.Linear(width, 3 * width)
        self.weigh = nn.Linear(width, heads)
        self.pair = nn.Linear(width, 2 * width)
        self.merge = nn.Linear(width, width)
        self.norm_joints, self.norm_relations = nn.LayerNorm(width), nn.LayerNorm(width)
        self.feed_joints = nn.Sequential(nn.LayerNorm(width), net(nn.GELU, width, width, width))
        self.gather = nn.Sequential(nn.LayerNorm(4 * width), net(nn.GELU, 4 * width, 4 * width, width))
        self.feed_relations = nn.Sequential(nn.LayerNorm(width), net(nn.GELU, width, width, width))

    def forward(self, joints: Tensor, relations: Tensor, bias: Tensor) -> tuple[Tensor, Tensor]:
        """Updated joints ``(B, N, d)`` and relations ``(B, N, N, d)``; ``bias`` is added to the scores."""
        joints = joints + self.attend(self.norm_joints(joints), self.norm_relations(relations), bias)
        joints = joints + self.feed_joints(joints)
        first = joints[:, :, None].expand_as(relations)
        both = torch.cat([relations, relations.transpose(1, 2), first, first.transpose(1, 2)], -1)
        relations = relations + self.gather(both)
        return joints, relations + self.feed_relations(relations)

    def attend(self, joints: Tensor, relations: Tensor, bias: Tensor) -> Tensor:
        """Attention whose scores are (q k + linear(R) + R_q R_k) / sqrt(channels of a head)."""
        query, key, value = self.project(joints).unflatten(-1, (3, self.heads, -1)).permute(2, 0, 3, 1, 4)
        asks, answers = self.pair(relations).unflatten(-1, (2, self.heads, -1)).unbind(3)
        lent = self.weigh(relations) + (asks * answers).sum(-1)
        scores = (query @ key.transpose(-1, -2) + lent.permute(0, 3, 1, 2)) * query.shape[-1] ** -0.5
        return self.merge(((scores + bias).softmax(-1) @ value).transpose(1, 2).flatten(2))


class JRT(nn.Module):
    """World-frame history with masks in, world-frame future of all people out."""

    bones: Tensor

    def __init__(self, config: JRTConfig) -> None:
        super().__init__()
        self.config = config
        skeleton = SKELETONS[config.skeleton]
        joints, width, window = len(skeleton), config.width, config.history + config.horizon
        self.embed_joints = net(nn.ReLU, 6 * config.history, 256, 256, width)
        self.embed_relations = net(nn.ReLU, config.history + 2, 256, 256, width)
        self.layers = nn.ModuleList(Layer(width, config.heads) for _ in range(config.layers))
        self.read_steps = net(nn.ReLU, width, 1024, 512, 3 * window)
        self.read_nearness = net(nn.ReLU, width, 1024, 512, window)
        for module in self.modules():
            if isinstance(module, nn.Linear):
                nn.init.xavier_uniform_(module.weight)
                nn.init.zeros_(module.bias)
        self.joint = nn.Parameter(torch.randn(joints, width) * 0.02)
        self.person = nn.Parameter(torch.randn(config.people, width) * 0.02)
        self.drop = nn.Dropout(config.dropout)
        bones = torch.eye(joints)  # the public code counts a joint as tied to itself
        for joint, parent in skeleton.bones:
            bones[joint, parent] = bones[parent, joint] = 1
        self.register_buffer("bones", bones, persistent=False)

    def forward(self, history: Tensor, observed: Tensor) -> Tensor | Answer:
        """The future of all people.

        Args:
            history: ``(B, H, P, J, 3)`` metres, world, z up.
            observed: ``(B, H, P, J)`` bool.

        Returns:
            ``(B, F, P, J, 3)`` metres, world; in training what the loss needs.
        """
        people = history.shape[2]
        frames, present = fill_gaps(history, observed), observed[:, -1].any(-1)
        joints = self.embed_joints(features(frames - middle_of_people(frames[:, -1], present)[:, None]))
        relations = self.embed_relations(self.relations(frames))
        place = self.place(present)
        bias = (~present).float()[:, :, None].expand(-1, -1, len(self.joint)).flatten(1)[:, None, None] * FAR
        readings = [(joints, relations)]
        for layer in self.layers:
            places = self.drop(place), self.drop(place[:, :, None] + place[:, None])
            joints, relations = layer(joints + places[0], relations + places[1], bias)
            readings.append((joints, relations))
        if self.training:
            steps = [self.steps(joints, people) for joints, _ in readings]
            nearness = [self.read_nearness(relations).float().permute(0, 3, 1, 2) for _, relations in readings]
            return Answer(frames, observed, steps, nearness)
        return frames[:, -1:] + self.steps(joints, people)[:, self.config.history :].cumsum(1)

    def relations(self, frames: Tensor) -> Tensor:
        """What is known of each pair of joints of ``(B, H, P, J, 3)``, ``(B, N, N, H + 2)``."""
        near = nearness(frames).permute(0, 2, 3, 1)
        number = torch.arange(frames.shape[2], device=frames.device)
        same = (number[:, None] == number).float()[:, None, :, None]
        ties = torch.stack([same * self.bones[:, None], same.expand(-1, len(self.joint), -1, len(self.joint))], -1)
        ties = ties.flatten(0, 1).flatten(1, 2)
        return torch.cat([near, ties.expand(near.shape[0], -1, -1, -1)], -1)

    def place(self, present: Tensor) -> Tensor:
        """Which joint of which of the people ``(B, P)`` who are there, ``(B, N, d)``."""
        rows = (present.long().cumsum(1) - 1).clamp(min=0) % self.config.people
        if self.training:
            rows = torch.randperm(self.config.people, device=rows.device)[rows]
        return (self.person[rows][:, :, None] + self.joint).flatten(1, 2)

    def steps(self, joints: Tensor, people: int) -> Tensor:
        """Steps of the whole window that are read out of the joints, ``(B, T, P, J, 3)``."""
        steps = self.read_steps(joints).float().unflatten(1, (people, -1)).unflatten(-1, (-1, 3))
        return steps.permute(0, 3, 1, 2, 4)

    def loss(self, answer: Answer, truth: Tensor, observed: Tensor) -> Tensor:
        """Distances of steps plus differences of exp(-distance): 10 future + past of the last, 1 of every reading."""
        frames, seen = torch.cat([answer.history, truth], 1), torch.cat([answer.observed, observed], 1)
        steps, steps_seen = steps_of(frames), torch.cat([seen[:, :1], seen[:, 1:] & seen[:, :-1]], 1)
        near, seen = nearness(frames), seen.flatten(2)
        pairs_seen = seen[:, :, :, None] & seen[:, :, None]
        readings = []
        for steps_read, near_read in zip(answer.steps, answer.nearness, strict=True):
            past, future = (
                mean_distance(steps_read[:, part], steps[:, part], steps_seen[:, part])
                + mean_over((near_read[:, part] - near[:, part]).abs(), pairs_seen[:, part])
                for part in (slice(self.config.history), slice(self.config.history, None))
            )
            readings.append((past, future))
        past, future = readings[-1]
        return FUTURE_WEIGHT * future + past + sum(past + future for past, future in readings)


def net(activation: type[nn.Module], *widths: int) -> nn.Sequential:
    """Linear layers with an activation between them."""
    layers = [module for pair in pairwise(widths) for module in (nn.Linear(*pair), activation())]
    return nn.Sequential(*layers[:-1])


def steps_of(frames: Tensor) -> Tensor:
    """Steps from frame to frame along axis 1, the first one zero."""
    return torch.cat([torch.zeros_like(frames[:, :1]), frames[:, 1:] - frames[:, :-1]], 1)


def features(frames: Tensor) -> Tensor:
    """Position and step of each joint in every frame ``(B, H, P, J, 3)``, ``(B, N, 6 H)``."""
    both = torch.cat([frames, steps_of(frames)], -1)
    return both.permute(0, 2, 3, 1, 4).flatten(3).flatten(1, 2)


def nearness(frames: Tensor) -> Tensor:
    """exp(-distance) of each pair of joints in every frame ``(B, T, P, J, 3)``, ``(B, T, N, N)``."""
    joints = frames.flatten(2, 3)
    return torch.exp(-(joints[:, :, :, None] - joints[:, :, None]).norm(dim=-1))


MODEL, CONFIG = JRT, JRTConfig
