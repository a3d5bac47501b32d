"""Weights of a run."""

from __future__ import annotations

from pathlib import Path

import torch
from torch import nn


def load_weights(model: nn.Module, path: Path) -> nn.Module:
    """The model with the weights of a run's ``best.pt``, ready to answer."""
    state = torch.load(path, map_location="cpu", weights_only=True)
    model.load_state_dict({name: value.float() for name, value in state.items()})
    return model.eval()


def mean_of(paths: list[Path]) -> dict[str, torch.Tensor]:
    """The mean of the weights of several runs that began from the same ones, as float16."""
    states = [torch.load(path, map_location="cpu", weights_only=True) for path in paths]
    return {name: torch.stack([state[name].float() for state in states]).mean(0).half() for name in states[0]}
