"""A person's own frame: where it stands and which way it faces.

A model that sees people in their own frames does not have to learn that moving or turning a scene moves and turns
the answer: it holds exactly.
"""

from __future__ import annotations

import torch
from torch import Tensor

from motioncast.core.skeleton import Skeleton


def side_joints(skeleton: Skeleton) -> list[tuple[int, int]]:
    """Pairs (left, right) of the hips and of the shoulders."""
    return [
        (skeleton.landmarks.index(f"left_{place}"), skeleton.landmarks.index(f"right_{place}"))
        for place in ("hip", "shoulder")
    ]


def root_joints(skeleton: Skeleton) -> list[int]:
    """The joints whose mean is where a person stands: the pelvis, or both hips where there is none."""
    pelvis = skeleton.find("pelvis")
    return [pelvis] if pelvis is not None else list(side_joints(skeleton)[0])


def stand(pose: Tensor, skeleton: Skeleton) -> tuple[Tensor, Tensor]:
    """Where each person stands, and its heading.

    Args:
        pose: ``(..., J, 3)`` metres, z up: one frame.
        skeleton: Which joint is which.

    Returns:
        The root's position ``(..., 3)`` and a horizontal unit vector ``(..., 2)``, at right angles to hips and
        shoulders.
    """
    left, right = (list(side) for side in zip(*side_joints(skeleton), strict=True))
    origin = pose[..., root_joints(skeleton), :].mean(-2)
    across = (pose[..., left, :] - pose[..., right, :]).sum(-2)
    forward = across[..., [1, 0]] * across.new_tensor([1.0, -1.0])
    length = forward.norm(dim=-1, keepdim=True)
    return origin, torch.where(length > 1e-3, forward / length.clamp(min=1e-3), forward.new_tensor([1.0, 0.0]))


def turn(vectors: Tensor, heading: Tensor, *, back: bool = False) -> Tensor:
    """Vectors ``(..., 3)`` turned about the vertical so that +x comes to point along ``heading`` (or back)."""
    cosine, sine = heading[..., 0], -heading[..., 1] if back else heading[..., 1]
    x, y, z = vectors.unbind(-1)
    return torch.stack([cosine * x - sine * y, sine * x + cosine * y, z], -1)


TURNING_BACK = torch.tensor(
    [
        [[1.0, 0, 0], [0, 1, 0], [0, 0, 0]],
        [[0.0, 1, 0], [-1, 0, 0], [0, 0, 0]],
        [[0.0, 0, 0], [0, 0, 0], [0, 0, 1]],
    ]
)
"""The cosine of a heading times the first matrix, its sine times the second, and the third: the turn back by it."""


def to_own(motion: Tensor, origin: Tensor, heading: Tensor) -> Tensor:
    """Each person's motion ``(B, T, P, J, 3)`` as seen from where it stands."""
    return turn(motion - origin[:, None, :, None], heading[:, None, :, None], back=True)


def to_world(own: Tensor, origin: Tensor, heading: Tensor) -> Tensor:
    """The inverse of ``to_own``."""
    return turn(own, heading[:, None, :, None]) + origin[:, None, :, None]


def middle_of_people(pose: Tensor, present: Tensor) -> Tensor:
    """Mean position of the people of one frame ``(B, P, J, 3)`` who are there, ``(B, 1, 1, 3)``."""
    there = present[..., None].float()
    middle = (pose.mean(2) * there).sum(1) / there.sum(1).clamp(min=1)
    return middle[:, None, None]
