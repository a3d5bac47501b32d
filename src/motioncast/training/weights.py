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
