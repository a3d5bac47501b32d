"""SoMoFormer, our own fast variant: a token a joint, and a token for each other person as seen from here.

Joints as tokens, the padded trajectory, the residual in DCT space and one pass for all frames are SoMoFormer's
(``models/somoformer.py``). What differs, and why:

- One token a joint instead of one a coordinate: a third of the tokens, a ninth of the attention.
- Each person is described in its own frame (pelvis in the last frame of history, heading of hips and
  shoulders). Moving or turning the scene moves and turns the answer, exactly, and no training is spent on it.
- A person's tokens attend to one another and to one token for each other person, which holds that person's
  motion in the frame of the one who looks. Distance and bearing are in it, so no grid is needed; there is no
  person embedding, so re-ordering people re-orders the answer; there are no slots, so absent people change
  nothing.
- A trained model answers with the mean of the scene's future and of its mirror image's, mirrored back: left and
  right are alike to it, exactly, and what it made up about one of them is halved.

Shapes: B scenes, H frames of history, F frames of horizon, P people, J joints, d channels. Inside, motion has its
coordinates before its joints and its frames last, so that long rows of numbers are computed with alike, and a person
of a scene is a row of its own.
"""

from __future__ import annotations

from dataclasses import dataclass

import torch
from torch import Tensor, nn
from torch.nn import functional

from motioncast.core.skeletons import SKELETONS
from motioncast.nn.attention import EncoderLayer
from motioncast.nn.dct import dct_matrix, exact
from motioncast.nn.frames import TURNING_BACK, root_joints, stand
from motioncast.nn.gaps import fill_gaps
from motioncast.nn.losses import LIMBS, mean_distance, with_true_lengths

SEAM_FADES = 0.7
"""What is left of a disagreement at the seam after each frame."""

FAR = -1e9
"""Attention score of a token that is not there."""


@dataclass(frozen=True)
class SoMoFormerFastConfig:
    """Sizes of the model.

    Attributes:
        skeleton: Name of the skeleton.
        history: Frames read.
        horizon: Frames answered.
        fps: Frames a second.
        width: Channels d of a token.
        layers: Encoder layers.
        heads: Attention heads.
        feed_forward: Hidden channels of the feed-forward nets.
        coefficients: DCT coefficients of the answer that are predicted; higher ones stay those of the padding.
        dropout: Share of dropped channels in training.
        path_share: How much of the path that it foresees the trained model believes; the rest stands still.
        seam_share: How much of the last step's motion the first step of the answer must keep.
        mirrored: Whether a trained model also looks at the mirror image.
    """

    skeleton: str = "mrt15"
    history: int = 15
    horizon: int = 45
    fps: float = 15.0
    width: int = 192
    layers: int = 4
    heads: int = 8
    feed_forward: int = 768
    coefficients: int = 30
    dropout: float = 0.1
    path_share: float = 1.0
    seam_share: float = 0.0
    mirrored: bool = False


