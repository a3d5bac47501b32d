"""One loop for all models, export to ONNX, and the recipes."""
