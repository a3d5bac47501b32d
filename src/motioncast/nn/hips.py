"""SAST's frame of a person, on the floor between the hips, and other people as seen from it."""

from __future__ import annotations

import torch
from torch import Tensor

from motioncast.core.skeleton import Skeleton
from motioncast.nn.frames import side_joints, turn


def stand_on_hips(pose: Tensor, skeleton: Skeleton) -> tuple[Tensor, Tensor]:
    """Where a person stands on the floor, and the direction of its hip line.

    In the frame that these make (``nn.frames.to_own``) the hips are at (0, 0), the right one points along +x, the
    person faces +y, and heights are those of the world (SAST, Sec. 3.2).

    Args:
        pose: ``(..., J, 3)`` metres, z up.
        skeleton: Which joint is which.

    Returns:
        The middle of the hips at height 0, ``(..., 3)``, and a horizontal unit vector from left to right, ``(..., 2)``.
    """
    left, right = (pose[..., joint, :2] for joint in side_joints(skeleton)[0])
    middle, across = (left + right) / 2, right - left
    origin = torch.cat([middle, torch.zeros_like(middle[..., :1])], -1)
    length = across.norm(dim=-1, keepdim=True)
    return origin, torch.where(length > 1e-3, across / length.clamp(min=1e-3), across.new_tensor([1.0, 0.0]))


def seen_from(origin: Tensor, across: Tensor, place: Tensor, direction: Tensor) -> Tensor:
    """Where people are over time as seen by person i who stays, ``(B, Q of i, T, P, 5)``.

    Two numbers tell the place, within the unit circle, one the nearness, and two the direction.

    Args:
        origin: Where the observers stand, ``(B, Q, 3)``.
        across: The x axes of their frames, horizontal unit vectors, ``(B, Q, 2)``.
        place: Where the people are, ``(B, T, P, 3)``.
        direction: The x axes of theirs, ``(B, T, P, 2)``.
    """
    me = across[:, :, None, None]
    apart = turn(place[:, None] - origin[:, :, None, None], me, back=True)[..., :2]
    distance = apart.norm(dim=-1, keepdim=True)
    cosine, sine = me.unbind(-1)
    x, y = direction[:, None].unbind(-1)
    look = torch.stack([cosine * x + sine * y, cosine * y - sine * x], -1)
    return torch.cat([apart / (1 + distance), torch.exp(-distance), look], -1)
