"""Motion as a diffusion model sees it: numbers of about the size of its noise."""

from __future__ import annotations

import torch
from torch import Tensor, nn

FINEST_M = 0.005
"""What moves less than this is scaled as if it moved so much: below it lies the noise of capture."""


class MinMax(nn.Module):
    """SAST's scaling: each coordinate of each joint fills -3 to 3 over the training data.

    One outlier sets the scale of a coordinate, so typical values are well inside -1 to 1.

    Args:
        joints: J.
    """

    mean: Tensor
    scale: Tensor

    def __init__(self, joints: int) -> None:
        super().__init__()
        self.register_buffer("mean", torch.zeros(joints, 3))
        self.register_buffer("scale", torch.ones(joints, 3))

    def fit(self, own: Tensor, history: int) -> None:
        """Take the extremes of windows ``(n, N, J, 3)`` in their own frames."""
        low, high = own.amin((0, 1)), own.amax((0, 1))
        self.mean.copy_((low + high) / 2)
        self.scale.copy_(((high - low) / 6).clamp(min=FINEST_M))

    def to_model(self, own: Tensor, last: Tensor, first: int) -> Tensor:
        """Metres ``(..., T, J, 3)`` to numbers of the model; the last pose and the place of frame 0 do not matter."""
        return (own - self.mean) / self.scale

    def to_metres(self, scaled: Tensor, last: Tensor, first: int) -> Tensor:
        """The inverse of ``to_model``."""
        return scaled * self.scale + self.mean


class Displacement(nn.Module):
    """Displacement from the last observed pose, each number divided by its root mean square over the training data.

    The root joint is taken from where it stood, every other joint from the root, so that limbs do not drown in the
    path that they share. Each frame has a scale of its own: what a person can have done by then. Noise is therefore
    millimetres at the seam and a metre in ten seconds, and an error of the network is so too: no jump at the seam.

    Args:
        frames: N frames of a window.
        joints: J; joint 0 is the root.
    """

    scale: Tensor

    def __init__(self, frames: int, joints: int) -> None:
        super().__init__()
        self.register_buffer("scale", torch.ones(frames, joints, 3))

    def fit(self, own: Tensor, history: int) -> None:
        """Take the root mean squares of windows ``(n, N, J, 3)`` in their own frames."""
        change = apart_from_root(own - own[:, history - 1 : history])
        self.scale.copy_(change.square().mean(0).sqrt().clamp(min=FINEST_M))

    def to_model(self, own: Tensor, last: Tensor, first: int) -> Tensor:
        """Metres to numbers of the model.

        Args:
            own: ``(..., T, J, 3)``, own frame.
            last: The last observed pose, ``(..., 1, J, 3)``.
            first: Number of the first of the T frames in the window.
        """
        return apart_from_root(own - last) / self.scale[first : first + own.shape[-3]]

    def to_metres(self, scaled: Tensor, last: Tensor, first: int) -> Tensor:
        """The inverse of ``to_model``."""
        change = scaled * self.scale[first : first + scaled.shape[-3]]
        root, others = change[..., :1, :], change[..., 1:, :]
        return last + torch.cat([root, others + root], -2)


def apart_from_root(motion: Tensor) -> Tensor:
    """The root, joint 0 of ``(..., J, 3)``, as it is, and every other joint as seen from it."""
    root, others = motion[..., :1, :], motion[..., 1:, :]
    return torch.cat([root, others - root], -2)
