"""Many windows at once: one after the other, over processes of this machine, or over a Ray cluster.

The same function forecasts a chunk of windows everywhere, and chunks do not depend on who runs them: the answers are
equal bit for bit.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from concurrent.futures import ProcessPoolExecutor
from functools import lru_cache
from multiprocessing import get_context

import numpy as np

from motioncast.core.forecaster import Forecaster
from motioncast.core.scene import Scene
from motioncast.errors import InputError
from motioncast.inference.registry import load_forecaster

Progress = Callable[[float], None]

Spread = Callable[[str | Forecaster, list[Scene], float, bool, Progress], list[np.ndarray]]
"""Forecasts scenes: model, scenes, horizon in seconds, whether people are alone, who is told how much is done."""

CHUNK = 20
"""Scenes that a worker takes at a time."""


def serially(
    model: str | Forecaster, scenes: list[Scene], horizon_s: float, alone: bool, progress: Progress
) -> list[np.ndarray]:
    """One scene after the other."""
    answers: list[np.ndarray] = []
    for chunk in chunks(scenes):
        answers += forecast_chunk(model, chunk, horizon_s, alone)
        progress(len(answers) / len(scenes))
    return answers


def over_processes(workers: int) -> Spread:
    """Over so many processes of this machine."""

    def spread(
        model: str | Forecaster, scenes: list[Scene], horizon_s: float, alone: bool, progress: Progress
    ) -> list[np.ndarray]:
        answers: list[np.ndarray] = []
        # spawn: a forked process would share the threads of a graph that is loaded already
        with ProcessPoolExecutor(workers, mp_context=get_context("spawn")) as pool:
            jobs = [pool.submit(forecast_chunk, model, chunk, horizon_s, alone) for chunk in chunks(scenes)]
            for job in jobs:
                answers += job.result()
                progress(len(answers) / len(scenes))
        return answers

    return spread


def over_ray(address: str) -> Spread:
    """Over a Ray cluster at an address (``local`` for one on this machine).

    Raises:
        InputError: If Ray is not installed.
    """
    try:
        import ray
    except ImportError:
        raise InputError('--ray needs Ray; install it with pip install "motioncast[cluster]"') from None

    def spread(
        model: str | Forecaster, scenes: list[Scene], horizon_s: float, alone: bool, progress: Progress
    ) -> list[np.ndarray]:
        answers: list[np.ndarray] = []
        ray.init(address=address, ignore_reinit_error=True, log_to_driver=False, include_dashboard=False)
        try:
            remote = ray.remote(forecast_chunk)
            jobs = [remote.remote(model, chunk, horizon_s, alone) for chunk in chunks(scenes)]
            for job in jobs:
                answers += ray.get(job)
                progress(len(answers) / len(scenes))
        finally:
            ray.shutdown()
        return answers

    return spread


def chunks(scenes: list[Scene]) -> Iterator[list[Scene]]:
    """Scenes, some at a time."""
    return (scenes[first : first + CHUNK] for first in range(0, len(scenes), CHUNK))


def forecast_chunk(model: str | Forecaster, scenes: list[Scene], horizon_s: float, alone: bool) -> list[np.ndarray]:
    """The most likely future of each scene, ``(time, people, joints, 3)``."""
    forecaster = _loaded(model) if isinstance(model, str) else model
    answers = []
    for scene in scenes:
        groups = [(person,) for person in scene.people] if alone else [scene.people]
        futures = [forecaster.forecast(scene.select(group), horizon_s=horizon_s).best for group in groups]
        answers.append(np.concatenate(futures, 1))
    return answers


_loaded = lru_cache(maxsize=1)(load_forecaster)
"""A worker loads a model once."""
