"""SAST, the scene-aware social transformer: ten seconds of several people in a furnished room, by diffusion.

Paper: Mueller, Tanke, Gall, "Massively Multi-Person 3D Human Motion Forecasting with Scene Context", 2024, Sec. 3.

The network looks at one person's noisy motion, in the person's own frame, and answers what it may look like without
the noise (Eq. 11). A U-Net over time reads it beside the history that was seen (Eq. 12). At its bottom, one token for
eight frames, a first transformer reads the objects and a second one the other people (Eq. 13). Everybody is denoised
at once; what the network makes of the others in one step is what it sees of them in the next (Eq. 10).

Three presets. ``paper`` is the text. ``release`` repeats what differs in the authors' public code: one random Fourier
code of the step for all blocks, places in time for the two decoders only, other people seen in the frame at hand
instead of up to it, empty object slots that are read, a loss in metres. ``motioncast``, the default, is ours:

- No layer looks ahead: norms are over the channels of a frame, and frames are doubled by repetition.
- Objects and people that are not there change nothing; what was seen of the others stays as it was seen.
- Another person is encoded once, in its own frame, and every observer adds where that person is as seen from here. The
  published network encodes each person again for each observer. A transformer among the others is gone: it would have
  to leave out the observer, and so run once for each.
- The noise is told by its log signal-to-noise ratio, so that nearby steps look alike (``nn/noise.py``).
- The answer is a displacement from the last pose, scaled by what a person can have done by then (``nn/scaling.py``):
  an untrained network holds the pose, and there is no jump at the seam.
- The schedule is shifted towards noise, where it is decided who walks where (``core/schedule.py``).
- Errors are squared: a sampler goes by the mean of what may come. An absolute error asks for the median, and where most
  people stand, that is to stand.
- Objects are told by exp(-distance) to the basis points: near things matter, and far ones do not drown them.

Shapes: B scenes, P people, Q of them denoised (the first ones; all in use, often one in training), H frames of
history, F of horizon, N = H + F, T tokens in time, J joints, G objects.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import torch
from torch import Tensor, nn

from motioncast.core.basis_points import POINTS, WIDTH
from motioncast.core.schedule import cosine_abar
from motioncast.core.skeletons import SKELETONS
from motioncast.nn.attention import EncoderLayer
from motioncast.nn.decoder import DecoderLayer
from motioncast.nn.frames import to_own, to_world
from motioncast.nn.gaps import fill_gaps
from motioncast.nn.hips import seen_from, stand_on_hips
from motioncast.nn.losses import mean_over
from motioncast.nn.noise import FourierCode, LevelCode
from motioncast.nn.scaling import Displacement, MinMax, apart_from_root
from motioncast.nn.sinusoids import sinusoids
from motioncast.nn.unet import ConvStyle, Decoder, Encoder

HEAD = 32
"""Channels of an attention head."""

SEEN_FROM = 5
"""Numbers that tell where another person is and looks."""

FAR = -1e9
"""Attention score of what is not there."""


@dataclass(frozen=True)
class SASTConfig:
    """Sizes of the model; the defaults are the paper's network.

    Attributes:
        skeleton: Name of the skeleton.
        history: Frames read, H.
        horizon: Frames answered, F. The published network answers 279, so that N = 304 can be halved three times.
        fps: Frames a second.
        preset: ``motioncast``, ``release`` or ``paper`` (see the module).
        channels: Of the U-Net's levels.
        others_channels: Of the encoder of other people.
        scene_width: Channels of a token of the scene transformer.
        scene_layers: Layers of its encoder and of its decoder.
        people_width: Channels of a token of the people transformer.
        people_layers: Its layers.
        conv_dropout: Share of dropped channels in training, in convolutions.
        dropout: The same, in transformers.
        steps: Steps of the diffusion.
        shift: Of its log signal-to-noise ratio (``core/schedule.py``).
        speed_share: Weight of the error of velocities, in metres a second, beside that of the scaled positions.
        scene: Whether objects are seen.
        others: Whether other people are seen.
    """

    skeleton: str = "mrt15"
    history: int = 25
    horizon: int = 250
    fps: float = 25.0
    preset: Literal["motioncast", "release", "paper"] = "motioncast"
    channels: tuple[int, ...] = (128, 256, 512)
    others_channels: tuple[int, ...] = (128, 128, 128)
    scene_width: int = 256
    scene_layers: int = 3
    people_width: int = 128
    people_layers: int = 2
    conv_dropout: float = 0.1
    dropout: float = 0.1
    steps: int = 1000
    shift: float = 0.0
    speed_share: float = 0.3
    scene: bool = True
    others: bool = True

    @property
    def published(self) -> bool:
        """Whether this is the network as published."""
        return self.preset != "motioncast"

    @property
    def frames(self) -> int:
        """Frames N that the network works on."""
        return self.history + self.horizon

    @property
    def tokens(self) -> int:
        """Tokens T at the bottom of the U-Net."""
        return -(-self.frames // self.stride)

    @property
    def stride(self) -> int:
        """Frames of a token."""
        return 2 ** len(self.channels)


PRESETS: dict[str, SASTConfig] = {
    "motioncast": SASTConfig(shift=-3.0),
    "light": SASTConfig(
        channels=(64, 128, 192),
        others_channels=(64, 64, 64),
        scene_width=128,
        scene_layers=2,
        conv_dropout=0.0,
        shift=-3.0,
    ),
    "release": SASTConfig(preset="release", skeleton="hik29", horizon=279, conv_dropout=0.2),
    "paper": SASTConfig(preset="paper", skeleton="hik29", horizon=279, conv_dropout=0.2),
}
"""Ours at the paper's size, ours for two CPU cores, and the published networks."""


