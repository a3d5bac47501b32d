"""Characteristic 3D poses: what somebody is about to do, as the pose in which it culminates, not as motion in time.

Paper: Diller, Funkhouser, Dai, "Forecasting Characteristic 3D Poses of Human Actions", CVPR 2022, Sec. 3.4 and 3.5.

A recurrent unit reads each joint's path. The joints to be predicted attend to those of the body and to the joints that
were predicted before (Eq. 3.1). What they gather is a small cube for each, from which convolutions make a heatmap over
2 m around the hip, told as one of ten levels a voxel, and an offset from every voxel to the joint. Joints are predicted
in three stages: the right hand, the left hand given the right one, all others given both.

Four presets. ``paper-grab`` and ``paper-h36m`` are three networks as the text has them, with 25 and 17 joints;
``release-grab`` and ``release-h36m`` repeat what differs in the authors' public code: heatmaps end in a sigmoid before
their cross entropy, and most levels carry no weight in it. ``light``, the default, is ours, for two CPU cores:

- One network for the three stages: it is told the stage, and sees no hand that is not yet known.
- A token, told how far the known hands are from where they were, also points to a few places around its joint's last
  one (``nn/bumps.py``); the decoders add their heat and offsets. Volumes alone need far more poses than there are.
- Volumes are 32 channels wide at 8 voxels an edge and 16 at 16; the last layer answers only for joints that are asked.
- What depends on the history alone is computed once for all hypotheses.
- The cube does not lean but turns with the person, so a scene that is turned has its answer turned; the hip's own row
  tells where the hip came from (``core/voxels.py``).
- A known hand carries the place of its joint in the body, as the joints of the body do.

Shapes: N histories, H hypotheses of each, B = N H, T frames, J joints, A asked joints, V voxels along an edge.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal, NamedTuple

import torch
from torch import Tensor, nn
from torch.nn import functional

from motioncast.nn.bumps import Bumps
from motioncast.nn.losses import mean_over
from motioncast.nn.voxels import (
    CLASSES,
    Block,
    JointHeads,
    class_weights,
    heat_classes,
    offsets_to,
)

HIDDEN = -1e9
"""Attention score of what is not to be seen."""

HOT = 5
"""Offsets are learned where prediction and target are of this class or above."""


@dataclass(frozen=True)
class CharacteristicPosesConfig:
    """Sizes of the model; the defaults are the light network.

    Attributes:
        preset: ``light``, ``paper`` or ``release`` (see the module).
        skeleton: Name of the skeleton.
        joints: Joints, J.
        hands: The joints predicted first and second: right and left hand.
        history: Frames read, T.
        fps: Frames a second.
        cells: Voxels along an edge of the heatmap; a token has a quarter of them, cubed, as channels.
        coarse: Light: channels at half of the voxels.
        fine: Light: channels at all of them.
        last: Light: channels before the last layers.
        bumps: Light: places that a token points to.
        dropout: Share of dropped numbers of the attention in training.
        actions: Labels of the action token; 0: none.
        partner: Whether the joints of a partner's last pose are tokens too (ours; light only).
    """

    preset: Literal["light", "paper", "release"] = "light"
    skeleton: str = "h36m17"
    joints: int = 17
    hands: tuple[int, int] = (16, 13)
    history: int = 10
    fps: float = 30.0
    cells: int = 16
    coarse: int = 32
    fine: int = 16
    last: int = 32
    bumps: int = 8
    dropout: float = 0.25
    actions: int = 0
    partner: bool = False
    horizon: int = field(default=1, init=False)

    @property
    def width(self) -> int:
        """Channels of a token: a cube of a quarter of the voxels along an edge."""
        return (self.cells // 4) ** 3


GRAB = {"joints": 25, "hands": (4, 7)}
H36M = {"joints": 17, "hands": (16, 13), "fps": 25.0}
PRESETS: dict[str, CharacteristicPosesConfig] = {
    "light": CharacteristicPosesConfig(),
    "paper-grab": CharacteristicPosesConfig("paper", **GRAB),
    "paper-h36m": CharacteristicPosesConfig("paper", **H36M),
    "release-grab": CharacteristicPosesConfig("release", **GRAB),
    "release-h36m": CharacteristicPosesConfig("release", **H36M),
    "tiny": CharacteristicPosesConfig(cells=8, coarse=8, fine=8, last=8, bumps=3),
}
"""Ours for two CPU cores, the published networks on both data sets, and a toy for tests."""


class Prediction(NamedTuple):
    """What a stage says of the joints that were asked for.

    Attributes:
        heat: Scores of the levels in each voxel, ``(B, A, 10, V, V, V)``.
        coarse: The same at half of the voxels, for the loss only.
        offsets: From each voxel's lower corner to the joint, ``(B, A, 3, V, V, V)`` metres; None if not asked for.
    """

    heat: Tensor
    coarse: Tensor
    offsets: Tensor | None


class CharacteristicPoses(nn.Module):
    """Heatmaps and offsets of the joints of a stage.

    Args:
        config: Sizes.
    """

    fine_weights: Tensor
    coarse_weights: Tensor

    def __init__(self, config: CharacteristicPosesConfig) -> None:
        super().__init__()
        self.config = config
        rest = [joint for joint in range(config.joints) if joint not in config.hands]
        self.stages = ([config.hands[0]], [config.hands[1]], rest)
        if config.preset == "light":
            networks: list[nn.Module] = [LightNetwork(config)]
        else:
            networks = [StageNetwork(config, len(joints), known) for known, joints in enumerate(self.stages)]
        self.networks = nn.ModuleList(networks)
        self.only_offsets = False
        release = config.preset == "release"
        for name, cells in (("fine_weights", config.cells), ("coarse_weights", config.cells // 2)):
            self.register_buffer(name, class_weights(cells, release), persistent=False)

    def forward(
        self,
        history: Tensor,
        known: Tensor,
        stage: int,
        asked: Tensor | None = None,
        partner: Tensor | None = None,
        action: Tensor | None = None,
        *,
        heat_only: bool = False,
    ) -> Prediction:
        """Predict the joints of a stage.

        Args:
            history: ``(N, T, J, 3)`` metres, hip-centred (``core.voxels.hip_centred``).
            known: Both hands of each hypothesis, ``(N, H, 2, 3)``; a stage reads those of the stages before.
            stage: 0, 1 or 2.
            asked: Light: the joints that are wanted, ``(A,)``. Default: those of the stage.
            partner: The partner's last pose around this person's hip, ``(N, J, 3)``, NaN of who has none.
            action: Label of the action, ``(N,)``.
            heat_only: Leave the offsets out.
        """
        if self.config.preset != "light":
            return self.networks[stage](history, known, action, heat_only=heat_only)
        asked = torch.tensor(self.stages[stage], device=history.device) if asked is None else asked
        now = torch.tensor(stage, device=history.device)
        return self.networks[0](history, known, now, asked, partner, action, heat_only=heat_only)

    def loss(
        self,
        history: Tensor,
        target: Tensor,
        stage: int,
        asked: Tensor | None = None,
        partner: Tensor | None = None,
        action: Tensor | None = None,
    ) -> Tensor:
        """The loss of a stage that is told the true hands: of heatmaps, after :meth:`learn_offsets` of offsets.

        Args:
            history: ``(N, T, J, 3)`` metres, hip-centred.
            target: The characteristic pose, ``(N, J, 3)``, hip-centred.
            stage: 0, 1 or 2.
            asked: Light: the joints that are wanted, ``(A,)``.
            partner: See :meth:`forward`.
            action: See :meth:`forward`.
        """
        hands = target[:, None, list(self.config.hands)]
        joints = self.stages[stage] if asked is None else asked
        said = self(history, hands, stage, asked, partner, action, heat_only=not self.only_offsets)
        if self.only_offsets:
            return self.offset_loss(said, target[:, joints])
        return self.heat_loss(said, target[:, joints]) + self.coarse_loss(said, target[:, joints])

    def heat_loss(self, said: Prediction, target: Tensor) -> Tensor:
        """Cross entropy of the levels (Sec. 3.4.1), for targets ``(B, A, 3)``."""
        return level_entropy(said.heat, heat_classes(target, self.config.cells), self.fine_weights)

    def coarse_loss(self, said: Prediction, target: Tensor) -> Tensor:
        """The same at half of the voxels."""
        return level_entropy(said.coarse, heat_classes(target, self.config.cells // 2), self.coarse_weights)

    def offset_loss(self, said: Prediction, target: Tensor) -> Tensor:
        """Absolute error of offsets where both heatmaps are hot; zero where they never are."""
        assert said.offsets is not None
        cells = self.config.cells
        hot = (said.heat.argmax(2) >= HOT) & (heat_classes(target, cells) >= HOT)
        error = (said.offsets - offsets_to(target, cells)).abs().mean(2)
        return mean_over(error, hot)

    def learn_offsets(self) -> None:
        """From now on only the offsets learn; all else stays as it is, statistics of batches included."""
        self.only_offsets = True
        for name, parameter in self.named_parameters():
            parameter.requires_grad_("offset" in name)
        self.train(self.training)

    def train(self, mode: bool = True) -> CharacteristicPoses:
        """Set the mode of training; in the second phase that of the offsets alone."""
        super().train(mode)
        if mode and self.only_offsets:
            for network in self.networks:
                for name, part in network.named_children():
                    part.train("offset" in name)
        return self


class JointAttention(nn.Module):
    """Joints look at joints: one head of scaled dot products, without biases (Eq. 3.1).

    Args:
        width: Channels of a token.
        queries: Joints that look.
        dropout: Share of dropped numbers in training.
    """

    def __init__(self, width: int, queries: int, dropout: float) -> None:
        super().__init__()
        self.ask, self.show, self.tell, self.merge = (nn.Linear(width, width, bias=False) for _ in range(4))
        self.norm = nn.LayerNorm([queries, width], eps=1e-6)
        self.drop = nn.Dropout(dropout)

    def forward(self, queries: Tensor, tokens: Tensor, bias: Tensor | None = None) -> Tensor:
        """``(B, queries, width)`` that have looked at ``(B, tokens, width)``; ``bias`` is added to the scores."""
        scores = self.ask(queries) @ self.show(tokens).transpose(-1, -2) * queries.shape[-1] ** -0.5
        if bias is not None:
            scores = scores + bias
        mixed = self.drop(scores.softmax(-1)) @ self.tell(tokens)
        return self.norm(queries + self.drop(self.merge(mixed)))


class Tokens(nn.Module):
    """A token for each joint's path: the last state of a recurrent unit.

    Args:
        width: Channels of a token.
    """

    def __init__(self, width: int) -> None:
        super().__init__()
        self.read = nn.GRU(3, width, batch_first=True)

    def forward(self, paths: Tensor) -> Tensor:
        """``(B, T, joints, 3)`` to ``(B, joints, width)``."""
        count, _, joints, _ = paths.shape
        _, last = self.read(paths.transpose(1, 2).reshape(count * joints, -1, 3))
        return last[0].view(count, joints, -1)


class StageNetwork(nn.Module):
    """One published network, for one stage.

    Args:
        config: Sizes.
        predicted: Joints of the stage.
        known: Joints of the stages before.
    """

    def __init__(self, config: CharacteristicPosesConfig, predicted: int, known: int) -> None:
        super().__init__()
        self.config, self.predicted, self.known = config, predicted, known
        width, heat = config.width, predicted * CLASSES
        self.body = Tokens(width)
        self.prior = Tokens(width) if known else None
        self.action = nn.Embedding(config.actions, width) if config.actions else None
        self.attention = JointAttention(width, predicted, config.dropout)
        self.heat_head = nn.Sequential(
            Block(predicted, 32, doubling=True), Block(32, 32), Block(32, 32), Block(32, heat)
        )
        self.heat_tail = nn.Sequential(
            Block(heat, 32, doubling=True), Block(32, 32), Block(32, 32), Block(32, 128), Block(128, heat, ramp=False)
        )
        self.offset_head = nn.Sequential(
            Block(predicted, 32, doubling=True), *(Block(32, 32) for _ in range(3)), Block(32, 32, doubling=True)
        )
        self.offset_tail = nn.Sequential(
            Block(32 + 3 * config.joints, 32), Block(32, 32), Block(32, 32), nn.Conv3d(32, 3 * predicted, 3, padding=1)
        )
        hands = list(config.hands)
        self.queries = hands[known : known + 1] if known < 2 else [j for j in range(config.joints) if j not in hands]

    def forward(
        self, history: Tensor, known: Tensor, action: Tensor | None = None, *, heat_only: bool = False
    ) -> Prediction:
        """See :meth:`CharacteristicPoses.forward`."""
        config, hypotheses = self.config, known.shape[1]
        history = history.repeat_interleave(hypotheses, 0)
        body = placed(self.body(history), range(config.joints))
        tokens = [body]
        if self.prior is not None:
            tokens.append(self.prior(known.flatten(0, 1)[:, None, : self.known]))
        if self.action is not None:
            assert action is not None
            tokens.append(self.action(action).repeat_interleave(hypotheses, 0)[:, None])
        latent = self.attention(body[:, self.queries], torch.cat(tokens, 1))
        cube = as_cubes(latent, config)
        coarse = self.heat_head(cube)
        heat = self.heat_tail(coarse)
        if config.preset == "release":
            heat = heat.sigmoid()
        each = (self.predicted, -1)
        offsets = None
        if not heat_only:
            volume = offsets_to(history[:, -1], config.cells).flatten(1, 2)
            offsets = self.offset_tail(torch.cat([self.offset_head(cube), volume], 1)).unflatten(1, each)
        return Prediction(heat.unflatten(1, each), coarse.unflatten(1, each), offsets)


class LightNetwork(nn.Module):
    """One network for the three stages.

    Args:
        config: Sizes.
    """

    def __init__(self, config: CharacteristicPosesConfig) -> None:
        super().__init__()
        self.config = config
        width, joints, coarse, fine = config.width, config.joints, config.coarse, config.fine
        self.body, self.prior = Tokens(width), Tokens(width)
        self.stage = nn.Embedding(3, width)
        self.action = nn.Embedding(config.actions, width) if config.actions else None
        self.attention = JointAttention(width, joints, config.dropout)
        self.pointers = Bumps(width + 6, config.bumps, config.cells)
        self.head = nn.Sequential(Block(joints, coarse, doubling=True), Block(coarse, coarse), Block(coarse, coarse))
        self.tail = nn.Sequential(Block(coarse, fine, doubling=True), Block(fine, fine), Block(fine, config.last))
        self.coarse_heads = JointHeads(coarse, joints, CLASSES)
        self.heads = JointHeads(config.last, joints, CLASSES)
        self.offset_head = nn.Sequential(
            Block(joints, fine, doubling=True), Block(fine, fine), Block(fine, fine, doubling=True)
        )
        self.offset_volume = nn.Conv3d(3 * joints, fine, 3, padding=1, bias=False)
        self.offset_tail = nn.Sequential(Block(fine, fine), Block(fine, config.last))
        self.offset_heads = JointHeads(config.last, joints, 3)
        nn.init.zeros_(self.offset_heads.weight)
        nn.init.zeros_(self.offset_heads.bias)

    def forward(
        self,
        history: Tensor,
        known: Tensor,
        stage: Tensor,
        asked: Tensor,
        partner: Tensor | None = None,
        action: Tensor | None = None,
        *,
        heat_only: bool = False,
    ) -> Prediction:
        """See :meth:`CharacteristicPoses.forward`."""
        config, hypotheses = self.config, known.shape[1]
        body = placed(self.body(history), range(config.joints))
        tokens, hidden = [body], [torch.zeros_like(body[..., 0])]
        if config.partner:
            assert partner is not None
            there = ~partner.isnan().any(-1)
            tokens.append(placed(self.prior(partner.nan_to_num(0.0)[:, None]), range(config.joints)))
            hidden.append(torch.where(there, 0.0, HIDDEN))
        if self.action is not None:
            assert action is not None
            tokens.append(self.action(action)[:, None])
            hidden.append(torch.zeros_like(tokens[-1][..., 0]))
        hands = placed(self.prior(known.flatten(0, 1)[:, None]), config.hands)
        order = torch.arange(2, device=known.device)
        unknown = torch.where(order < stage, 0.0, HIDDEN).expand(hands.shape[:2])
        each = torch.cat([*(part.repeat_interleave(hypotheses, 0) for part in tokens), hands], 1)
        bias = torch.cat([*(part.repeat_interleave(hypotheses, 0) for part in hidden), unknown], 1)
        latent = self.attention(each[:, : config.joints] + self.stage(stage), each, bias[:, None])
        cube = as_cubes(latent, config)
        at_half = self.head(cube)
        last = history[:, -1].repeat_interleave(hypotheses, 0)
        moved = (known.flatten(0, 1) - last[:, list(config.hands)]) * (order < stage)[:, None]
        told = torch.cat([latent[:, asked], moved.flatten(1)[:, None].expand(-1, asked.shape[0], -1)], -1)
        height, levels, place = self.pointers(told, last[:, asked])
        pointed = (levels @ height).unflatten(-1, (config.cells,) * 3)
        offsets = None
        if not heat_only:
            volume = self.offset_volume(offsets_to(history[:, -1], config.cells).flatten(1, 2))
            offsets = self.offset_tail(self.offset_head(cube) + volume.repeat_interleave(hypotheses, 0))
            offsets = self.offset_heads(offsets, asked) + self.pointers.offsets(height, place)
        return Prediction(self.heads(self.tail(at_half), asked) + pointed, self.coarse_heads(at_half, asked), offsets)


def placed(tokens: Tensor, joints: range | tuple[int, ...]) -> Tensor:
    """Tokens ``(B, joints, width)`` with the place of their joint in the body (the published code of a place)."""
    width = tokens.shape[-1]
    channel = torch.arange(width, device=tokens.device)
    place = torch.tensor(list(joints), device=tokens.device)[:, None]
    # twice the channel where the usual code has the channel: as published
    angle = place / 10000 ** (2 * channel / width)
    return tokens * width**0.5 + torch.where(channel % 2 == 0, angle.sin(), angle.cos())


def as_cubes(latent: Tensor, config: CharacteristicPosesConfig) -> Tensor:
    """Tokens ``(B, joints, width)`` as one small volume each, ``(B, joints, v, v, v)``."""
    edge = config.cells // 4
    return latent.unflatten(-1, (edge, edge, edge))


def level_entropy(scores: Tensor, levels: Tensor, weights: Tensor) -> Tensor:
    """Weighted cross entropy of scores ``(B, A, 10, V, V, V)`` for levels ``(B, A, V, V, V)``, mean over voxels."""
    return functional.cross_entropy(scores.flatten(0, 1).float(), levels.flatten(0, 1), weights)


MODEL, CONFIG = CharacteristicPoses, CharacteristicPosesConfig
