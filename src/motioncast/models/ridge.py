"""Ridge regression: the future as a linear function of the window, fitted in closed form.

No paper's: the least that a learned model must beat. In the person's own frame (pelvis and heading in the last frame
of history), every coordinate of every future frame, as a change from the last pose, is a linear function of all
coordinates of the history. The weights are those of least squares with a penalty on their size. There is nothing to
draw and nothing to tune by hand but the penalty.

Shapes: B scenes, W windows, H history, F horizon, P people, J joints.
"""

from __future__ import annotations

from dataclasses import dataclass

import torch
from torch import Tensor, nn

from motioncast.core.skeletons import SKELETONS
from motioncast.nn.folding import fold, unfold
from motioncast.nn.frames import stand, to_own, to_world
from motioncast.nn.gaps import fill_gaps
from motioncast.nn.losses import mean_distance

WINDOWS_AT_ONCE = 4096
"""Windows whose products are summed at a time: bounds the memory of a fit."""


@dataclass(frozen=True)
class RidgeConfig:
    """Sizes of the model.

    Attributes:
        skeleton: Name of the skeleton.
        history: Frames read.
        horizon: Frames answered.
        fps: Frames a second.
        penalty: Weight of the squared size of the weights, in units of the mean variance of an input.
    """

    skeleton: str = "mrt15"
    history: int = 15
    horizon: int = 45
    fps: float = 15.0
    penalty: float = 0.03


class Ridge(nn.Module):
    """World-frame history with masks in; world-frame future of each person, from its own history alone, out."""

    def __init__(self, config: RidgeConfig) -> None:
        super().__init__()
        self.config = config
        self.skeleton = SKELETONS[config.skeleton]
        coordinates = 3 * len(self.skeleton)
        self.linear = nn.Linear(config.history * coordinates, config.horizon * coordinates)
        nn.init.zeros_(self.linear.weight)  # not fitted, the model repeats the last pose
        nn.init.zeros_(self.linear.bias)

    def forward(self, history: Tensor, observed: Tensor) -> Tensor:
        """The future of all people.

        Args:
            history: ``(B, H, P, J, 3)`` metres, world, z up.
            observed: ``(B, H, P, J)`` bool.

        Returns:
            ``(B, F, P, J, 3)`` metres, world.
        """
        history = fill_gaps(history, observed)
        origin, heading = stand(history[:, -1], self.skeleton)
        own = to_own(history, origin, heading)
        with torch.autocast(history.device.type, enabled=False):
            change = self.linear(inputs(own)).view(-1, 3 * len(self.skeleton), self.config.horizon)
        return to_world(own[:, -1:] + unfold(change, history.shape[2]), origin, heading)

    @torch.no_grad()
    def fit(self, histories: Tensor, futures: Tensor) -> None:
        """Set the weights to those of least squares with the penalty, solved in float64.

        Args:
            histories: ``(W, H, P, J, 3)`` metres, all joints seen.
            futures: ``(W, F, P, J, 3)`` metres, what followed.
        """
        size, answers = self.linear.in_features, self.linear.out_features
        squares, products = torch.zeros(size, size).double(), torch.zeros(size, answers).double()
        given_mean, change_mean = torch.zeros(size).double(), torch.zeros(answers).double()
        count = histories.shape[0] * histories.shape[2]
        for part in zip(histories.split(WINDOWS_AT_ONCE), futures.split(WINDOWS_AT_ONCE), strict=True):
            given, change = (array.double() for array in self.pairs(*part))
            squares += given.T @ given / count
            products += given.T @ change / count
            given_mean += given.sum(0) / count
            change_mean += change.sum(0) / count
        squares -= given_mean[:, None] * given_mean
        products -= given_mean[:, None] * change_mean
        squares.diagonal().add_(self.config.penalty * squares.diagonal().mean())
        weight = torch.cholesky_solve(products, torch.linalg.cholesky(squares))
        self.linear.weight.copy_(weight.T)
        self.linear.bias.copy_(change_mean - given_mean @ weight)

    def pairs(self, history: Tensor, future: Tensor) -> tuple[Tensor, Tensor]:
        """What the regression is given, ``(W * P, H * 3 J)``, and the change it should answer, ``(W * P, F * 3 J)``."""
        origin, heading = stand(history[:, -1], self.skeleton)
        own = to_own(history, origin, heading)
        return inputs(own), fold(to_own(future, origin, heading) - own[:, -1:]).flatten(1)

    def loss(self, answer: Tensor, truth: Tensor, observed: Tensor) -> Tensor:
        """Mean distance of the joints, for those who go on from the fit by gradients."""
        return mean_distance(answer, truth, observed)


def inputs(own: Tensor) -> Tensor:
    """The last pose and the way there, ``(B * P, H * 3 J)``, of a motion in the person's frame."""
    return fold(torch.cat([own[:, -1:], own[:, :-1] - own[:, -1:]], 1)).flatten(1)


MODEL, CONFIG = Ridge, RidgeConfig