class SoMoFormerFast(nn.Module):
    """World-frame history with masks in, world-frame future of all people out."""

    answer: Tensor
    flip: Tensor
    turns: Tensor

    def __init__(self, config: SoMoFormerFastConfig) -> None:
        super().__init__()
        self.config = config
        skeleton = SKELETONS[config.skeleton]
        self.skeleton = skeleton
        self.joints = len(skeleton)
        self.limbs = [(joint, parent) for joint, parent in skeleton.bones if skeleton.names[joint].endswith(LIMBS)]
        self.root = root_joints(skeleton)
        self.order = list(skeleton.mirror())
        self.pace = config.fps / 2  # steps in units of 2 m/s
        h, d = config.history, config.width
        self.embed = nn.Linear(3 + 3 * h + 3 * (h - 1) + h, d)
        self.joint = nn.Parameter(torch.randn(self.joints, d) * 0.02)
        self.see = nn.Sequential(nn.Linear(6 * h * self.joints, d), nn.GELU(), nn.Linear(d, d))
        self.other = nn.Parameter(torch.randn(d) * 0.02)
        self.layers = nn.ModuleList(
            EncoderLayer(d, config.heads, config.feed_forward, config.dropout, norm_first=True)
            for _ in range(config.layers)
        )
        self.norm = nn.LayerNorm(d)
        self.head = nn.Linear(d, 3 * config.coefficients)
        nn.init.zeros_(self.head.weight)  # untrained, the model repeats the last pose
        nn.init.zeros_(self.head.bias)
        # coefficients -> the future part of the padded trajectory's change
        answer = dct_matrix(h + config.horizon)[: config.coefficients, h:]
        self.register_buffer("answer", answer, persistent=False)
        self.register_buffer("flip", torch.tensor([-1.0, 1.0, 1.0])[:, None, None], persistent=False)
        self.register_buffer("turns", TURNING_BACK, persistent=False)

    def forward(self, history: Tensor, observed: Tensor, weights: list[Tensor] | None = None) -> Tensor:
        """The future of all people.

        Args:
            history: ``(B, H, P, J, 3)`` metres, world, z up.
            observed: ``(B, H, P, J)`` bool.
            weights: If given, each layer's attention ``(B * P, heads, J + P, J + P)`` is appended to it; the last
                layer's has the rows of the joints only. With ``mirrored``, B counts scenes and images.

        Returns:
            ``(B, F, P, J, 3)`` metres, world.
        """
        motion = fill_gaps(history, observed).permute(0, 2, 4, 3, 1)
        mirrored = self.config.mirrored and not self.training
        if mirrored:
            motion = torch.cat([motion, self.mirror(motion)])
            observed = torch.cat([observed, observed[..., self.order]])
        future, coordinates = self.future(motion, observed, weights), (3, self.joints, self.config.horizon)
        if mirrored:
            future, image = future.view(2, -1, *coordinates).unbind()
            future = (future + self.mirror(image)) / 2
        return future.view(-1, history.shape[2], *coordinates).permute(0, 4, 1, 3, 2)

    def mirror(self, motion: Tensor) -> Tensor:
        """Motion ``(..., 3, J, T)`` as a mirror shows it: x turned over, left and right joints exchanged."""
        return motion[..., self.order, :] * self.flip

    def future(self, motion: Tensor, observed: Tensor, weights: list[Tensor] | None = None) -> Tensor:
        """The future ``(B * P, 3, J, F)`` of all people from a motion ``(B, P, 3, J, H)`` without gaps."""
        h, f, joints = self.config.history, self.config.horizon, self.joints
        rows = motion.reshape(-1, 3, joints, h)
        origin, heading = stand(rows[..., -1].transpose(1, 2), self.skeleton)
        share = torch.cat([heading, torch.ones_like(heading[:, :1])], 1)  # of each matrix of the turn
        back = exact(share, self.turns.flatten(1)).view(-1, 3, 3)
        own = exact(back, (rows - origin[..., None, None]).reshape(-1, 3, joints * h)).view(-1, 3, joints, h)
        others = self.others_as_seen(motion, origin, share, back)
        tokens, bias = torch.cat([self.own_tokens(own, observed), others], 1), self.presence(observed)
        for number, layer in enumerate(self.layers, 1):
            last = number == len(self.layers)  # whose tokens of other people nobody reads
            tokens = layer(tokens, bias, weights, joints if last else None)
        coefficients = self.head(self.norm(tokens).flatten(0, 1)).view(-1, joints, 3, self.config.coefficients)
        change = exact(coefficients.transpose(1, 2), self.answer)
        if not self.training:
            change = self.tempered(change, own[..., -1:] - own[..., -2:-1])
        future = (own[..., -1:] + change).view(-1, 3, joints * f)
        return (exact(back.transpose(1, 2), future) + origin[..., None]).view(-1, 3, joints, f)

    def tempered(self, change: Tensor, step: Tensor) -> Tensor:
        """The change of a trained model, less sure of itself where validation takes say so.

        On takes that it has not seen a model overrates the paths that it foresees, and its first step does not
        quite go on with the last one seen; that disagreement is made good in part and fades within half a second.

        Args:
            change: Displacement from the last pose, ``(B * P, 3, J, F)``.
            step: The last step that was seen, ``(B * P, 3, J, 1)``.
        """
        path = change[..., self.root, :].mean(-2, keepdim=True)
        change = change - (1 - self.config.path_share) * path
        fading = SEAM_FADES ** torch.arange(self.config.horizon, device=change.device, dtype=change.dtype)
        return change + self.config.seam_share * (step - change[..., :1]) * fading

    def loss(self, answer: Tensor, truth: Tensor, observed: Tensor) -> Tensor:
        """Mean distance of the joints, the error that is reported, with bones as they came and with true ones."""
        rigid = with_true_lengths(answer, truth, self.limbs)
        return 0.5 * (mean_distance(answer, truth, observed) + mean_distance(rigid, truth, observed))

    def own_tokens(self, own: Tensor, observed: Tensor) -> Tensor:
        """A token a joint from its trajectory in the person's frame, ``(B * P, J, d)``."""
        h, last = self.config.history, own[..., -1:]
        steps = (own[..., 1:] - own[..., :-1]) * self.pace
        features = torch.cat([last, (own - last) * 2, steps], -1).permute(0, 2, 3, 1).reshape(-1, 6 * h)
        seen = observed.permute(0, 2, 3, 1).reshape(-1, h).float()
        return self.embed(torch.cat([features, seen], -1)).view(-1, self.joints, self.config.width) + self.joint

    def others_as_seen(self, motion: Tensor, origin: Tensor, share: Tensor, back: Tensor) -> Tensor:
        """A token for each person k as person i sees it, ``(B * P of i, P of k, d)``.

        A pair needs a product of its own for where k is, which goes through a tanh. The steps of k are only turned,
        and a turn is a weighted sum: they are multiplied once a person, and summed for each pair.

        Args:
            motion: ``(B, P, 3, J, H)``.
            origin: Where each person stands, ``(B * P, 3)``.
            share: What each of the turning matrices counts for it, ``(B * P, 3)``.
            back: Their sum, ``(B * P, 3, 3)``.
        """
        people, h, n, width = motion.shape[1], self.config.history, self.joints, self.config.width
        first, rest = self.see[0], self.see[1:]
        assert isinstance(first, nn.Linear)
        weight = first.weight.view(width, 2 * h, n, 3).transpose(1, 3)
        of_path, of_steps, of_pose = (part.flatten(1) for part in weight.split([h, h - 1, 1], 3))
        # far people differ by their bearing, not by kilometres
        path = torch.tanh(self.seen(motion.reshape(-1, people, 3, n * h), origin, back / 3))
        pose = torch.tanh(self.seen(motion[..., -1], origin, back))
        steps = ((motion[..., 1:] - motion[..., :-1]) * self.pace).reshape(-1, 3, n * (h - 1))
        turned = exact(self.turns.flatten(0, 1), steps).view(-1, 3 * n * (h - 1))
        parts = functional.linear(turned, of_steps).view(-1, people, 3, width).transpose(1, 2)
        moving = (share.reshape(-1, people, 3) @ parts.reshape(-1, 3, people * width)).view(-1, width)
        tokens = functional.linear(path, of_path, first.bias) + functional.linear(pose, of_pose) + moving
        return rest(tokens).view(-1, people, width) + self.other

    def seen(self, places: Tensor, origin: Tensor, back: Tensor) -> Tensor:
        """Places ``(B, P of k, 3, n)`` as each person i sees them, ``(B * P of i * P of k, 3 n)``."""
        people, count = places.shape[1], places.shape[3]
        apart = places.transpose(1, 2).reshape(-1, 1, 3, people * count) - origin.reshape(-1, people, 3, 1)
        turned = exact(back, apart.reshape(-1, 3, people * count)).view(-1, 3, people, count)
        return turned.transpose(1, 2).reshape(-1, 3 * count)

    def presence(self, observed: Tensor) -> Tensor:
        """Added to the scores: nobody attends to absent people, nor to itself as another, ``(B * P, 1, 1, J + P)``."""
        batch, _, people, _ = observed.shape
        absent = ~observed[:, -1].any(-1)
        number = torch.arange(people, device=observed.device)
        itself = number[:, None] == number
        hidden = absent[:, None, :] | itself
        joints = torch.zeros(batch, people, self.joints, dtype=torch.bool, device=observed.device)
        return torch.cat([joints, hidden], 2).float().flatten(0, 1)[:, None, None] * FAR


MODEL, CONFIG = SoMoFormerFast, SoMoFormerFastConfig
