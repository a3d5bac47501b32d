"""A denoising pass of SAST at the paper's size: ours as a graph and in torch beside the release's arithmetic in torch.

    python benchmarks/sast_speed.py [--threads 2] [--rounds 5]

Random weights, all interleaved in one process, medians. Needs the train extra. A forecast of ours takes 20 passes, the
published one 1,000.
"""

from __future__ import annotations

import argparse
import tempfile
from collections.abc import Callable
from pathlib import Path

import numpy as np
import onnxruntime
import torch
from speed import interleaved

from motioncast.core.basis_points import WIDTH
from motioncast.core.card import ModelCard
from motioncast.models.sast import PRESETS, SAST
from motioncast.training.export_diffusion import STEP, export_diffusion

SIZES = ((1, 30), (3, 30), (8, 50), (16, 50))
"""People and objects."""


def inputs(model: SAST, people: int, objects: int) -> tuple[torch.Tensor, ...]:
    """One scene as a pass takes it, with its objects read before."""
    c = model.config
    poses = torch.randn(1, c.frames, people, model.joints, 3)
    there = torch.ones(1, objects, dtype=torch.bool)
    memory = model.encode_objects(torch.rand(1, people, objects, WIDTH), there)
    return (
        poses[:, : c.history], torch.ones(1, c.history, people, dtype=torch.bool),
        torch.randn(1, people, c.horizon, model.joints, 3), poses[:, c.history :], torch.tensor(0.0), memory, there,
    )  # fmt: skip


def in_torch(model: SAST, people: int, objects: int) -> Callable[[], object]:
    """A pass in torch; the published network encodes its objects in every pass."""
    given = inputs(model, people, objects)
    codes = torch.rand(1, people, objects, WIDTH)

    def run() -> object:
        with torch.inference_mode():
            if not model.config.published:
                return model(*given)
            return model(*given[:5], model.encode_objects(codes, given[6]), given[6])

    return run


def as_graph(model: SAST, session: onnxruntime.InferenceSession, people: int, objects: int) -> Callable[[], object]:
    """The same pass by ONNX Runtime."""
    with torch.inference_mode():
        given = [part if part.ndim == 0 else part[0] for part in inputs(model, people, objects)]
    named: dict[str, np.ndarray] = {name: part.numpy() for name, part in zip(STEP, given, strict=False)}
    return lambda: session.run(None, named)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument("--rounds", type=int, default=5)
    asked = parser.parse_args()
    torch.set_num_threads(asked.threads)
    ours, release = (SAST(PRESETS[name]).eval() for name in ("motioncast", "release"))
    options = onnxruntime.SessionOptions()
    options.intra_op_num_threads = asked.threads
    with tempfile.TemporaryDirectory() as folder:
        config = ours.config
        card = ModelCard("sast", "SAST", "forecast", config.skeleton, config.history, config.horizon, config.fps)
        export_diffusion(ours, card, Path(folder))
        session = onnxruntime.InferenceSession(str(Path(folder) / "sast.onnx"), options)
    print(f"| ms a pass, {asked.threads} thread(s) | ours, graph | ours, torch | release's arithmetic, torch |")
    print("|---|---:|---:|---:|")
    for people, objects in SIZES:
        runs = {
            "graph": as_graph(ours, session, people, objects),
            "ours": in_torch(ours, people, objects),
            "release": in_torch(release, people, objects),
        }
        found = interleaved(runs, asked.rounds)
        print(
            f"| {people} people, {objects} objects | " + " | ".join(f"{found[name]:.0f}" for name in runs) + " |",
            flush=True,
        )


if __name__ == "__main__":
    main()