class Reader(nn.Module):
    """Motion tokens that read a memory: a causal transformer decoder between two linear maps.

    Args:
        config: Sizes.
        width: Channels of a token within.
        layers: Decoder layers.
    """

    place: Tensor
    seen: Tensor

    def __init__(self, config: SASTConfig, width: int, layers: int) -> None:
        super().__init__()
        self.residual = not config.published
        self.inward = nn.Linear(config.channels[-1], width)
        self.drop = nn.Dropout(config.dropout)
        self.layers = nn.ModuleList(
            DecoderLayer(width, width // HEAD, 4 * width, config.dropout, norm_first=not config.published)
            for _ in range(layers)
        )
        self.norm = nn.LayerNorm(width)
        self.outward = nn.Linear(width, config.channels[-1])
        count = config.tokens
        self.register_buffer("place", sinusoids(torch.arange(count), width), persistent=False)
        self.register_buffer("seen", torch.full((count, count), FAR).triu(1), persistent=False)

    def forward(
        self, tokens: Tensor, memory: Tensor, bias: Tensor | None, placed: Sequence[Tensor] | None = None
    ) -> Tensor:
        """Tokens ``(N, T, channels)`` after reading; ``placed`` has an entry for each layer (``nn/decoder.py``)."""
        hidden = self.drop(self.inward(tokens) + self.place)
        for number, layer in enumerate(self.layers):
            hidden = layer(hidden, self.seen, memory, bias, placed[number] if placed else None)
        answer = self.outward(self.norm(hidden))
        return tokens + answer if self.residual else answer


class SceneTransformer(nn.Module):
    """Objects, encoded as a set, and motion that reads them.

    Args:
        config: Sizes.
    """

    def __init__(self, config: SASTConfig) -> None:
        super().__init__()
        self.config = config
        width = config.scene_width
        self.objects = nn.Linear(WIDTH, width)
        self.encoder = encoder_layers(config, width, config.scene_layers)
        self.norm = nn.LayerNorm(width)
        self.reader = Reader(config, width, config.scene_layers)

    def encode(self, codes: Tensor, there: Tensor) -> Tensor:
        """Objects ``(N, G, 2061)``, ``(N, G)`` of them there, to a memory ``(N, G, width)``."""
        if not self.config.published:
            codes = torch.cat([torch.exp(-codes[..., :POINTS]), codes[..., POINTS:]], -1)
        hidden = self.objects(codes)
        for layer in self.encoder:
            hidden = layer(hidden, hide(~there)[:, None, None])
        return self.norm(hidden)

    def forward(self, tokens: Tensor, memory: Tensor, there: Tensor) -> Tensor:
        """Tokens ``(N, T, channels)`` after reading the memory ``(N, G, width)``."""
        if not self.config.scene:
            memory, there = torch.zeros_like(memory), torch.zeros_like(there)
        if self.config.published:
            return self.reader(tokens, memory, None)
        bias = hide(with_nobody(~there, 1))
        return self.reader(tokens, with_nobody(memory, 1), bias[:, None, None])


class PeopleTransformer(nn.Module):
    """Motion that reads the other people, frame by frame: each as encoded once, and where it is as seen from here.

    Args:
        config: Sizes.
    """

    def __init__(self, config: SASTConfig) -> None:
        super().__init__()
        width = config.people_width
        self.people = nn.Linear(config.others_channels[-1], width)
        self.place = nn.Sequential(nn.Linear(SEEN_FROM, HEAD), nn.GELU())
        self.placed = nn.ModuleList(nn.Linear(HEAD, 2 * width) for _ in range(config.people_layers))
        self.reader = Reader(config, width, config.people_layers)

    def forward(self, tokens: Tensor, people: Tensor, places: Tensor, hidden: Tensor) -> Tensor:
        """Tokens after reading.

        Args:
            tokens: ``(B Q, T, channels)``.
            people: ``(B, T, P, others_channels)``.
            places: ``(B, Q, T, P, 5)``.
            hidden: Whom each one does not see, ``(B, Q, P)`` bool.
        """
        places = self.place(places)
        placed = [with_nobody(layer(places), 3) for layer in self.placed]
        bias = hide(with_nobody(hidden, 2)).flatten(0, 1)[:, None, None, None]
        return self.reader(tokens, with_nobody(self.people(people), 2), bias, placed)


class PublishedPeopleTransformer(nn.Module):
    """Motion that reads the other people, each as encoded in the reader's frame.

    The release lets people of one frame see one another: sets of people, one for each frame. The text lets everybody
    see all up to a frame.

    Args:
        config: Sizes.
    """

    def __init__(self, config: SASTConfig) -> None:
        super().__init__()
        self.by_frame = config.preset == "release"
        width = config.people_width
        self.people = nn.Linear(config.others_channels[-1], width)
        self.encoder = encoder_layers(config, width, config.people_layers)
        self.norm = nn.LayerNorm(width)
        self.reader = Reader(config, width, config.people_layers)

    def forward(self, tokens: Tensor, people: Tensor, hidden: Tensor) -> Tensor:
        """Tokens after reading.

        Args:
            tokens: ``(N, T, channels)``.
            people: The others of each, ``(N, T, K, others_channels)``.
            hidden: Who of them is not there, ``(N, K)`` bool; who sees nobody reads a zero.
        """
        count, frames, others, _ = people.shape
        memory, alone = self.people(people), hide(~hidden.all(1, keepdim=True))
        absent = hide(hidden)
        if self.by_frame:
            memory = memory.flatten(0, 1)
            among = absent.repeat_interleave(frames, 0)[:, None, None]
            bias = torch.cat([absent, alone], 1)[:, None, None, None]
        else:
            memory = (memory + self.reader.place[:, None]).flatten(1, 2)
            causal = self.reader.seen.repeat_interleave(others, 1)  # T, T K
            ahead = causal.repeat_interleave(others, 0)
            everyone = absent.repeat(1, frames)[:, None, None]
            among = everyone + ahead
            bias = torch.cat([everyone + causal, alone[:, None, None].expand(-1, -1, frames, -1)], -1)
        if others:
            for layer in self.encoder:
                memory = layer(memory, among)
            memory = self.norm(memory)
        if self.by_frame:
            memory = memory.unflatten(0, (count, frames))
        return self.reader(tokens, with_nobody(memory, memory.dim() - 2), bias)


class SAST(nn.Module):
    """Noisy futures of people in their own frames in, clean ones out.

    Args:
        config: Sizes.
    """

    abar: Tensor
    clock: Tensor

    def __init__(self, config: SASTConfig) -> None:
        super().__init__()
        self.config = config
        self.skeleton = SKELETONS[config.skeleton]
        self.joints = len(self.skeleton)
        pose, causal, published = 3 * self.joints, not config.published, config.published
        own_codes = config.preset == "paper"
        style = ConvStyle(5, config.conv_dropout, causal, own_codes)
        others_style = ConvStyle(3, config.conv_dropout, causal, own_codes)
        self.scaling = MinMax(self.joints) if published else Displacement(config.frames, self.joints)
        self.code = nn.Identity() if own_codes else FourierCode() if published else LevelCode()
        extra = 0 if published else 2
        self.encoder = Encoder(2 * pose + extra, config.channels, style)
        self.others_encoder = Encoder(pose + extra, config.others_channels, others_style, told=published)
        self.scene = SceneTransformer(config)
        self.people = PublishedPeopleTransformer(config) if published else PeopleTransformer(config)
        self.decoder = Decoder(config.channels, (2 if published else 1) * pose, style)
        if not published:  # untrained, the network holds the last pose
            self.decoder.silence()
        self.register_buffer("abar", torch.from_numpy(cosine_abar(config.steps, config.shift)), persistent=False)
        ahead = torch.arange(config.frames) - config.history + 1
        clock = torch.stack([(ahead <= 0).float(), (ahead.clamp(min=0) / config.horizon).sqrt()], -1)
        self.register_buffer("clock", clock, persistent=False)  # is this seen, and how far ahead is it

    def encode_objects(self, codes: Tensor, there: Tensor) -> Tensor:
        """What is known of the objects before the first step and for all of them.

        Args:
            codes: Each object as each denoised person sees it, ``(B, Q, G, 2061)``; an empty room has one empty slot.
            there: ``(B, G)`` bool.

        Returns:
            ``(B, Q, G, scene_width)``.
        """
        seers = codes.shape[1]
        memory = self.scene.encode(codes.flatten(0, 1), for_each(there, seers))
        return memory.view(-1, seers, codes.shape[2], self.config.scene_width)

    def forward(
        self,
        history: Tensor,
        observed: Tensor,
        noisy: Tensor,
        estimate: Tensor,
        level: Tensor,
        memory: Tensor,
        there: Tensor,
    ) -> tuple[Tensor, Tensor]:
        """One step: what the first Q people's futures look like without the noise.

        The published network was trained on noisy histories, and in use it sees its own word for the history of the
        others. Where ``noisy`` or ``estimate`` have N frames instead of F, theirs is the history that is seen.

        Args:
            history: ``(B, H, P, J, 3)`` metres, world, z up.
            observed: Who is there, ``(B, H, P)`` bool; who is not there in the last frame is not seen by others.
            noisy: Scaled, own frame, ``(B, Q, F or N, J, 3)``.
            estimate: What is taken for everybody's future, ``(B, F or N, P, J, 3)`` metres, world.
            level: How noisy it is (:meth:`level`), ``(B, Q)`` or one number.
            memory: Of :meth:`encode_objects`, ``(B, Q, G, scene_width)``.
            there: Which objects there are, ``(B, G)`` bool.

        Returns:
            The clean future, scaled, own frame, shaped as ``noisy``; and in metres in the world,
            ``(B, F or N, Q, J, 3)``.
        """
        config, asked = self.config, noisy.shape[1]
        history = fill_gaps(history, observed[..., None])
        origin, across = stand_on_hips(history[:, -1], self.skeleton)
        mine = origin[:, :asked], across[:, :asked]
        own = to_own(history[:, :, :asked], *mine).transpose(1, 2)  # B, Q, H, J, 3
        code = self.code(level.expand(own.shape[:2]).flatten())
        tokens, skips = self.encoder(self.padded(self.sequence(own, noisy)), code)
        tokens = self.scene(tokens, memory.flatten(0, 1), for_each(there, asked))
        whole = self.whole(history, estimate, 1)
        hidden = (~observed[:, -1])[:, None] | itself(asked, observed)
        if not config.others:
            hidden = torch.ones_like(hidden)
        if config.published:
            tokens = self.read_published(tokens, whole, mine, hidden, code)
        else:
            tokens = self.read_people(tokens, whole, (origin, across), mine, hidden)
        answer = self.decoder(tokens, skips, code)[:, -noisy.shape[2] :, : 3 * self.joints]
        clean = answer.view(-1, asked, noisy.shape[2], self.joints, 3)
        metres = self.scaling.to_metres(clean.float(), own[:, :, -1:], config.frames - noisy.shape[2])
        return clean, to_world(metres.transpose(1, 2), *mine)

    def sequence(self, own: Tensor, noisy: Tensor) -> Tensor:
        """What the U-Net reads: the noisy sequence and the clean history, held (Eq. 12), ``(B Q, N, channels)``."""
        config, last = self.config, own[:, :, -1:]
        noisy = self.whole(self.scaling.to_model(own, last, 0), noisy, 2)
        held = torch.cat([own, last.expand(-1, -1, config.horizon, -1, -1)], 2)
        if config.published:
            return torch.cat([noisy, self.scaling.to_model(held, last, 0)], 3).flatten(3).flatten(0, 1)
        return self.timed(torch.cat([noisy, held], 3).flatten(3).flatten(0, 1))

    def whole(self, history: Tensor, rest: Tensor, axis: int) -> Tensor:
        """All N frames: what was seen, then the rest, unless that is whole itself."""
        return rest if rest.shape[axis] == self.config.frames else torch.cat([history, rest], axis)

    def timed(self, sequences: Tensor) -> Tensor:
        """Sequences ``(n, N, channels)`` that also tell how far ahead each frame is."""
        return torch.cat([sequences, self.clock.expand(sequences.shape[0], -1, -1)], -1)

    def padded(self, sequences: Tensor) -> Tensor:
        """Sequences ``(n, N, channels)`` with their first frame repeated before them, to whole tokens."""
        more = self.config.tokens * self.config.stride - self.config.frames
        return torch.cat([sequences[:, :1].expand(-1, more, -1), sequences], 1) if more else sequences

    def read_people(
        self,
        tokens: Tensor,
        whole: Tensor,
        frames: tuple[Tensor, Tensor],
        mine: tuple[Tensor, Tensor],
        hidden: Tensor,
    ) -> Tensor:
        """Tokens after reading the others, each encoded once in its own frame."""
        config, (batch, _, people) = self.config, whole.shape[:3]
        motion = apart_from_root(to_own(whole, *frames)).transpose(1, 2).flatten(3).flatten(0, 1)
        features, _ = self.others_encoder(self.padded(self.timed(motion)))
        features = features.view(batch, people, config.tokens, config.others_channels[-1]).transpose(1, 2)
        now = self.padded(whole.flatten(2)).view(batch, -1, people, self.joints, 3)[:, :: config.stride]
        places = seen_from(*mine, *stand_on_hips(now, self.skeleton))
        return self.people(tokens, features, places, hidden)

    def read_published(
        self, tokens: Tensor, whole: Tensor, mine: tuple[Tensor, Tensor], hidden: Tensor, code: Tensor
    ) -> Tensor:
        """Tokens after reading the others, each encoded in the frame of each reader."""
        batch, frames, people = whole.shape[:3]
        asked = hidden.shape[1]
        others = all_but_itself(asked, people, whole.device)  # Q, K
        seen = [
            to_own(whole[:, :, row], mine[0][:, reader, None], mine[1][:, reader, None])
            for reader, row in enumerate(others)
        ]
        motion = torch.stack(seen, 1).permute(0, 1, 3, 2, 4, 5).reshape(-1, frames, 3 * self.joints)
        absent = torch.stack([hidden[:, reader, row] for reader, row in enumerate(others)], 1).flatten(0, 1)
        count = people - 1
        if not count:
            features = tokens.new_zeros(batch * asked, 0, self.config.tokens, self.config.others_channels[-1])
        else:
            features, _ = self.others_encoder(self.padded(motion), code.repeat_interleave(count, 0))
            features = features.unflatten(0, (batch * asked, count))
        return self.people(tokens, features.transpose(1, 2), absent)

    def scaled(self, history: Tensor, future: Tensor) -> Tensor:
        """A future ``(B, F, Q, J, 3)`` in metres as a clean answer of the network, ``(B, Q, F, J, 3)``."""
        frame = stand_on_hips(history[:, -1, : future.shape[2]], self.skeleton)
        own = to_own(torch.cat([history[:, -1:, : future.shape[2]], future], 1), *frame).transpose(1, 2)
        return self.scaling.to_model(own[:, :, 1:], own[:, :, :1], self.config.history)

    @torch.no_grad()
    def fit_statistics(self, motion: Tensor) -> None:
        """Fit the scaling.

        Args:
            motion: Whole windows of single people, ``(n, N, J, 3)`` metres, world.
        """
        history = self.config.history
        frame = stand_on_hips(motion[:, history - 1], self.skeleton)
        own = to_own(motion[:, :, None], *(part[:, None] for part in frame))[:, :, 0]
        self.scaling.fit(own, history)

    def level(self, step: Tensor) -> Tensor:
        """What the network is told of a step: its number as published, the log signal-to-noise ratio in ours."""
        if self.config.published:
            return step.float()
        return (self.abar.log() - torch.log1p(-self.abar))[step].float()

    def loss(
        self,
        positions: Tensor,
        observed: Tensor,
        codes: Tensor,
        there: Tensor,
        step: Tensor,
        noise: Tensor,
        estimate: Tensor | None = None,
    ) -> Tensor:
        """Error on the frames to come in which the person is there: Eq. 9, in ours squared and with that of velocities.

        Args:
            positions: ``(B, N, P, J, 3)`` metres, world; the first Q people are denoised.
            observed: Who is there, ``(B, N, P)`` bool; who leaves stays, for the others, where it was last seen.
            codes: Objects, ``(B, Q, G, 2061)``.
            there: ``(B, G)`` bool.
            step: Steps of the diffusion from 0, ``(B, Q)``.
            noise: Standard normal numbers, ``(B, Q, F, J, 3)``; the published network's has N frames.
            estimate: What is taken for the others' future, ``(B, F, P, J, 3)``. Default: what it will be, as published;
                in ours what the network itself makes of it (:meth:`guess`).
        """
        config, asked, frames = self.config, codes.shape[1], noise.shape[2]
        positions = held(positions, observed)
        history, future = positions[:, : config.history], positions[:, config.history :]
        frame = stand_on_hips(history[:, -1, :asked], self.skeleton)
        own = to_own(positions[:, :, :asked], *frame).transpose(1, 2)
        last = own[:, :, config.history - 1 : config.history]
        truth = self.scaling.to_model(own[:, :, -frames:], last, config.frames - frames)
        share = self.abar[step][..., None, None, None]
        noisy = (share.sqrt() * truth + (1 - share).sqrt() * noise).float()
        seen, level, memory = observed[:, : config.history], self.level(step), self.encode_objects(codes, there)
        if estimate is None:
            blind = config.published or not config.others
            estimate = future if blind else self.guess(history, seen, noisy, level, memory, there)
        clean, world = self(history, seen, noisy, estimate, level, memory, there)
        presence = observed[:, config.history :, :asked].float()  # B, F, Q
        if config.preset == "release":
            wrong = (world[:, -config.horizon :] - future[:, :, :asked]).abs()
            return (wrong.mean((-1, -2)) * presence).mean()
        size = torch.abs if config.published else torch.square
        wrong = size(clean - truth)[:, :, -config.horizon :].mean((-1, -2)).transpose(1, 2)
        error = mean_over(wrong, presence)
        if config.published:
            return error
        start = history[:, -1:, :asked]
        steps = (torch.cat([start, part], 1).diff(dim=1) for part in (world, future[:, :, :asked]))
        speed = size((next(steps) - next(steps)) * config.fps).mean((-1, -2))
        return error + config.speed_share * mean_over(speed, presence)

    @torch.no_grad()
    def guess(
        self, history: Tensor, observed: Tensor, noisy: Tensor, level: Tensor, memory: Tensor, there: Tensor
    ) -> Tensor:
        """What is seen of the others in use, ``(B, F, P, J, 3)``: never what they will really do.

        In the first step that they stand still, and later what the network made of them; half of the scenes each.
        """
        still = history[:, -1:].expand(-1, self.config.horizon, -1, -1, -1)
        foreseen = self(history, observed, noisy, still, level, memory, there)[1]
        foreseen = torch.cat([foreseen, still[:, :, foreseen.shape[2] :]], 2)
        first = torch.rand(len(history), 1, 1, 1, 1, device=history.device) < 0.5
        return torch.where(first, still, foreseen)


def encoder_layers(config: SASTConfig, width: int, layers: int) -> nn.ModuleList:
    """Encoder layers of the preset."""
    return nn.ModuleList(
        EncoderLayer(width, width // HEAD, 4 * width, config.dropout, norm_first=not config.published)
        for _ in range(layers)
    )


def hide(what: Tensor) -> Tensor:
    """Attention scores, to be added, of what is hidden."""
    return what.float() * FAR


def with_nobody(things: Tensor, axis: int) -> Tensor:
    """A zero, or a False, more at the end of an axis: who sees nothing reads it."""
    size = list(things.shape)
    size[axis] = 1
    return torch.cat([things, things.new_zeros(size)], axis)


def for_each(there: Tensor, seers: int) -> Tensor:
    """The objects of each scene ``(B, G)`` for each who sees them, ``(B Q, G)``."""
    return there[:, None].expand(-1, seers, -1).flatten(0, 1)


def itself(asked: int, observed: Tensor) -> Tensor:
    """Whether person k is i itself, ``(Q, P)``."""
    number = torch.arange(observed.shape[2], device=observed.device)
    return number[:asked, None] == number


def all_but_itself(asked: int, people: int, device: torch.device) -> Tensor:
    """For each of the first Q people the others, ``(Q, P - 1)``."""
    number = torch.arange(people - 1, device=device)
    return number + (number >= torch.arange(asked, device=device)[:, None])


def held(positions: Tensor, observed: Tensor) -> Tensor:
    """Positions ``(B, N, P, J, 3)`` in which who leaves stays where it was last seen."""
    frame = torch.arange(observed.shape[1], device=observed.device)[:, None]
    source = torch.where(observed, frame, 0).cummax(1).values
    return positions.gather(1, source[..., None, None].expand_as(positions))


MODEL, CONFIG = SAST, SASTConfig
