"""From a model and its weights to an answer; NumPy and ONNX Runtime, never torch."""
