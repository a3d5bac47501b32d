"""SoMoFormer: multi-person pose forecasting with joints as tokens.

Paper: Vendrow, Kumar, Adeli, Rezatofighi, "SoMoFormer: Multi-Person Pose Forecasting with Transformers", 2022.

One pass answers all frames of all people. Each coordinate of each joint of each person is one token: its
trajectory, padded with the last pose over the horizon (Sec. 3.1), as DCT coefficients (Eq. 1-3). Learned
embeddings tell joint and person (Sec. 3.3), a grid cell tells where the person stands (Sec. 3.4). A transformer
encoder changes the coefficients; the change is added to those of the padded trajectory, and the same head is
read after every layer (Eq. 4).

Two presets. ``paper`` is the text made to work: a mask that hides absent people, a 5 x 5 grid around the middle
of the people, a table of 16 people, coefficients standardised by statistics of the training windows. ``release``
repeats what the authors' public code computes, for those who hold its weights (``SoMoFormerConfig.release``,
``from_release``); it differs from the text in this:

- the grid is three cells an axis, the two axes' embeddings added, and the index is floor(3 v / 3) of a position
  in [0, 1], so it is 1 only at the far end: in effect constant;
- positions for the grid are the raw ones;
- the padding mask is added to the scores as +1 instead of hiding absent people;
- the joint table (one row a coordinate) is added to the even channels, the person table (1000 rows) to the odd
  ones, and used rows are shortened to length 1 at most;
- the loss is a mean distance, its auxiliary part counts all layers: 1.2 for the last and 0.2 for the others,
  divided by 2.2.

In the text "hidden dimension 1024" is read as the feed-forward width with d = 256: only that gives the 4.88 M
parameters that are quoted. Whether the paper's own experiments had the release's grid is not known.

Shapes: B scenes, H history, F = H + horizon, P people, J joints, d width.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

import torch
from torch import Tensor, nn

from motioncast.core.skeletons import SKELETONS
from motioncast.errors import InputError
from motioncast.nn.attention import EncoderLayer
from motioncast.nn.dct import dct_matrix, exact
from motioncast.nn.gaps import fill_gaps
from motioncast.nn.losses import mean_distance

FAR = -1e9
"""Attention score of a token that is not there."""

RELEASE_EXTENT_M = 3.0
"""The release's grid ends at this distance from the origin."""


@dataclass(frozen=True)
class SoMoFormerConfig:
    """Sizes of the model; the defaults are the paper's for three people of 15 joints (Sec. 4.4, 5.2).

    Attributes:
        skeleton: Name of the skeleton.
        history: Frames read.
        horizon: Frames answered.
        fps: Frames a second.
        preset: ``paper`` or ``release`` (see the module).
        width: Channels d of a token, grid included.
        layers: Encoder layers.
        heads: Attention heads.
        feed_forward: Hidden channels of the feed-forward nets.
        embeddings: Whether learned embeddings tell joint and person; without them a model is the baseline of Table 3.
        permuted: Whether in training any row of the person table may stand for a person.
        grid_width: Channels of the grid embedding; 0: no grid.
        cells: Grid cells along each axis.
        extent_m: The grid reaches this far from the middle of the people on either side.
        people: Rows of the person table: most people in a scene.
        joint_rows: Whether the joint table has a row for each ``coordinate`` of a joint, as the release, or one for
            each ``joint``, as the text may be read.
        dropout: Share of dropped channels in training.
        squared: Whether the loss squares the distance, as Eq. 4 prints, or not, as the release does.
    """

    skeleton: str = "mrt15"
    history: int = 15
    horizon: int = 45
    fps: float = 15.0
    preset: Literal["paper", "release"] = "paper"
    width: int = 256
    layers: int = 6
    heads: int = 8
    feed_forward: int = 1024
    embeddings: bool = True
    permuted: bool = True
    grid_width: int = 8
    cells: int = 5
    extent_m: float = 5.0
    people: int = 16
    joint_rows: Literal["coordinate", "joint"] = "coordinate"
    dropout: float = 0.1
    squared: bool = False

    @classmethod
    def release(cls, skeleton: str = "somof13", history: int = 16, horizon: int = 14) -> SoMoFormerConfig:
        """The sizes of the authors' code: 4,882,842 parameters in the SoMoF setting.

        Example:
            >>> SoMoFormerConfig.release().people
            1000
        """
        return cls(skeleton, history, horizon, preset="release", cells=3, people=1000)


