"""From a trained model of characteristic poses to the graph that ships: one stage, for any number of hypotheses.

The graph takes histories as ``core.voxels.hip_centred`` makes them, the hands that are known, the stage and the joints
that are asked for. Levels become heat inside, so that little comes out. Weights are stored as float16.
"""

from __future__ import annotations

import warnings
from pathlib import Path

import onnx
import torch
from torch import Tensor, nn

from motioncast.core.card import ModelCard
from motioncast.errors import InputError
from motioncast.models.characteristic_poses import CharacteristicPoses
from motioncast.nn.voxels import CLASSES
from motioncast.training.export import halved, signed

AXES = {
    "history": {0: "people"},
    "known": {0: "people", 1: "hypotheses"},
    "stage": {},
    "asked": {0: "asked"},
    "heat": {0: "rows", 1: "asked"},
    "level": {0: "rows", 1: "asked"},
    "offsets": {0: "rows", 1: "asked"},
}
"""Names of inputs and outputs in order, and which of their axes have any length; a row is a hypothesis of a person."""


class GoalGraph(nn.Module):
    """A stage as a graph.

    Args:
        model: The trained model.
    """

    def __init__(self, model: CharacteristicPoses) -> None:
        super().__init__()
        self.network = model.networks[0]

    def forward(self, history: Tensor, known: Tensor, stage: Tensor, asked: Tensor) -> tuple[Tensor, Tensor, Tensor]:
        """Heat, most likely level and offsets of each voxel.

        Args:
            history: ``(people, T, joints, 3)`` metres, hip-centred.
            known: ``(people, hypotheses, 2, 3)``.
            stage: A whole number.
            asked: Joints, ``(asked,)``.

        Returns:
            The expected level from 0 to 1 and the likeliest level from 0 to 9, ``(rows, asked, V, V, V)``, and offsets
            ``(rows, asked, 3, V, V, V)`` metres.
        """
        said = self.network(history, known, stage, asked)
        odds = (said.heat - said.heat.amax(2, keepdim=True)).exp()
        levels = torch.arange(CLASSES, device=odds.device, dtype=odds.dtype)[:, None, None, None] / (CLASSES - 1)
        return (odds * levels).sum(2) / odds.sum(2), said.heat.argmax(2), said.offsets


def export_goals(model: CharacteristicPoses, card: ModelCard, folder: Path) -> ModelCard:
    """Write ``NAME.onnx`` and ``NAME.json``.

    Args:
        model: The trained model.
        card: Its card.
        folder: Where the files go.

    Returns:
        The card with its parameters and the checksum of the graph.

    Raises:
        InputError: If the model is not a light one that looks at one person alone.
    """
    config = model.config
    if config.preset != "light" or config.partner or config.actions:
        raise InputError(
            f'the preset "{config.preset}" with {config.actions} actions and partner = {config.partner} has no graph; '
            "ship a light model without them"
        )
    inputs = (
        torch.randn(2, config.history, config.joints, 3),
        torch.randn(2, 3, 2, 3),
        torch.tensor(1),
        torch.tensor([config.hands[1], 0]),
    )
    names, path = list(AXES), folder / f"{card.name}.onnx"
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # the tracer remarks on every shape
        torch.onnx.export(
            GoalGraph(model).eval(), inputs, path, input_names=names[:4], output_names=names[4:], dynamic_axes=AXES,
            opset_version=18, dynamo=False,
        )  # fmt: skip
    path.write_bytes(halved(onnx.load(path)).SerializeToString())
    return signed(card, model.parameters(), path)
