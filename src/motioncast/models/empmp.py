"""EMPMP: linear layers over time for each person and for all of them, which speak to one another now and then.

Paper: Zheng, Yu, Sun, "Efficient Multi-Person Motion Prediction by Lightweight Spatial and Temporal Interactions",
2025, Sec. 3.

siMLPe's blocks (a linear layer over time and a norm over coordinates, added to the input) run in a local branch on
each person's history and in a global branch on those of all people, put one after another. After every ``interval``
local blocks the branches meet: the global one scales and shifts the local one, an embedding of the distances between
the people is added to it, and the local one is added to the global one. There is no activation. The history goes in as
DCT coefficients over time; each coefficient comes out as one, or as three from 15 frames to 45, and the inverse DCT of
the answer's length gives the change from the last pose. The release's trainer for 15 to 45 frames has no DCT.

What differs here:

- The layers of the global branch are made for a number of people. Of fewer, the last places hold zeros; more are
  answered in groups, in the order in which they come. People who are not there in the last frame take no place.
- A scene is centred on the people of the last frame of the history. The published files are centred on all frames,
  future ones included.

Shapes: B scenes, H history, F horizon, P people, J joints, C = 3 J coordinates, N places of a group, M groups.
"""

from __future__ import annotations

from dataclasses import dataclass

import torch
from torch import Tensor, nn

from motioncast.core.skeletons import SKELETONS
from motioncast.nn.dct import dct_matrix
from motioncast.nn.frames import middle_of_people, root_joints
from motioncast.nn.gaps import fill_gaps
from motioncast.nn.losses import mean_distance


@dataclass(frozen=True)
class EMPMPConfig:
    """Sizes of the model; the defaults are those of the paper from 15 frames to 45.

    Attributes:
        skeleton: Name of the skeleton.
        history: Frames read.
        horizon: Frames answered.
        fps: Frames a second.
        blocks: Blocks of the local branch.
        interval: Local blocks from one meeting of the branches to the next.
        people: Places of the global branch.
    """

    skeleton: str = "mrt15"
    history: int = 15
    horizon: int = 45
    fps: float = 15.0
    blocks: int = 64
    interval: int = 16
    people: int = 3


class Norm(nn.LayerNorm):
    """Layer normalisation over coordinates, the axis before the last."""

    def forward(self, input: Tensor) -> Tensor:
        """``(..., C, T)``, normalised."""
        return super().forward(input.transpose(-1, -2)).transpose(-1, -2)


class TimeMixing(nn.Module):
    """A linear layer over time and a norm over coordinates, added to the input.

    Args:
        frames: T, of one person or of all.
        coordinates: C.
    """

    def __init__(self, frames: int, coordinates: int) -> None:
        super().__init__()
        self.mix = nn.Linear(frames, frames)
        self.norm = Norm(coordinates)
        nn.init.xavier_uniform_(self.mix.weight, gain=1e-8)
        nn.init.zeros_(self.mix.bias)

    def forward(self, features: Tensor) -> Tensor:
        """Features ``(..., C, T)``, changed."""
        return features + self.norm(self.mix(features))


class Meeting(nn.Module):
    """The cross-level block: what the local and the global branch tell each other.

    Args:
        frames: H of one person.
        people: N.
        coordinates: C.
    """

    def __init__(self, frames: int, people: int, coordinates: int) -> None:
        super().__init__()
        self.scale_shift = nn.Linear(people * frames, 2 * frames)
        self.to_local = nn.Linear(frames, frames)
        self.distance = nn.Linear(people, coordinates)
        self.distance_time = nn.Linear(frames, frames)
        self.to_global = nn.Linear(people * frames, people * frames)
        self.norm_local = Norm(coordinates)
        self.norm_global = Norm(coordinates)
        nn.init.zeros_(self.to_local.weight)
        nn.init.zeros_(self.to_local.bias)

    def forward(self, own: Tensor, everyone: Tensor, distances: Tensor) -> tuple[Tensor, Tensor]:
        """Both branches after the meeting.

        Args:
            own: Local features ``(M, N, C, H)``.
            everyone: Global features ``(M, C, N H)``.
            distances: From each person to each, ``(M, H, N, N)`` metres.
        """
        scale, shift = self.scale_shift(everyone)[:, None].chunk(2, -1)
        apart = self.distance_time(self.distance(distances).permute(0, 2, 3, 1))
        told = self.norm_local(self.to_local(own * (1 + scale) + shift) + apart)
        heard = self.norm_global(everyone + self.to_global(own.transpose(1, 2).flatten(2)))
        return own + told, everyone + heard


