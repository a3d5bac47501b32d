"""Gaps in an observed history."""

from __future__ import annotations

import torch
from torch import Tensor


def fill_gaps(history: Tensor, observed: Tensor) -> Tensor:
    """Positions in which a joint that is not seen stays where it was last, or first, seen.

    A joint that is never seen stands at the mean of the person's joints that are seen in the last frame.

    Args:
        history: ``(batch, time, people, joints, 3)`` metres.
        observed: ``(batch, time, people, joints)`` bool.
    """
    last = observed[:, -1, ..., None].float()
    count = last.sum(2, keepdim=True).clamp(min=1)
    middle = (history[:, -1] * last).sum(2, keepdim=True) / count
    seen = observed[..., None]
    frames = list(history.unbind(1))
    ever = seen.any(1)
    backwards = torch.where(seen[:, -1], frames[-1], torch.where(ever, frames[-1] * 0, middle))
    for time in range(len(frames) - 1, -1, -1):  # the first seen position serves for the frames before it
        backwards = torch.where(seen[:, time], frames[time], backwards)
    current, filled = backwards, []
    for time in range(len(frames)):
        current = torch.where(seen[:, time], frames[time], current)
        filled.append(current)
    return torch.stack(filled, 1)
