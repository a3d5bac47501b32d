"""A model whose one graph gives one future."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import count

import numpy as np

from motioncast.core.forecaster import Progress
from motioncast.inference.question import Question
from motioncast.inference.shipped import ShippedForecaster


@dataclass(slots=True)
class GraphForecaster(ShippedForecaster):
    """A trained graph: histories of the people of a scene in, their one future out."""

    def futures(self, question: Question, samples: int, seed: int, progress: Progress) -> list[np.ndarray]:
        """The graph's one answer."""
        done = count(1)

        def one_pass(history: np.ndarray, observed: np.ndarray) -> np.ndarray:
            future = self.run(history[None], observed[None])[0]
            progress(next(done) / question.passes)
            return future

        return [question.rolled(one_pass)]

    def run(self, history: np.ndarray, observed: np.ndarray) -> np.ndarray:
        """One pass of the graph, batch first."""
        (session,) = self.sessions()
        middle = _middle(history, observed)  # far from the origin float32 loses millimetres
        near = {"history": (history - middle).astype(np.float32), "observed": np.ascontiguousarray(observed)}
        return session.run(None, near)[0] + middle


def _middle(history: np.ndarray, observed: np.ndarray) -> np.ndarray:
    """Middle of the people in the last frame, per scene, ``(batch, 1, 1, 1, 3)``."""
    seen = observed[:, -1:, ..., None]
    total = np.where(seen, history[:, -1:], 0).sum((2, 3), keepdims=True, dtype=np.float64)
    return total / np.maximum(seen.sum((2, 3), keepdims=True), 1)
