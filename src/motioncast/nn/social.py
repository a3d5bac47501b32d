"""What other people tell one person: attention over whoever is there."""

from __future__ import annotations

import torch
from torch import Tensor, nn

from motioncast.nn.frames import turn

FAR = -1e9
"""Attention score of a person who is not there."""


def whereabouts(origin: Tensor, heading: Tensor) -> Tensor:
    """Where person k stands and looks as seen by person i, ``(B, P of i, P of k, 5)``.

    Three numbers tell the place, shortened so that far people differ by their bearing and not by kilometres, and two
    the heading. Moving or turning the scene changes none.

    Args:
        origin: Where people stand, ``(B, P, 3)``.
        heading: Horizontal unit vectors, ``(B, P, 2)``.
    """
    me = heading[:, :, None]
    place = turn(origin[:, None] - origin[:, :, None], me, back=True)
    look = torch.cat([heading, torch.zeros_like(heading[..., :1])], -1)[:, None].expand_as(place)
    return torch.cat([torch.tanh(place / 3), turn(look, me, back=True)[..., :2]], -1)


def others(present: Tensor) -> Tensor:
    """Whether person k is another one than i, and there, ``(B, P of i, P of k)``.

    Args:
        present: ``(B, P)`` bool.
    """
    number = torch.arange(present.shape[1], device=present.device)
    return present[:, None] & (number[:, None] != number)


class PeopleAttention(nn.Module):
    """A message to each person from the others; nobody's message is zero.

    Args:
        width: Channels of a person's features and of the message.
    """

    def __init__(self, width: int) -> None:
        super().__init__()
        self.query = nn.Linear(width, width)
        self.key = nn.Linear(width + 5, width)
        self.value = nn.Linear(width + 5, width)

    def forward(self, features: Tensor, origin: Tensor, heading: Tensor, present: Tensor) -> Tensor:
        """Messages ``(B, P, d)``.

        Args:
            features: What is known of each person, ``(B, P, d)``, in its own frame.
            origin: Where people stand, ``(B, P, 3)``.
            heading: Horizontal unit vectors, ``(B, P, 2)``.
            present: Who is there, ``(B, P)`` bool.
        """
        people = features.shape[1]
        seen = torch.cat([features[:, None].expand(-1, people, -1, -1), whereabouts(origin, heading)], -1)
        scores = (self.key(seen) @ self.query(features)[..., None]).squeeze(-1).float() * features.shape[-1] ** -0.5
        scores = scores + (~others(present)).float() * FAR
        weights = torch.cat([scores, torch.zeros_like(scores[..., :1])], -1).softmax(-1)  # the last is nobody
        return (weights[..., None, :-1] @ self.value(seen).float()).squeeze(-2)
