"""MRT, the multi-range transformer: a query a person, which looks at its own past and at everybody's.

Paper: Wang, Xu, Narasimhan, Wang, "Multi-Person 3D Motion Prediction with Multi-Range Transformers", 2021, Sec. 3.

A local encoder reads the steps of one person as DCT coefficients, a global encoder the poses of all people. The
decoder asks both with the person's last pose; global features carry how near that person-frame is to the asking pose,
exp(-mean squared distance). One answer is 15 frames of steps; longer horizons are answered in chunks, each with the
history grown by the chunks before it (15, 30, 45 frames).

Two presets. ``paper`` is the text. ``release`` repeats what differs in the authors' public code:

- its DCT runs over the coordinates of a pose instead of over time: a fixed rotation of the features;
- it owns a self-attention in the decoder, embedding tables and norms that it never uses: 813,568 of its 6,615,725
  parameters.

What differs from both here:

- Theirs centres a scene on the mean of all frames, future ones included. Ours centres on the people of the last frame
  of the history.
- Theirs trains chunks 2 and 3 on the true frames before them and is tested on its own; ours trains on its own.
- Theirs adds 0.0005 of an adversarial loss every second step; ours is the regression alone.
- People who are not there in the last frame are masked; theirs always has the same number of people.

Shapes: B scenes, H history, F horizon, P people, J joints, T frames seen so far, d width.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import torch
from torch import Tensor, nn

from motioncast.core.skeletons import SKELETONS
from motioncast.nn.dct import dct_matrix, exact
from motioncast.nn.frames import middle_of_people
from motioncast.nn.gaps import fill_gaps
from motioncast.nn.sinusoids import sinusoids

FAR = -1e9
"""Attention score of a frame of somebody who is not there."""


@dataclass(frozen=True)
class MRTConfig:
    """Sizes of the model; the defaults are the paper's for three people of 15 joints.

    Attributes:
        skeleton: Name of the skeleton.
        history: Frames read.
        horizon: Frames answered.
        fps: Frames a second.
        preset: ``paper`` or ``release`` (see the module).
        chunk: Frames answered at once.
        width: Channels d of a token.
        layers: Layers of each encoder and of the decoder.
        heads: Attention heads.
        head_width: Channels of a head.
        feed_forward: Hidden channels of the feed-forward nets.
        dropout: Share of dropped channels in training.
        unit_m: The unit in which steps go in and come out. In the published one, about a metre, a step is so small
            beside the code of its place in time that training is slow to notice it; 1 / fps makes them metres a second.
    """

    skeleton: str = "mrt15"
    history: int = 15
    horizon: int = 45
    fps: float = 15.0
    preset: Literal["paper", "release"] = "paper"
    chunk: int = 15
    width: int = 128
    layers: int = 3
    heads: int = 8
    head_width: int = 64
    feed_forward: int = 1024
    dropout: float = 0.2
    unit_m: float = 1.0


class Attention(nn.Module):
    """Multi-head attention of queries to keys, with a residual and a norm after it.

    Args:
        config: Sizes.
    """

    def __init__(self, config: MRTConfig) -> None:
        super().__init__()
        self.heads = config.heads
        inner = config.heads * config.head_width
        self.query = nn.Linear(config.width, inner, bias=False)
        self.key = nn.Linear(config.width, inner, bias=False)
        self.value = nn.Linear(config.width, inner, bias=False)
        self.merge = nn.Linear(inner, config.width, bias=False)
        self.drop = nn.Dropout(config.dropout)
        self.norm = nn.LayerNorm(config.width, eps=1e-6)

    def forward(self, queries: Tensor, keys: Tensor, bias: Tensor | None = None) -> Tensor:
        """Updated queries ``(N, queries, d)``; ``bias`` ``(N, 1, 1, keys)`` is added to the scores."""
        mixed = self.mix(self.split(self.query(queries)), keys, bias)
        return self.norm(queries + self.drop(self.merge(mixed.transpose(1, 2).flatten(2))))

    def mix(self, query: Tensor, keys: Tensor, bias: Tensor | None) -> Tensor:
        """Values that each head ``(N, heads, queries, head width)`` gathers from the keys."""
        key, value = self.split(self.key(keys)), self.split(self.value(keys))
        return attention(query, key, bias).to(value.dtype) @ value

    def split(self, tokens: Tensor) -> Tensor:
        """Heads apart, ``(N, heads, tokens, head width)``."""
        return tokens.unflatten(-1, (self.heads, -1)).transpose(1, 2)


class AttentionOfFew(Attention):
    """The same for few queries and many keys, in another order of products that spares projecting the keys.

    (W q) (W' k) = (W'^T W q) k, and a sum of projected values is the projected sum of values.
    """

    def mix(self, query: Tensor, keys: Tensor, bias: Tensor | None) -> Tensor:
        """Values that each head ``(N, heads, queries, head width)`` gathers from the keys."""
        key, value = (linear.weight.unflatten(0, (self.heads, -1)) for linear in (self.key, self.value))
        scale = (keys.shape[-1] / query.shape[-1]) ** 0.5  # to that of the heads
        weights = attention((query @ key) * scale, keys[:, None], bias)
        return weights.to(keys.dtype) @ keys[:, None] @ value.transpose(1, 2)


def attention(query: Tensor, key: Tensor, bias: Tensor | None) -> Tensor:
    """Softmax of the scaled scores; for bf16 on a CPU this is three times as fast as the fused attention."""
    scores = query @ key.transpose(-1, -2) * query.shape[-1] ** -0.5
    return (scores if bias is None else scores + bias).softmax(-1)


class Layer(nn.Module):
    """Attention and a feed-forward net, each with a residual and a norm after it.

    Args:
        config: Sizes.
        attention: Its kind.
    """

    def __init__(self, config: MRTConfig, attention: type[Attention] = Attention) -> None:
        super().__init__()
        self.attention = attention(config)
        self.rise = nn.Linear(config.width, config.feed_forward)
        self.fall = nn.Linear(config.feed_forward, config.width)
        self.drop = nn.Dropout(config.dropout)
        self.norm = nn.LayerNorm(config.width, eps=1e-6)

    def forward(self, queries: Tensor, keys: Tensor, bias: Tensor | None = None) -> Tensor:
        """Updated queries ``(N, queries, d)``."""
        queries = self.attention(queries, keys, bias)
        return self.norm(queries + self.drop(self.fall(torch.relu(self.rise(queries)))))


class MRT(nn.Module):
    """World-frame history with masks in, world-frame future of all people out."""

    def __init__(self, config: MRTConfig) -> None:
        super().__init__()
        self.config = config
        coordinates = 3 * len(SKELETONS[config.skeleton])
        self.embed_step = nn.Linear(coordinates, config.width)
        self.embed_pose = nn.Linear(coordinates, config.width)
        self.local_encoder = nn.ModuleList(Layer(config) for _ in range(config.layers))
        self.global_encoder = nn.ModuleList(Layer(config) for _ in range(config.layers))
        self.decoder = nn.ModuleList(Layer(config, AttentionOfFew) for _ in range(config.layers))
        self.widen = nn.Linear(config.width, 4 * config.width)
        self.frames = nn.Linear(4 * config.width, config.chunk * config.width)
        self.step = nn.Linear(config.width, coordinates)
        self.drop = nn.Dropout(config.dropout)
        if config.preset == "release":
            self.idle = idle_parts(config)
        for parameter in self.parameters():
            if parameter.dim() > 1:
                nn.init.xavier_uniform_(parameter)

    def forward(self, history: Tensor, observed: Tensor) -> Tensor:
        """The future of all people.

        Args:
            history: ``(B, H, P, J, 3)`` metres, world, z up.
            observed: ``(B, H, P, J)`` bool.

        Returns:
            ``(B, F, P, J, 3)`` metres, world.
        """
        config = self.config
        filled = fill_gaps(history, observed)
        present = observed[:, -1].any(-1)
        middle = middle_of_people(filled[:, -1], present)[:, None]
        frames = (filled - middle).flatten(3)  # B, T, P, 3 J
        for _ in range(-(-config.horizon // config.chunk)):
            frames = torch.cat([frames, frames[:, -1:] + self.next_steps(frames, present).cumsum(1)], 1)
        answer = frames[:, config.history : config.history + config.horizon]
        return answer.unflatten(-1, (-1, 3)) + middle

    def next_steps(self, frames: Tensor, present: Tensor) -> Tensor:
        """The steps from frame to frame of the next chunk.

        Args:
            frames: ``(B, T, P, 3 J)``.
            present: ``(B, P)`` bool.

        Returns:
            ``(B, chunk, P, 3 J)``.
        """
        people, length = frames.shape[2], frames.shape[1]
        own = self.local_features(frames)
        others = self.global_features(frames, present)[:, None]
        near = nearness(frames).flatten(2)[..., None]  # B, P of the one who asks, P T, 1
        features = torch.cat([own, (others + near).flatten(0, 1)], 1)
        absent = (~present).float().repeat_interleave(length, 1)[:, None].expand(-1, people, -1).flatten(0, 1) * FAR
        bias = torch.cat([torch.zeros_like(own[..., 0]), absent], 1)[:, None, None]
        query = self.embed_pose(frames[:, -1].flatten(0, 1))[:, None]
        for layer in self.decoder:
            query = layer(query, features, bias)
        chunk = self.frames(self.widen(query)).unflatten(-1, (self.config.chunk, -1))[:, 0]
        steps = self.from_frequencies(self.step(chunk)) * self.config.unit_m
        return steps.unflatten(0, (-1, people)).transpose(1, 2)

    def local_features(self, frames: Tensor) -> Tensor:
        """Each person's own steps, encoded, ``(B P, T - 1, d)``."""
        steps = (frames[:, 1:] - frames[:, :-1]).transpose(1, 2).flatten(0, 1)
        tokens = self.embed_step(self.to_frequencies(steps / self.config.unit_m))
        tokens = self.drop(tokens + places(tokens))
        for layer in self.local_encoder:
            tokens = layer(tokens, tokens)
        return tokens

    def global_features(self, frames: Tensor, present: Tensor) -> Tensor:
        """The poses of all people, encoded, ``(B, P T, d)``."""
        tokens = self.embed_pose(frames.transpose(1, 2))
        tokens = self.drop(tokens + places(tokens)).flatten(1, 2)
        bias = ((~present).float() * FAR).repeat_interleave(frames.shape[1], 1)[:, None, None]
        for layer in self.global_encoder:
            tokens = layer(tokens, tokens, bias)
        return tokens

    def to_frequencies(self, steps: Tensor) -> Tensor:
        """DCT of ``(N, T, 3 J)``."""
        if self.config.preset == "release":
            return exact(steps, dct_matrix(steps.shape[-1]).T.to(steps.device))
        return exact(steps.transpose(1, 2), dct_matrix(steps.shape[1]).T.to(steps.device)).transpose(1, 2)

    def from_frequencies(self, coefficients: Tensor) -> Tensor:
        """The inverse of ``to_frequencies``."""
        if self.config.preset == "release":
            return exact(coefficients, dct_matrix(coefficients.shape[-1]).to(coefficients.device))
        matrix = dct_matrix(coefficients.shape[1]).to(coefficients.device)
        return exact(coefficients.transpose(1, 2), matrix).transpose(1, 2)

    def loss(self, answer: Tensor, truth: Tensor, observed: Tensor) -> Tensor:
        """Mean squared error of the steps from frame to frame; the first is that of the first position."""
        first = (answer[:, :1] - truth[:, :1]).square().mean(-1)
        later = (answer.diff(dim=1) - truth.diff(dim=1)).square().mean(-1)
        seen = torch.cat([observed[:, :1], observed[:, 1:] & observed[:, :-1]], 1)
        return (torch.cat([first, later], 1) * seen).sum() / seen.sum().clamp(min=1)


def nearness(frames: Tensor) -> Tensor:
    """exp(-mean squared distance) of every pose ``(B, T, P, 3 J)`` from each last one, ``(B, P asking, P, T)``."""
    poses, last = frames.transpose(1, 2)[:, None], frames[:, -1][:, :, None, None]
    return torch.exp(-(poses - last).square().mean(-1))


def places(tokens: Tensor) -> Tensor:
    """The usual code of the place in time, ``(T, d)``, for tokens ``(..., T, d)``."""
    length, width = tokens.shape[-2:]
    return sinusoids(torch.arange(int(length), device=tokens.device), int(width))


def idle_parts(config: MRTConfig) -> nn.ModuleList:
    """What the release owns and never uses."""
    tables = [nn.Embedding(100, config.width) for _ in range(2)]
    norms = [nn.LayerNorm(config.width, eps=1e-6) for _ in range(3)]
    return nn.ModuleList([*tables, *norms, *(Attention(config) for _ in range(config.layers))])


MODEL, CONFIG = MRT, MRTConfig
