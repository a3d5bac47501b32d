"""From a trained denoiser to the two graphs that ship: the scene, once for a forecast, and a step of the diffusion.

Both take any number of people and of objects. Normalisation, scaling and the exchange between people are inside; the
loop over steps is not. Weights are stored as float16 and computed with as float32.
"""

from __future__ import annotations

import warnings
from pathlib import Path

import onnx
import torch
from torch import Tensor, nn

from motioncast.core.basis_points import WIDTH
from motioncast.core.card import ModelCard
from motioncast.core.skeleton import Skeleton
from motioncast.models.sast import SAST
from motioncast.nn.frames import turn
from motioncast.nn.hips import stand_on_hips
from motioncast.training.export import halved, signed

SCENE = {
    "codes": {0: "people", 1: "objects"},
    "objects": {0: "objects"},
    "memory": {0: "people", 1: "objects"},
}
STEP = {
    "history": {1: "people"},
    "observed": {1: "people"},
    "noisy": {0: "people"},
    "estimate": {1: "people"},
    "level": {},
    "memory": {0: "people", 1: "objects"},
    "objects": {0: "objects"},
    "goal": {0: "people"},
    "pull": {1: "people"},
    "clean": {0: "people"},
    "future": {1: "people"},
}
"""Names of inputs and outputs in order, and which of their axes have any length."""


class _Scene(nn.Module):
    """The objects of one scene, as a graph."""

    def __init__(self, model: SAST) -> None:
        super().__init__()
        self.model = model

    def forward(self, codes: Tensor, objects: Tensor) -> Tensor:
        return self.model.encode_objects(codes[None], objects[None])[0]


class _Step(nn.Module):
    """One step for everybody in one scene, as a graph; where ``pull`` is above 0 the answer is led to a goal."""

    def __init__(self, model: SAST) -> None:
        super().__init__()
        self.model = model

    def forward(
        self,
        history: Tensor,
        observed: Tensor,
        noisy: Tensor,
        estimate: Tensor,
        level: Tensor,
        memory: Tensor,
        objects: Tensor,
        goal: Tensor,
        pull: Tensor,
    ) -> tuple[Tensor, Tensor]:
        clean, future = self.model(
            history[None], observed[None], noisy[None], estimate[None], level, memory[None], objects[None]
        )
        led = led_to(goal, pull, future, self.model.skeleton)
        scaled = self.model.scaled(history[None], led)
        free = pull[None, ..., None, None] == 0
        return torch.where(free.transpose(1, 2), clean, scaled)[0], torch.where(free, future, led)[0]


def led_to(goal: Tensor, pull: Tensor, future: Tensor, skeleton: Skeleton) -> Tensor:
    """Futures drawn to a pose, wherever the hips are and whichever way they face.

    Args:
        goal: The pose of each person in the frame of its hips, on the floor (``nn.hips``), ``(P, J, 3)`` metres.
        pull: From 0, free, to 1, there; ``(F, P)``.
        future: ``(B, F, P, J, 3)`` metres, world.
        skeleton: Which joint is which.
    """
    origin, across = stand_on_hips(future, skeleton)
    wanted = turn(goal.expand_as(future), across[..., None, :]) + origin[..., None, :]
    return future + pull[..., None, None] * (wanted - future)


def export_diffusion(model: SAST, card: ModelCard, folder: Path) -> ModelCard:
    """Write ``NAME.scene.onnx``, ``NAME.onnx`` and ``NAME.json``.

    Args:
        model: The trained model.
        card: Its card.
        folder: Where the files go.

    Returns:
        The card with its parameters and the checksum of both graphs, one after the other.
    """
    config, people, things = model.config, 3, 4
    poses = torch.randn(config.frames, people, model.joints, 3)
    there = torch.ones(things, dtype=torch.bool)
    step = (
        poses[: config.history],
        torch.ones(config.history, people, dtype=torch.bool),
        torch.randn(people, config.horizon, model.joints, 3),
        poses[config.history :],
        torch.tensor(0.0),
        torch.randn(people, things, config.scene_width),
        there,
        poses[0],
        torch.rand(config.horizon, people),
    )
    scene_path, path = folder / f"{card.name}.scene.onnx", folder / f"{card.name}.onnx"
    _write(_Scene(model), (torch.rand(people, things, WIDTH), there), scene_path, SCENE)
    _write(_Step(model), step, path, STEP)
    return signed(card, model.parameters(), scene_path, path)


def _write(graph: nn.Module, inputs: tuple[Tensor, ...], path: Path, axes: dict[str, dict[int, str]]) -> None:
    names = list(axes)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # the tracer remarks on every shape
        torch.onnx.export(
            graph.eval(), inputs, path, input_names=names[: len(inputs)], output_names=names[len(inputs) :],
            dynamic_axes=axes, opset_version=18, dynamo=False,
        )  # fmt: skip
    path.write_bytes(halved(onnx.load(path)).SerializeToString())
