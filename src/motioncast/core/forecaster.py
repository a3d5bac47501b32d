"""What a model is: it has a card, and it answers."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Protocol

import numpy as np

from motioncast.core.card import ModelCard
from motioncast.core.forecast import Forecast
from motioncast.core.scene import Scene
from motioncast.core.skeleton import Skeleton

Progress = Callable[[float], None]
"""Receives the share that is done, 0 to 1."""


class Forecaster(Protocol):
    """A model with its weights, or a simple guess."""

    @property
    def card(self) -> ModelCard:
        """What the model takes and gives."""
        ...

    def forecast(
        self,
        scene: Scene,
        *,
        horizon_s: float | None = None,
        samples: int = 1,
        seed: int = 0,
        progress: Progress | None = None,
    ) -> Forecast:
        """What the people who are seen in the last frame of a scene will do next.

        Args:
            scene: The motion so far; its last frame is now.
            horizon_s: How far to look ahead. Default: the model's horizon.
            samples: Number of different futures, for models that have several.
            seed: Seed of the samples.
            progress: Told how much is done.

        Raises:
            SceneError: If the scene cannot be forecast.
        """
        ...


class Live(Protocol):
    """A forecast that follows a tracker."""

    def push(self, frame: Mapping[str, np.ndarray], time_s: float | None = None) -> Forecast | None:
        """Takes a frame, person id -> joints ``(joints, 3)``, and forecasts from the newest one."""
        ...


class LiveForecaster(Forecaster, Protocol):
    """A forecaster that can follow a tracker; those that ship all can."""

    def stream(self, fps: float, skeleton: Skeleton | None = None, horizon_s: float | None = None) -> Live:
        """A live forecast of a tracker of that rate and skeleton."""
        ...
