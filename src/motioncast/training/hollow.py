"""Graphs of a published size without its megabytes: weights that are a formula, for measuring time.

How long a pass takes does not depend on what the weights are. Here each one is a sine wave with the mean and the spread
of the untrained weights that it replaces; ONNX Runtime works them out when it opens the graph. To write those of
``motioncast time --paper-size`` again:

    python -m motioncast.training.hollow
"""

from __future__ import annotations

import hashlib
from dataclasses import replace
from importlib import resources
from pathlib import Path

import numpy as np
import onnx
import torch
from onnx import helper, numpy_helper

from motioncast.core.card import ModelCard
from motioncast.models.sast import PRESETS, SAST
from motioncast.training.export_diffusion import export_diffusion
from motioncast.training.ship import SAMPLING

PHASE = 2.399963
"""Radians from one weight to the next: the golden angle, which never comes round."""

SMALLEST = 1024
"""Tensors with fewer numbers stay as they are."""


def hollow(graph: onnx.ModelProto) -> onnx.ModelProto:
    """The graph with formulas for its halved weights (``training.export.halved``)."""
    formulas, kept = [], []
    for tensor in graph.graph.initializer:
        values = numpy_helper.to_array(tensor)
        if values.dtype != np.float16 or values.size < SMALLEST:
            kept.append(tensor)
            continue
        name, weights = tensor.name, values.astype(np.float64)
        numbers = {"start": 0, "end": values.size, "one": 1, "phase": PHASE, "mean": weights.mean()}
        for part, number in {**numbers, "spread": 2**0.5 * weights.std()}.items():
            kept.append(numpy_helper.from_array(np.array(number, np.float32), f"{name}.{part}"))
        kept.append(numpy_helper.from_array(np.array(values.shape, np.int64), f"{name}.shape"))
        for kind, inward, outward in (
            ("Range", ("start", "end", "one"), "number"),
            ("Mul", ("number", "phase"), "angle"),
            ("Sin", ("angle",), "wave"),
            ("Mul", ("wave", "spread"), "high"),
            ("Add", ("high", "mean"), "flat"),
            ("Reshape", ("flat", "shape"), ""),
        ):
            inputs = [f"{name}.{part}" for part in inward]
            formulas.append(helper.make_node(kind, inputs, [f"{name}.{outward}" if outward else name]))
    nodes = [*formulas, *graph.graph.node]
    for node in nodes:
        node.name = ""  # a third of the file
    for entries, wanted in ((graph.graph.node, nodes), (graph.graph.initializer, kept)):
        del entries[:]
        entries.extend(wanted)
    onnx.checker.check_model(graph)
    return graph


def sast_at_paper_size(folder: Path) -> ModelCard:
    """Write ``sast.onnx``, ``sast.scene.onnx`` and ``sast.json`` with the sizes of SAST's paper.

    Args:
        folder: Where the files go.
    """
    torch.manual_seed(0)
    config = PRESETS["motioncast"]
    card = ModelCard(
        "sast", "SAST", "forecast", config.skeleton, config.history, config.horizon, config.fps, stochastic=True,
        diffusion={"steps": config.steps, "shift": config.shift, **SAMPLING},
        data="none: the weights are made up, to measure time", licence="Apache-2.0",
    )  # fmt: skip
    card = export_diffusion(SAST(config), card, folder)
    digest = hashlib.sha256()
    for path in (folder / "sast.scene.onnx", folder / "sast.onnx"):
        path.write_bytes(hollow(onnx.load(path)).SerializeToString())
        digest.update(path.read_bytes())
    card = replace(card, checksum=digest.hexdigest())
    (folder / "sast.json").write_text(card.to_json() + "\n", encoding="utf-8")
    return card


if __name__ == "__main__":
    sast_at_paper_size(Path(str(resources.files("motioncast"))) / "weights" / "paper-size")
