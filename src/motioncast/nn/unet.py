"""The U-Net over time of SAST: convolutions that halve the frames, and convolutions that double them again.

Sequences are ``(N, T, channels)``: the channels come last, so that a convolution is one product and a norm over
channels needs no transpose.

With ``causal``, a frame of any layer depends on no later frame. As published it does not hold: the convolutions look
back only, but the group norm averages over time and the interpolation looks one token ahead.
"""

from __future__ import annotations

from dataclasses import dataclass

import torch
from torch import Tensor, nn
from torch.nn import functional
from torch.nn.utils.parametrizations import weight_norm

from motioncast.nn.noise import CODE, FourierCode

GROUPS = 32
"""Groups of the published norm."""


@dataclass(frozen=True)
class ConvStyle:
    """What all convolutions of a U-Net share.

    Attributes:
        kernel: Frames that one sees.
        dropout: Share of dropped channels in training.
        causal: Norm over the channels of a frame and doubling by repetition; else as published, with normalised
            weights, group norm over time and doubling by interpolation.
        own_codes: Whether each block has its own random Fourier code of the step.
    """

    kernel: int = 5
    dropout: float = 0.2
    causal: bool = True
    own_codes: bool = False


class CausalConv(nn.Module):
    """A convolution over time that looks back only, ``(N, T, c)`` to ``(N, T / stride, d)``.

    Args:
        inward: Channels c.
        outward: Channels d.
        kernel: Frames that it sees: this one and those before it, zeros before the first.
        stride: Frames from one output to the next; the first sees up to frame 0.
        normed: Whether each output's weights have a length of their own, apart from their direction.
    """

    def __init__(self, inward: int, outward: int, kernel: int, stride: int = 1, *, normed: bool = False) -> None:
        super().__init__()
        self.kernel, self.stride = kernel, stride
        mix = nn.Linear(kernel * inward, outward)
        self.mix = weight_norm(mix) if normed else mix

    def forward(self, sequence: Tensor) -> Tensor:
        """The mixed sequence."""
        length = sequence.shape[1]
        padded = functional.pad(sequence, (0, 0, self.kernel - 1, 0))
        taps = [padded[:, tap : tap + length : self.stride] for tap in range(self.kernel)]
        return self.mix(torch.cat(taps, -1))


class GroupNormOverTime(nn.GroupNorm):
    """Group norm of a sequence ``(N, T, c)``: one mean for all frames."""

    def forward(self, input: Tensor) -> Tensor:
        """The normalised sequence."""
        return super().forward(input.transpose(1, 2)).transpose(1, 2)


class Unit(nn.Sequential):
    """Convolution, ReLU, norm, dropout."""

    def __init__(self, inward: int, outward: int, style: ConvStyle, stride: int = 1) -> None:
        super().__init__(
            CausalConv(inward, outward, style.kernel, stride, normed=not style.causal),
            nn.ReLU(),
            nn.LayerNorm(outward) if style.causal else GroupNormOverTime(GROUPS, outward),
            nn.Dropout(style.dropout),
        )


class StepBias(nn.Sequential):
    """What a block adds to every frame to tell the diffusion step."""

    def __init__(self, width: int, style: ConvStyle) -> None:
        super().__init__(*([FourierCode()] if style.own_codes else []), nn.Mish(), nn.Linear(CODE, width))

    def forward(self, input: Tensor) -> Tensor:
        """Codes ``(N, 64)``, or steps ``(N,)`` with ``own_codes``, to ``(N, 1, width)``."""
        return super().forward(input)[:, None]


class EncoderBlock(nn.Module):
    """Half the frames, and what the decoder takes over from before they were halved."""

    def __init__(self, inward: int, outward: int, style: ConvStyle, *, told: bool = True) -> None:
        super().__init__()
        self.unit = Unit(inward, outward, style)
        self.step = StepBias(outward, style) if told else None
        self.halve = Unit(outward, outward, style, stride=2)
        self.residual = CausalConv(inward, outward, kernel=1, stride=2)

    def forward(self, sequence: Tensor, code: Tensor | None = None) -> tuple[Tensor, Tensor]:
        """``(N, T, inward)`` to ``(N, T / 2, outward)`` and the skip ``(N, T, outward)``; ``code`` ``(N, 64)``."""
        skip = self.unit(sequence)
        hidden = skip if self.step is None else skip + self.step(code)
        return self.halve(hidden) + self.residual(sequence), skip


class DecoderBlock(nn.Module):
    """Two convolutions of what came from below and of the skip, and a residual; the last block's second one is bare."""

    def __init__(self, width: int, outward: int, style: ConvStyle, *, last: bool = False) -> None:
        super().__init__()
        self.unit = Unit(2 * width, width, style)
        self.step = StepBias(width, style)
        bare = CausalConv(width, outward, style.kernel, normed=not style.causal)
        self.finish = bare if last else Unit(width, outward, style)
        self.residual = CausalConv(2 * width, outward, kernel=1)

    def forward(self, below: Tensor, skip: Tensor, code: Tensor) -> Tensor:
        """Two sequences ``(N, T, width)`` to ``(N, T, outward)``."""
        both = torch.cat([skip, below], -1)
        return self.finish(self.unit(both) + self.step(code)) + self.residual(both)


class Encoder(nn.Module):
    """A block for each entry of ``channels``."""

    def __init__(self, inward: int, channels: tuple[int, ...], style: ConvStyle, *, told: bool = True) -> None:
        super().__init__()
        sizes = zip((inward, *channels[:-1]), channels, strict=True)
        self.blocks = nn.ModuleList(EncoderBlock(before, after, style, told=told) for before, after in sizes)

    def forward(self, sequence: Tensor, code: Tensor | None = None) -> tuple[Tensor, list[Tensor]]:
        """``(N, T, inward)`` to ``(N, T / 2 ** blocks, channels)`` and the skips, outermost first."""
        skips = []
        for block in self.blocks:
            sequence, skip = block(sequence, code)
            skips.append(skip)
        return sequence, skips


class Decoder(nn.Module):
    """The way back of an encoder of the same channels."""

    def __init__(self, channels: tuple[int, ...], outward: int, style: ConvStyle) -> None:
        super().__init__()
        self.causal = style.causal
        sizes = zip(channels[::-1], (*channels[-2::-1], outward), strict=True)
        self.blocks = nn.ModuleList(
            DecoderBlock(width, after, style, last=depth == len(channels))
            for depth, (width, after) in enumerate(sizes, 1)
        )

    def forward(self, sequence: Tensor, skips: list[Tensor], code: Tensor) -> Tensor:
        """``(N, T / 2 ** blocks, channels)`` to ``(N, T, outward)``."""
        for block, skip in zip(self.blocks, skips[::-1], strict=True):
            sequence = block(self.doubled(sequence), skip, code)
        return sequence

    def silence(self) -> None:
        """Answer with zeros until trained."""
        for name, parameter in self.blocks[-1].named_parameters():
            if name.startswith(("finish", "residual")):
                nn.init.zeros_(parameter)

    def doubled(self, sequence: Tensor) -> Tensor:
        """Twice the frames."""
        if self.causal:
            return sequence[:, :, None].expand(-1, -1, 2, -1).flatten(1, 2)
        return functional.interpolate(sequence.transpose(1, 2), scale_factor=2, mode="linear").transpose(1, 2)
