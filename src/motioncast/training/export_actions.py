"""From a trained model of steps to the graph that ships: one step of a video's people, for any number of samples."""

from __future__ import annotations

import warnings
from pathlib import Path

import onnx
import torch
from torch import Tensor, nn

from motioncast.core.card import ModelCard
from motioncast.core.skeletons import UPPER9
from motioncast.inference.actions import INPUTS
from motioncast.models.futurehuman3d import FutureHuman3D, Past
from motioncast.training.export import halved, signed

OUTPUTS = ("logits", "poses", "places")


class _Step(nn.Module):
    """One step, as a graph; the critic stays behind."""

    def __init__(self, model: FutureHuman3D) -> None:
        super().__init__()
        self.model = model

    def forward(self, *told: Tensor) -> tuple[Tensor, Tensor, Tensor]:
        *past, noise = told
        return tuple(self.model(Past(*past), noise))


def export_actions(model: FutureHuman3D, card: ModelCard, folder: Path) -> ModelCard:
    """Write ``NAME.onnx`` and ``NAME.json``; returns the card with parameters and checksum filled in.

    Args:
        model: The trained model.
        card: Its card.
        folder: Where the two files go.
    """
    config = model.config
    history, people, joints = config.history, config.people, len(UPPER9)
    told = (
        torch.randn(2, history, people, joints, 2),
        torch.ones(2, history, people, joints, dtype=torch.bool),
        torch.zeros(2, history, people, dtype=torch.int64),
        torch.zeros(2, config.objects),
        torch.tensor([[1000.0, 640.0, 360.0]]).repeat(2, 1),
        torch.ones(2, people),
        torch.zeros(2, people, config.noise),
    )
    path = folder / f"{card.name}.onnx"
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # the tracer remarks on every shape
        torch.onnx.export(
            _Step(model).eval(),
            told,
            path,
            input_names=list(INPUTS),
            output_names=list(OUTPUTS),
            dynamic_axes={name: {0: "samples"} for name in (*INPUTS, *OUTPUTS)},
            opset_version=18,
            dynamo=False,
        )
    path.write_bytes(halved(onnx.load(path)).SerializeToString())
    answering = (part for name, part in model.named_parameters() if not name.startswith("critic."))
    return signed(card, answering, path)
