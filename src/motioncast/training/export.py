"""From a trained model to the graph and the card that ship.

The graph takes the world-frame history with masks and gives the world-frame future for any number of people;
weights are stored as float16 and computed with as float32.
"""

from __future__ import annotations

import hashlib
import warnings
from collections.abc import Iterable
from dataclasses import replace
from pathlib import Path

import numpy as np
import onnx
import torch
from onnx import numpy_helper
from torch import Tensor, nn

from motioncast.core.card import ModelCard
from motioncast.training.windows_task import final

SMALLEST_HALVED = 64
"""Tensors with fewer numbers keep float32: they are constants of the mathematics, not weights."""


class _Graph(nn.Module):
    """The model with one answer: that of its last layer."""

    def __init__(self, model: nn.Module) -> None:
        super().__init__()
        self.model = model

    def forward(self, history: Tensor, observed: Tensor) -> Tensor:
        return final(self.model(history, observed))


def export(model: nn.Module, card: ModelCard, folder: Path) -> ModelCard:
    """Write ``NAME.onnx`` and ``NAME.json``; returns the card with parameters and checksum filled in.

    Args:
        model: The trained model.
        card: Its card.
        folder: Where the two files go.
    """
    joints = len(card.joints)
    history = torch.randn(2, card.history, 3, joints, 3)
    observed = torch.ones(2, card.history, 3, joints, dtype=torch.bool)
    path = folder / f"{card.name}.onnx"
    axes = {0: "batch", 2: "people"}
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # the tracer remarks on every shape
        torch.onnx.export(
            _Graph(model).eval(),
            (history, observed),
            path,
            input_names=["history", "observed"],
            output_names=["future"],
            dynamic_axes={"history": axes, "observed": axes, "future": axes},
            opset_version=18,
            dynamo=False,
        )
    path.write_bytes(halved(onnx.load(path)).SerializeToString())
    return signed(card, model.parameters(), path)


def signed(card: ModelCard, parameters: Iterable[Tensor], *graphs: Path) -> ModelCard:
    """Write the card beside its graphs, of which the last one bears its name.

    Args:
        card: The card.
        parameters: What was trained of the network that answers.
        graphs: The ONNX files, in the order in which they are opened.

    Returns:
        The card with the number of parameters and the checksum of the graphs, one after the other.
    """
    checksum = hashlib.sha256(b"".join(graph.read_bytes() for graph in graphs)).hexdigest()
    done = replace(card, parameters=sum(part.numel() for part in parameters), checksum=checksum)
    graphs[-1].with_suffix(".json").write_text(done.to_json() + "\n", encoding="utf-8")
    return done


def halved(graph: onnx.ModelProto) -> onnx.ModelProto:
    """The graph with its weights as float16, each cast to float32 where it is used."""
    casts = []
    for tensor in graph.graph.initializer:
        values = numpy_helper.to_array(tensor)
        if values.dtype == np.float32 and values.size >= SMALLEST_HALVED:
            name = tensor.name
            tensor.CopyFrom(numpy_helper.from_array(values.astype(np.float16), f"{name}.half"))
            casts.append(onnx.helper.make_node("Cast", [f"{name}.half"], [name], to=onnx.TensorProto.FLOAT))
    nodes = list(graph.graph.node)
    del graph.graph.node[:]
    graph.graph.node.extend([*casts, *nodes])
    onnx.checker.check_model(graph)
    return graph
