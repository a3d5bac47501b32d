"""Options of commands that ask models which denoise."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

from motioncast.core.forecaster import LiveForecaster
from motioncast.errors import InputError


@Parameter(name="*")
@dataclass(frozen=True)
class Sampling:
    """How a model that denoises draws its futures."""

    sampler: Annotated[
        str | None,
        Parameter(help="Of models that denoise: ddpm, ddim, dpm-solver++ or unipc. Default: the model's own."),
    ] = None
    steps: Annotated[
        int | None, Parameter(help="Of models that denoise: passes for each future. Default: the model's own.")
    ] = None


AS_THE_CARD_SAYS = Sampling()


def task_of(model: str | Path) -> str:
    """What a model answers with (``card.task``)."""
    from motioncast.inference.registry import load

    return load(model).card.task


def load_sampling(model: str | Path, sampling: Sampling = AS_THE_CARD_SAYS) -> LiveForecaster:
    """A model by name or path that draws its futures so.

    Raises:
        InputError: If it answers with something else, does not denoise, or cannot do it so.
    """
    from motioncast.inference.registry import load_forecaster

    forecaster = load_forecaster(model)
    if sampling == AS_THE_CARD_SAYS:
        return forecaster
    from motioncast.inference.denoiser import DiffusionForecaster

    if not isinstance(forecaster, DiffusionForecaster):
        raise InputError(f'model "{model}" does not denoise; leave --sampler and --steps out')
    return forecaster.sampled_by(sampling.sampler, sampling.steps)
