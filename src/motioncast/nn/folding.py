"""People folded into the batch, as models of single persons take them."""

from __future__ import annotations

from torch import Tensor


def fold(motion: Tensor) -> Tensor:
    """The trajectory of each coordinate of each joint, ``(B * P, 3 J, T)``, of a motion ``(B, T, P, J, 3)``."""
    return motion.permute(0, 2, 3, 4, 1).flatten(0, 1).flatten(1, 2)


def unfold(trajectories: Tensor, people: int) -> Tensor:
    """The inverse of ``fold``.

    Args:
        trajectories: ``(B * P, 3 J, T)``.
        people: P.
    """
    _, coordinates, frames = trajectories.shape
    return trajectories.view(-1, people, coordinates // 3, 3, frames).permute(0, 4, 1, 2, 3)