class SoMoFormer(nn.Module):
    """World-frame history with masks in; the world-frame future after each layer out."""

    dct: Tensor
    mean: Tensor
    deviation: Tensor

    def __init__(self, config: SoMoFormerConfig) -> None:
        super().__init__()
        self.config = config
        skeleton = SKELETONS[config.skeleton]
        self.joints = len(skeleton)
        neck = skeleton.find("neck")
        if neck is None:
            raise ValueError(f"skeleton {config.skeleton} has no neck to centre on")
        self.neck = neck
        frames, released = config.history + config.horizon, config.preset == "release"
        content = config.width - config.grid_width
        self.embed = nn.Linear(frames, content)
        rows = content // 2 if released else content
        self.repeats = 3 if config.joint_rows == "joint" else 1
        if config.embeddings:
            self.joint = nn.Embedding(3 * self.joints // self.repeats, rows)
            self.person = nn.Embedding(config.people, rows)
        self.grid = nn.Embedding(2 * config.cells if released else config.cells**2, config.grid_width)
        self.layers = nn.ModuleList(
            EncoderLayer(config.width, config.heads, config.feed_forward, config.dropout) for _ in range(config.layers)
        )
        self.head = nn.Linear(config.width, frames)
        self.register_buffer("dct", dct_matrix(frames), persistent=False)
        self.register_buffer("mean", torch.zeros(frames))
        self.register_buffer("deviation", torch.ones(frames))

    def forward(self, history: Tensor, observed: Tensor, weights: list[Tensor] | None = None) -> list[Tensor]:
        """The future of all people after each layer, the last one being the answer.

        Args:
            history: ``(B, H, P, J, 3)`` metres, world, z up.
            observed: ``(B, H, P, J)`` bool.
            weights: If given, each layer's attention ``(B, heads, 3 P J, 3 P J)`` is appended to it.

        Returns:
            For each layer ``(B, horizon, P, J, 3)`` metres, world.
        """
        history = fill_gaps(history, observed)
        present = observed[:, -1].any(-1)
        neck = history[:, -1:, :, self.neck : self.neck + 1]
        coefficients = self.standardised(history - neck)
        tokens = self.tokens(coefficients, neck[:, 0, :, 0], present)
        bias = self.padding(present)
        answers = []
        for layer in self.layers:
            tokens = layer(tokens, bias, weights)
            answers.append(self.trajectory(coefficients + self.head(tokens).view_as(coefficients)) + neck)
        return answers

    def coefficients(self, centred: Tensor) -> Tensor:
        """DCT over time of the padded trajectory (Eq. 1), ``(B, P, J, 3, F)``."""
        padded = torch.cat([centred, centred[:, -1:].expand(-1, self.config.horizon, -1, -1, -1)], 1)
        padded = padded.permute(0, 2, 3, 4, 1)
        return exact(padded, self.dct.T)

    def standardised(self, centred: Tensor) -> Tensor:
        """Coefficients in units of their spread over the training windows."""
        return (self.coefficients(centred) - self.mean) / self.deviation

    def fit_statistics(self, history: Tensor) -> None:
        """Take mean and spread of each coefficient from windows of the training set, ``(B, H, P, J, 3)``.

        All joints of the windows must have been seen.
        """
        values = self.coefficients(history - history[:, -1:, :, self.neck : self.neck + 1]).flatten(0, 3)
        self.mean.copy_(values.mean(0))
        # padding leaves high orders almost nothing to vary; the floor keeps a change of a millimetre small
        self.deviation.copy_(values.std(0).clamp(min=0.01))

    def trajectory(self, coefficients: Tensor) -> Tensor:
        """The future part of the trajectory (Eq. 3), ``(B, horizon, P, J, 3)``."""
        whole = exact(coefficients * self.deviation + self.mean, self.dct)
        return whole[..., self.config.history :].permute(0, 4, 1, 2, 3)

    def tokens(self, coefficients: Tensor, neck: Tensor, present: Tensor) -> Tensor:
        """Embedded tokens, ``(B, 3 P J, d)``."""
        batch, people = coefficients.shape[:2]
        content = self.embed(coefficients).flatten(2, 3)  # B, P, 3 J, d - g
        if self.config.embeddings:
            content = content + self.identity(people)
        cell = self.cell(neck, present)[:, :, None].expand(-1, -1, 3 * self.joints, -1)
        return torch.cat([content, cell], -1).view(batch, people * 3 * self.joints, self.config.width)

    def identity(self, people: int) -> Tensor:
        """What is added to tell joint and person, ``(1, P, 3 J, d - g)`` (Sec. 3.3)."""
        joint = self.joint.weight.repeat_interleave(self.repeats, 0)[None, None]
        # in training every row of the table gets to stand for somebody (Sec. 3.7: empty slots are permuted too)
        permuted = self.training and self.config.permuted
        rows = torch.randperm(self.config.people)[:people] if permuted else slice(people)
        person = self.person.weight[rows][None, :, None]
        if self.config.preset == "paper":
            return joint + person
        joint, person = shortened(joint), shortened(person)
        return torch.stack([joint.expand(1, people, -1, -1), person.expand(-1, -1, 3 * self.joints, -1)], -1).flatten(3)

    def cell(self, neck: Tensor, present: Tensor) -> Tensor:
        """Grid embedding of where each person's neck stands, ``(B, P, g)`` (Sec. 3.4)."""
        floor, cells = neck[..., :2], self.config.cells
        if self.config.preset == "release":
            share = ((floor + RELEASE_EXTENT_M) / (2 * RELEASE_EXTENT_M)).clamp(0, 1)
            index = (share * cells / cells).floor().long()
            return self.grid(index[..., 0]) + self.grid(index[..., 1] + cells)
        there = present[..., None].float()
        middle = (floor * there).sum(1, keepdim=True) / there.sum(1, keepdim=True).clamp(min=1)
        extent = self.config.extent_m
        index = ((floor - middle + extent) / (2 * extent) * cells).floor().clamp(0, cells - 1).long()
        return self.grid(index[..., 0] * cells + index[..., 1])

    def padding(self, present: Tensor) -> Tensor:
        """Added to the attention scores for the tokens of absent people, ``(B, 1, 1, 3 P J)``."""
        absent = (~present).float().repeat_interleave(3 * self.joints, 1)[:, None, None]
        return absent * (1.0 if self.config.preset == "release" else FAR)

    def loss(self, answers: list[Tensor], truth: Tensor, observed: Tensor) -> Tensor:
        """Eq. 4 over the future frames: weight 1 for the last layer, 0.2 for each of the others."""
        terms = [self.distance(answer, truth, observed) for answer in answers]
        if self.config.preset == "release":
            return (terms[-1] + 0.2 * sum(terms)) / (1 + 0.2 * len(terms))
        return terms[-1] + 0.2 * sum(terms[:-1])

    def distance(self, answer: Tensor, truth: Tensor, observed: Tensor) -> Tensor:
        """Mean distance of the joints, squared if the configuration says so."""
        if self.config.squared:
            return ((answer - truth).square().sum(-1) * observed).sum() / observed.sum().clamp(min=1)
        return mean_distance(answer, truth, observed)


def shortened(rows: Tensor) -> Tensor:
    """Rows of a table, at most of length 1."""
    return rows / rows.norm(dim=-1, keepdim=True).clamp(min=1)


def from_release(checkpoint: Mapping[str, Tensor], mean: Tensor, deviation: Tensor) -> dict[str, Tensor]:
    """The state of this model, ``release`` preset, from that of the authors' model.

    Their world has y up and ours z: their (x, y, z) are our (y, z, x), a turn, since no weight knows a heading. So
    rows of the joint table and the two halves of the grid change places.

    Args:
        checkpoint: The entry ``model`` of their file.
        mean: Mean of each coefficient; their code holds it, their checkpoints do not.
        deviation: Spread of each coefficient, from the same place.

    Raises:
        InputError: If it is the state of another model.

    Example:
        A checkpoint is read without running code that it may hold::

            state = torch.load("checkpoint.pth.tar", map_location="cpu", weights_only=True)["model"]
            model = SoMoFormer(SoMoFormerConfig.release())
            model.load_state_dict(from_release(state, mean, deviation))
    """
    state = {"mean": mean, "deviation": deviation}
    try:
        joint = checkpoint["double_id_encoder.learned_encoding.weight"].unflatten(0, (-1, 3))
        state["joint.weight"] = joint[:, [2, 0, 1]].flatten(0, 1)
        state["person.weight"] = checkpoint["double_id_encoder.person_encoding.weight"]
        state["grid.weight"] = torch.cat([checkpoint["y_embed.weight"], checkpoint["x_embed.weight"]])
        layers = sum(name.endswith(".norm1.bias") for name in checkpoint)
        for part in ("weight", "bias"):
            state[f"embed.{part}"], state[f"head.{part}"] = checkpoint[f"fc_in.{part}"], checkpoint[f"fc_out.{part}"]
            for layer in range(layers):
                for ours, theirs in RELEASE_LAYER.items():
                    state[f"layers.{layer}.{ours}.{part}"] = checkpoint[f"transformer.layers.{layer}.{theirs}{part}"]
    except KeyError as error:
        raise InputError(
            f"the checkpoint has no {error}; expected the state of the authors' SoMoFormer with a grid, which is the "
            'entry "model" of their file'
        ) from None
    frames = state["embed.weight"].shape[1]
    if not frames == len(mean) == len(deviation):
        raise InputError(
            f"the checkpoint reads {frames} coefficients; {len(mean)} means and {len(deviation)} deviations came"
        )
    return state


RELEASE_LAYER = {
    "project": "self_attn.in_proj_", "merge": "self_attn.out_proj.", "rise": "linear1.", "fall": "linear2.",
    "norm_attention": "norm1.", "norm_feed": "norm2.",
}  # fmt: skip
"""Names in a layer of ours, and theirs up to ``weight`` or ``bias``."""

MODEL, CONFIG = SoMoFormer, SoMoFormerConfig
