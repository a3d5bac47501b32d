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
    now = observed[:, -1, ..., None].float()
    middle = (history[:, -1] * now).sum(2, keepdim=True) / now.sum(2, keepdim=True).clamp(min=1)
    frames = int(observed.shape[1])  # a plain number, so that what follows from it is a constant of a graph
    seen, number = observed.float(), torch.arange(1, frames + 1, device=history.device).float()
    until = (number[:, None] >= number).float()
    # the number of the last frame up to each one in which the joint was seen, from 1; 0 where there is none
    last = (seen * number[:, None, None])[:, None].mul(until[:, :, None, None]).amax(2)
    first = frames + 1 - (seen * number.flip(0)[:, None, None]).amax(1, keepdim=True)
    source = (torch.where(last > 0, last, first) - 1).clamp(max=frames - 1).long()
    filled = history.gather(1, source[..., None].expand_as(history))
    return torch.where(observed.any(1, keepdim=True)[..., None], filled, middle[:, None])