class EMPMP(nn.Module):
    """World-frame history with masks in, world-frame future of all people out."""

    dct: Tensor
    inverse: Tensor

    def __init__(self, config: EMPMPConfig) -> None:
        super().__init__()
        self.config = config
        skeleton = SKELETONS[config.skeleton]
        self.root = root_joints(skeleton)
        coordinates, meetings = 3 * len(skeleton), config.blocks // config.interval
        stretch = -(-config.horizon // config.history)  # coefficients that come out for each that goes in
        self.enter = nn.Linear(coordinates, coordinates)
        self.local_blocks = nn.ModuleList(
            nn.Sequential(*(TimeMixing(config.history, coordinates) for _ in range(config.interval)))
            for _ in range(meetings)
        )
        self.global_blocks = nn.ModuleList(
            TimeMixing(config.people * config.history, coordinates) for _ in range(meetings)
        )
        self.meetings = nn.ModuleList(Meeting(config.history, config.people, coordinates) for _ in range(meetings))
        self.leave = nn.Linear(coordinates, stretch * coordinates)
        nn.init.xavier_uniform_(self.leave.weight, gain=1e-8)  # untrained, the model repeats the last pose
        nn.init.zeros_(self.leave.bias)
        self.register_buffer("dct", dct_matrix(config.history), persistent=False)
        self.register_buffer("inverse", dct_matrix(stretch * config.history)[:, : config.horizon], persistent=False)

    def forward(self, history: Tensor, observed: Tensor) -> Tensor:
        """The future of all people.

        Args:
            history: ``(B, H, P, J, 3)`` metres, world, z up.
            observed: ``(B, H, P, J)`` bool.

        Returns:
            ``(B, F, P, J, 3)`` metres, world; people who are not there in the last frame stand still.
        """
        filled = fill_gaps(history, observed)
        present = observed[:, -1].any(-1)
        # a bf16 network would see joints a centimetre from where they are; it is small enough to do without
        with torch.autocast(history.device.type, enabled=False):
            seats = seating(present, self.config.people)
            there = seats.sum(-1)  # B, places: 1 where somebody sits
            centred = (filled - middle_of_people(filled[:, -1], present)[:, None]).flatten(3)
            seated = (seats @ centred.transpose(1, 2).flatten(2)).unflatten(-1, (self.config.history, -1))
            path = filled[..., self.root, :].mean(-2).transpose(1, 2).flatten(2)
            seated_path = (seats @ path).unflatten(-1, (self.config.history, 3))
            groups = (-1, self.config.people)
            change = self.change(
                seated.unflatten(1, groups).flatten(0, 1),
                seated_path.unflatten(1, groups).flatten(0, 1),
                there.unflatten(1, groups).flatten(0, 1),
            )
            change = seats.transpose(1, 2) @ change.unflatten(0, (history.shape[0], -1)).flatten(1, 2).flatten(2)
        change = change.unflatten(-1, (self.config.horizon, -1, 3)).transpose(1, 2)
        return filled[:, -1:] + change

    def change(self, history: Tensor, path: Tensor, there: Tensor) -> Tensor:
        """The change from the last pose of the people of each group.

        Args:
            history: ``(M, N, H, C)`` metres, centred.
            path: Roots ``(M, N, H, 3)`` metres.
            there: ``(M, N)``, 1 where a place is taken, else 0.

        Returns:
            ``(M, N, F, C)`` metres.
        """
        pairs = there[:, None, :, None] * there[:, None, None, :]
        distances = distances_between(path) * pairs
        own = self.enter(self.dct @ history).transpose(-1, -2)
        everyone = own.transpose(1, 2).flatten(2)
        for local_blocks, global_block, meeting in zip(
            self.local_blocks, self.global_blocks, self.meetings, strict=True
        ):
            own, everyone = meeting(local_blocks(own), global_block(everyone), distances)
        coefficients = self.leave(own.transpose(-1, -2)).unflatten(-1, (-1, history.shape[-1])).flatten(2, 3)
        return self.inverse.T @ coefficients

    def loss(self, answer: Tensor, truth: Tensor, observed: Tensor) -> Tensor:
        """Mean distance of the joints plus mean distance of their steps from frame to frame."""
        both = observed[:, 1:] & observed[:, :-1]
        return mean_distance(answer, truth, observed) + mean_distance(answer.diff(dim=1), truth.diff(dim=1), both)


def distances_between(path: Tensor) -> Tensor:
    """Distance of every two people ``(M, H, N, N)`` along their paths ``(M, N, H, 3)``."""
    path = path.transpose(1, 2)
    apart = (path[:, :, :, None] - path[:, :, None]).square().sum(-1)
    return (apart + 1e-12).sqrt()  # the constant keeps the gradient of a distance of zero finite


def seating(present: Tensor, places: int) -> Tensor:
    """Which place each person takes: those who are there, in their order, from the first place on.

    Args:
        present: ``(B, P)`` bool.
        places: Places of a group.

    Returns:
        ``(B, places of all groups, P)``, 1 where a person takes a place, else 0.

    Example:
        >>> seating(torch.tensor([[True, False, True]]), 3)[0].argmax(1).tolist()
        [0, 2, 0]
    """
    there = present.float()
    place = there.cumsum(1) - 1
    people = present.shape[1]
    every = torch.arange((people + places - 1) // places * places, device=present.device)
    return (place[:, None] == every[:, None]).float() * there[:, None]


MODEL, CONFIG = EMPMP, EMPMPConfig
