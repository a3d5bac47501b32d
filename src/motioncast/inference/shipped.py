"""What all trained models share: graphs and a card, a question that is answered, a tracker that is followed."""

from __future__ import annotations

import hashlib
from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Self

import numpy as np
import onnxruntime

from motioncast.core.card import ModelCard
from motioncast.core.forecast import Forecast
from motioncast.core.forecaster import Progress
from motioncast.core.scene import Scene
from motioncast.core.scene_object import SceneObject
from motioncast.core.skeleton import Skeleton
from motioncast.errors import InputError
from motioncast.inference.baselines import one_future
from motioncast.inference.lift import needed_frames
from motioncast.inference.question import Question, refuse_short
from motioncast.inference.stream import Stream


@dataclass(slots=True)
class ShippedForecaster(ABC):
    """A trained model that answers for scenes of any skeleton, rate, place and number of people.

    Attributes:
        card: The model's card.
        weights: The ONNX file.
        threads: Threads of one pass.
        rigid: Whether bones that keep their length in the history keep it in the forecast.
    """

    card: ModelCard
    weights: Path
    threads: int = 1
    rigid: bool = True
    _opened: list[onnxruntime.InferenceSession] = field(default_factory=list, repr=False)

    @abstractmethod
    def futures(self, question: Question, samples: int, seed: int, progress: Progress) -> list[np.ndarray]:
        """The model's answers, one a sample, ``(time, people, model joints, 3)``, at least as long as asked for."""

    def forecast(
        self,
        scene: Scene,
        *,
        horizon_s: float | None = None,
        samples: int = 1,
        seed: int = 0,
        progress: Progress | None = None,
    ) -> Forecast:
        """See :class:`motioncast.core.forecaster.Forecaster`.

        Raises:
            SceneError: If the history is shorter than the model's, nobody is seen at last, or numbers are absurd.
            SkeletonError: If the skeleton lacks a joint that the model needs.
        """
        refuse_short(self.card, scene)
        return self.answer(scene, horizon_s, samples, seed, progress)

    def answer(
        self,
        scene: Scene,
        horizon_s: float | None = None,
        samples: int = 1,
        seed: int = 0,
        progress: Progress | None = None,
    ) -> Forecast:
        """As :meth:`forecast`, for a history of any length: who was seen too briefly is answered by a simple guess."""
        warnings = one_future(self.card, samples)
        question = Question.of(self.card, scene, horizon_s)
        if question.brief.all():
            futures = [question.held] * (samples if self.card.stochastic else 1)
        else:
            futures = self.futures(question, samples, seed, progress or (lambda share: None))
        return question.forecast(futures, self.rigid, seed, warnings)

    def stream(
        self,
        fps: float,
        skeleton: Skeleton | None = None,
        horizon_s: float | None = None,
        objects: Sequence[SceneObject] = (),
    ) -> Stream:
        """A live forecast: push frames, read futures.

        Args:
            fps: Frames a second of the tracker.
            skeleton: Its joints. Default: the model's.
            horizon_s: How far to look ahead. Default: the model's horizon.
            objects: What stands around the people, for models that see it.
        """
        self.sessions()  # opened now, so that no push waits for it
        memory = needed_frames(self.card.history, self.card.fps, fps)

        def answer(scene: Scene) -> Forecast:
            return self.answer(replace(scene, objects=tuple(objects)) if objects else scene, horizon_s)

        return Stream(answer, skeleton or self.card.joints, fps, memory)

    def with_threads(self, threads: int) -> Self:
        """The same model, computing with so many threads."""
        return replace(self, threads=threads, _opened=[])

    @property
    def files(self) -> list[Path]:
        """The graphs, in the order in which the card's checksum was taken of them."""
        return [self.weights]

    def sessions(self) -> list[onnxruntime.InferenceSession]:
        """The graphs, opened when first asked for.

        Raises:
            InputError: If a file is missing or damaged.
        """
        if not self._opened:
            self._opened = opened(self.files, self.card.checksum, self.threads)
        return self._opened


def opened(files: Sequence[Path], checksum: str, threads: int) -> list[onnxruntime.InferenceSession]:
    """Graphs that compute with so many threads each.

    Args:
        files: The ONNX files.
        checksum: SHA-256 of all of them, one after the other; empty if none was taken.
        threads: Threads of one pass.

    Raises:
        InputError: If a file is missing or damaged.
    """
    for file in files:
        if not file.is_file():
            raise InputError(
                f"there is no file {file}, which belongs to {files[-1]}; training writes both, keep them together"
            )
    graphs = [file.read_bytes() for file in files]
    if checksum and hashlib.sha256(b"".join(graphs)).hexdigest() != checksum:
        names = " or ".join(map(str, files))
        raise InputError(f"{names} is damaged: its checksum is not that of the card; install it again")
    options = onnxruntime.SessionOptions()
    options.intra_op_num_threads = threads
    options.inter_op_num_threads = 1
    options.log_severity_level = 3
    return [onnxruntime.InferenceSession(graph, options, providers=["CPUExecutionProvider"]) for graph in graphs]
