from __future__ import annotations

import numpy as np
import pytest

pytest.importorskip("torch")
onnx = pytest.importorskip("onnx")
pytestmark = pytest.mark.torch

from onnx import TensorProto, helper, numpy_helper  # noqa: E402
from onnxruntime import InferenceSession  # noqa: E402

from motioncast.training.export import halved  # noqa: E402
from motioncast.training.hollow import hollow  # noqa: E402


def test_hollow_weights_keep_their_place_mean_and_spread() -> None:
    """The graph hands its weight through, so that what the runtime made of it can be looked at."""
    weight = np.random.default_rng(0).normal(0.3, 0.1, (200, 300)).astype(np.float32)
    nodes = [helper.make_node("Add", ["weight", "x"], ["sum"]), helper.make_node("Add", ["sum", "bias"], ["y"])]
    ends = [helper.make_tensor_value_info(name, TensorProto.FLOAT, [200, 300]) for name in ("x", "y")]
    bias = np.arange(300, dtype=np.float32)
    weights = [numpy_helper.from_array(values, name) for name, values in (("weight", weight), ("bias", bias))]
    graph = helper.make_graph(nodes, "sum", ends[:1], ends[1:], weights)
    full = halved(helper.make_model(graph, opset_imports=[helper.make_opsetid("", 18)], ir_version=8))
    size = len(full.SerializeToString())
    made = hollow(full).SerializeToString()
    assert len(made) < size / 50
    (answer,) = InferenceSession(made, providers=["CPUExecutionProvider"]).run(
        None, {"x": np.zeros((200, 300), np.float32)}
    )
    wave = np.asarray(answer) - bias
    np.testing.assert_allclose((wave.mean(), wave.std()), (weight.mean(), weight.std()), rtol=0.02)
    assert len(np.unique(wave.round(5))) > 1000
