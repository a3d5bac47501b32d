"""TBIFormer, the trajectory-aware body interaction transformer: windows of body parts as tokens.

Paper: Peng, Mao, Wu, "Trajectory-Aware Body Interaction Transformer for Multi-Person Pose Forecasting", 2023, Sec. 3.

Each person's steps from frame to frame are pooled over five body parts, and a convolution makes a token of every
window of 10 frames of a part. Tokens of all people attend to one another. How alike the paths of two people are within
a window, by soft dynamic time warping, chooses a row of a table that a token's query is multiplied with: the
trajectory-aware relative position. A decoder asks once a person, with the last window of the whole body, and answers
the steps of all frames to come. The loss is the mean squared error of the steps.

Two presets. The public code takes a DCT of the steps over the coordinates of a pose. Over time it would leave no
windows of frames to its convolution, over coordinates it leaves no joints to pool: its body parts are mixtures of all.
So ``release`` has that DCT, and ``paper`` has none; apart from what is pooled, the layers that read and write
steps can make up for it. Either has the public code's 5,647,149 parameters, from 50 frames of 15 joints to 25.

Where the public code differs from both:

- It orders tokens by person, part and window, but the relative positions by person, window and part, so that they
  reach other tokens than they are meant for. Here they reach their own.
- It draws people's identities anew in each call, in evaluation too, from as many as there are body parts, and so
  fails for six people. Here training draws from ten, and evaluation numbers the people in their order.
- It reads steps in the units of its files; here they are velocities in metres a second.

As there, a layer of the encoder has no way around its attention: what is added after the feed-forward net is the
attention's own result. People who are not there in the last frame are masked. Nothing is centred: steps and distances
do not depend on where the scene is.

Shapes: B scenes, H history, F horizon, P people, J joints, W windows, d width, L = 5 P W tokens.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

import torch
from torch import Tensor, nn

from motioncast.core.skeleton import Skeleton
from motioncast.core.skeletons import SKELETONS
from motioncast.nn.dct import dct_matrix, exact
from motioncast.nn.frames import root_joints
from motioncast.nn.gaps import fill_gaps
from motioncast.nn.sinusoids import sinusoids

ARM = ("shoulder", "elbow", "wrist", "hand", "fingers", "thumb")
LEG = ("hip", "knee", "ankle", "heel", "foot", "toe")
PARTS = 5
"""Two arms, two legs, and the rest."""

BUCKETS = 10
"""Rows of the table of relative positions."""

FARTHEST = 2000.0
"""Warping distance, in square metres, that has the last row; distances between 1 and it share the others evenly in
their logarithm."""

SOFTNESS = 0.1
"""How far the soft minimum of the warping is from a minimum."""

FAR = -1e9
"""Attention score of a token of somebody who is not there."""


@dataclass(frozen=True)
class TBIFormerConfig:
    """Sizes of the model.

    Attributes:
        skeleton: Name of the skeleton.
        history: Frames read (the paper: 50).
        horizon: Frames answered (the paper: 25).
        fps: Frames a second.
        preset: ``paper`` or ``release`` (see the module).
        window: Steps in a window; fewer than ``history``.
        width: Channels d of a token.
        layers: Layers of the encoder and of the decoder.
        heads: Attention heads.
        head_width: Channels of a head.
        feed_forward: Hidden channels of the feed-forward nets.
        identities: Identities that training draws from.
        dropout: Share of dropped channels in training.
    """

    skeleton: str = "mrt15"
    history: int = 15
    horizon: int = 45
    fps: float = 15.0
    preset: Literal["paper", "release"] = "paper"
    window: int = 10
    width: int = 128
    layers: int = 2
    heads: int = 8
    head_width: int = 64
    feed_forward: int = 1024
    identities: int = 10
    dropout: float = 0.2


class Attention(nn.Module):
    """Multi-head attention of queries to keys.

    Args:
        config: Sizes.
    """

    def __init__(self, config: TBIFormerConfig) -> None:
        super().__init__()
        self.heads = config.heads
        inner = config.heads * config.head_width
        self.query = nn.Linear(config.width, inner, bias=False)
        self.key = nn.Linear(config.width, inner, bias=False)
        self.value = nn.Linear(config.width, inner, bias=False)
        self.merge = nn.Linear(inner, config.width, bias=False)
        self.drop = nn.Dropout(config.dropout)

    def forward(
        self, queries: Tensor, keys: Tensor, bias: Tensor, table: Tensor | None = None, rows: Tensor | None = None
    ) -> Tensor:
        """What the queries ``(B, queries, d)`` gather, of their shape.

        Args:
            queries: Who asks.
            keys: Who is asked, ``(B, keys, d)``.
            bias: Added to the scores, ``(B, 1, 1, keys)``.
            table: Relative positions, ``(rows, inner)``; each query is multiplied with the row of each key.
            rows: That row, ``(B, queries, keys)``.
        """
        query, key, value = self.split(self.query(queries)), self.split(self.key(keys)), self.split(self.value(keys))
        scores = query @ key.transpose(-1, -2) * query.shape[-1] ** -0.5 + bias
        if table is not None and rows is not None:
            lent = query @ table.unflatten(-1, (self.heads, -1)).permute(1, 2, 0)
            scores = scores + lent.gather(3, rows[:, None].expand(-1, self.heads, -1, -1))
        mixed = self.drop(scores.softmax(-1)) @ value
        return self.drop(self.merge(mixed.transpose(1, 2).flatten(2)))

    def split(self, tokens: Tensor) -> Tensor:
        """Heads apart, ``(B, heads, tokens, head width)``."""
        return tokens.unflatten(-1, (self.heads, -1)).transpose(1, 2)


class Layer(nn.Module):
    """What the layers of both kinds hold: attention and a feed-forward net, with norms.

    Args:
        config: Sizes.
    """

    def __init__(self, config: TBIFormerConfig) -> None:
        super().__init__()
        self.attention = Attention(config)
        self.norm_attention = nn.LayerNorm(config.width, eps=1e-6)
        self.rise = nn.Linear(config.width, config.feed_forward)
        self.fall = nn.Linear(config.feed_forward, config.width)
        self.norm_feed = nn.LayerNorm(config.width, eps=1e-6)
        self.drop = nn.Dropout(config.dropout)

    def feed(self, tokens: Tensor) -> Tensor:
        """The feed-forward net, with a residual and a norm after it."""
        return self.norm_feed(tokens + self.drop(self.fall(torch.relu(self.rise(tokens)))))


class EncoderLayer(Layer):
    """Tokens look at one another; nothing leads around their attention."""

    def forward(self, tokens: Tensor, bias: Tensor, table: Tensor, rows: Tensor) -> Tensor:
        """Updated tokens ``(B, L, d)``."""
        gathered = self.attention(tokens, tokens, bias, table, rows)
        return gathered + self.feed(self.norm_attention(gathered))


class DecoderLayer(Layer):
    """Queries look at the tokens."""

    def forward(self, queries: Tensor, tokens: Tensor, bias: Tensor) -> Tensor:
        """Updated queries ``(B, P, d)``."""
        return self.feed(self.norm_attention(queries + self.attention(queries, tokens, bias)))


class TBIFormer(nn.Module):
    """World-frame history with masks in, world-frame future of all people out."""

    pooling: Tensor
    transform: Tensor

    def __init__(self, config: TBIFormerConfig) -> None:
        super().__init__()
        self.config = config
        skeleton = SKELETONS[config.skeleton]
        coordinates, width = 3 * len(skeleton), config.width
        self.root = root_joints(skeleton)
        self.windows = nn.Conv1d(3, width, config.window, bias=False)
        self.table = nn.Parameter(torch.empty(BUCKETS, config.heads * config.head_width))
        self.encoder = nn.ModuleList(EncoderLayer(config) for _ in range(config.layers))
        half = config.window // 2 + 1
        self.ask = nn.Sequential(
            nn.Conv1d(coordinates, width, half, bias=False), nn.ReLU(),
            nn.Conv1d(width, width, config.window + 1 - half, bias=False), nn.ReLU(),
        )  # fmt: skip
        self.decoder = nn.ModuleList(DecoderLayer(config) for _ in range(config.layers))
        self.widen = nn.Linear(width, 8 * width)
        self.frames = nn.Linear(8 * width, config.horizon * width)
        self.step = nn.Linear(width, coordinates)
        self.drop = nn.Dropout(config.dropout)
        for parameter in self.parameters():
            if parameter.dim() > 1:
                nn.init.xavier_uniform_(parameter)
        transform = dct_matrix(coordinates) if config.preset == "release" else torch.eye(coordinates)
        self.register_buffer("transform", transform, persistent=False)
        self.register_buffer("pooling", part_means(skeleton), persistent=False)

    def forward(self, history: Tensor, observed: Tensor) -> Tensor:
        """The future of all people.

        Args:
            history: ``(B, H, P, J, 3)`` metres, world, z up.
            observed: ``(B, H, P, J)`` bool.

        Returns:
            ``(B, F, P, J, 3)`` metres, world.
        """
        config = self.config
        frames, present = fill_gaps(history, observed), observed[:, -1].any(-1)
        people = history.shape[2]
        velocity = ((frames[:, 1:] - frames[:, :-1]) * config.fps).flatten(3).transpose(1, 2)  # B, P, H - 1, 3 J
        velocity = exact(velocity, self.transform.T)
        tokens = self.tokens(velocity, present)
        absent = (~present).float()[:, :, None] * FAR
        bias = absent.expand(-1, -1, tokens.shape[2]).flatten(1)[:, None, None]
        tokens, rows = tokens.flatten(1, 2), self.relative_positions(frames)
        for layer in self.encoder:
            tokens = layer(tokens, bias, self.table, rows)
        queries = self.ask(velocity[:, :, -config.window :].flatten(0, 1).transpose(1, 2))
        queries = queries.view(-1, people, config.width)
        for layer in self.decoder:
            queries = layer(queries, tokens, bias)
        features = self.frames(self.widen(queries)).unflatten(-1, (config.horizon, -1))
        steps = exact(self.step(features), self.transform).transpose(1, 2).unflatten(-1, (-1, 3)) / config.fps
        return frames[:, -1:] + steps.cumsum(1)

    def tokens(self, velocity: Tensor, present: Tensor) -> Tensor:
        """A token for each window of each part, with its place in time and whose it is, ``(B, P, 5 W, d)``."""
        parts = self.pooling @ velocity.unflatten(-1, (-1, 3))  # B, P, H - 1, 5, 3
        parts = parts.permute(0, 1, 3, 4, 2)
        windows = torch.relu(self.windows(parts.flatten(0, 2))).transpose(1, 2)
        windows = windows.view(-1, present.shape[1], PARTS, *windows.shape[1:])  # B, P, 5, W, d
        time = sinusoids(torch.arange(windows.shape[3], device=windows.device), self.config.width)
        person = sinusoids(self.identities(present), self.config.width)[:, :, None, None]
        return self.drop(windows + time + person).flatten(2, 3)

    def identities(self, present: Tensor) -> Tensor:
        """The number of each of the people ``(B, P)`` who are there: in their order, in training drawn at random."""
        numbers = (present.long().cumsum(1) - 1).clamp(min=0)
        if self.training:
            drawn = torch.randperm(max(self.config.identities, numbers.shape[1]), device=numbers.device)
            return drawn[numbers]
        return numbers

    def relative_positions(self, frames: Tensor) -> Tensor:
        """The table's row for each pair of tokens of ``(B, H, P, J, 3)``, ``(B, L, L)``.

        A person's own tokens have row 0, those of another person in another window the last.
        """
        people, windows = frames.shape[2], self.config.history - self.config.window
        path = frames[:, 1:, :, self.root].mean(3)
        parts = [path[:, start : start + self.config.window] for start in range(windows)]
        paths = torch.stack(parts, 1).permute(0, 3, 1, 2, 4)  # B, P, W, window, 3
        alike = bucket(warping_distance(paths[:, :, None], paths[:, None]).abs())  # B, P, P, W
        person, window = (torch.arange(count, device=frames.device) for count in (people, windows))
        rows = torch.where(window[:, None] == window, alike[..., None], BUCKETS - 1)
        rows = torch.where((person[:, None] == person)[:, :, None, None], 0, rows)  # B, P, P, W, W
        rows = rows.transpose(2, 3)[:, :, None, :, :, None]  # B, P, part, W, P, part, W
        return rows.expand(-1, -1, PARTS, -1, -1, PARTS, -1).flatten(4, 6).flatten(1, 3)

    def loss(self, answer: Tensor, truth: Tensor, observed: Tensor) -> Tensor:
        """Mean squared error of the steps from frame to frame; the first is that of the first position."""
        first = (answer[:, :1] - truth[:, :1]).square().mean(-1)
        later = (answer.diff(dim=1) - truth.diff(dim=1)).square().mean(-1)
        seen = torch.cat([observed[:, :1], observed[:, 1:] & observed[:, :-1]], 1)
        return (torch.cat([first, later], 1) * seen).sum() / seen.sum().clamp(min=1)


def part_means(skeleton: Skeleton) -> Tensor:
    """The matrix ``(5, J)`` that takes the mean over each arm, each leg and the rest."""
    limbs = [{f"{side}_{place}" for place in places} for places in (ARM, LEG) for side in ("left", "right")]
    part = [next((n for n, limb in enumerate(limbs) if name in limb), 4) for name in skeleton.landmarks]
    members = torch.nn.functional.one_hot(torch.tensor(part), PARTS).T.float()
    return members / members.sum(1, keepdim=True).clamp(min=1)


def warping_distance(one: Tensor, other: Tensor) -> Tensor:
    """Soft dynamic time warping of paths ``(..., K, 3)``: the soft least sum of squared distances, ``(...)``.

    Cuturi and Blondel, "Soft-DTW", 2017. Cells of one antidiagonal of the table do not need one another.
    """
    length = one.shape[-2]
    cost = (one[..., :, None, :] - other[..., None, :, :]).square().sum(-1).flatten(-2)
    row = torch.arange(length, device=cost.device)
    nowhere = torch.full_like(cost[..., :length], -FAR)
    before, last = nowhere, nowhere
    for diagonal in range(2 * length - 1):
        column = diagonal - row
        inside = (column >= 0) & (column < length)
        here = cost[..., row * length + column.clamp(0, length - 1)]
        above, corner = (torch.cat([nowhere[..., :1], values[..., :-1]], -1) for values in (last, before))
        best = soft_minimum(torch.stack([last, above, corner], -1)) if diagonal else torch.zeros_like(here)
        before, last = last, torch.where(inside, here + best, nowhere)
    return last[..., -1]


def soft_minimum(values: Tensor) -> Tensor:
    """Soft minimum along the last axis."""
    least = values.amin(-1, keepdim=True)
    return least[..., 0] - SOFTNESS * torch.exp((least - values) / SOFTNESS).sum(-1).log()


def bucket(distance: Tensor) -> Tensor:
    """The table's row of a distance: rounded up to 1, evenly in the logarithm from 1 to ``FARTHEST``.

    Example:
        >>> bucket(torch.tensor([0.2, 0.9, 44.7, 2000.0, 1e6])).tolist()
        [0, 1, 5, 9, 9]
    """
    share = distance.clamp(min=1).log() / math.log(FARTHEST)
    beyond = (1 + share * (BUCKETS - 2)).round().clamp(max=BUCKETS - 1)
    return torch.where(distance <= 1, distance.round(), beyond).long()


MODEL, CONFIG = TBIFormer, TBIFormerConfig
