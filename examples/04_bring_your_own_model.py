"""A model of your own: it has a card and answers scenes. Hold it to the contract first.

    python examples/04_bring_your_own_model.py

To load it by name, let your package name a function that returns it as an entry point of
``motioncast.models``.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

import motioncast as mc
from motioncast.core.resample import bridge
from motioncast.errors import SceneError
from motioncast.testing import check_forecaster


@dataclass(frozen=True)
class FadingVelocity:
    """Everybody goes on as before and comes to rest within a second."""

    card: mc.ModelCard = field(
        default_factory=lambda: mc.ModelCard(
            "fading-velocity", "example", "forecast", skeleton="any", history=2, horizon=45, fps=15.0
        )
    )

    def forecast(
        self,
        scene: mc.Scene,
        *,
        horizon_s: float | None = None,
        samples: int = 1,
        seed: int = 0,
        progress: Callable[[float], None] | None = None,
    ) -> mc.Forecast:
        people = [name for row, name in enumerate(scene.people) if scene.observed[-1, row].any()]
        if not people:
            raise SceneError("nobody is seen in the last frame; end the scene with a frame that shows somebody")
        recent = scene[-round(0.2 * scene.fps) - 1 :].select(people)
        poses = bridge(recent.positions, recent.observed).astype(np.float64)  # what was not seen is filled in
        velocity = (poses[-1] - poses[0]).mean(1, keepdims=True) * scene.fps / max(1, len(poses) - 1)
        times = np.arange(1, round((horizon_s or 3.0) * scene.fps) + 1) / scene.fps
        way = 0.3 * (1 - np.exp(-times / 0.3))  # seconds of the present velocity that are still gone
        answer = poses[-1] + velocity * way[:, None, None, None]
        warnings = ("one future is all there is",) if samples > 1 else ()
        return mc.Forecast(answer[None], scene, tuple(people), self.card, seed=seed, warnings=warnings)


def main() -> None:
    check_forecaster(FadingVelocity())
    print("all checks hold")


if __name__ == "__main__":
    main()
