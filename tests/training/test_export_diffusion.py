"""A denoiser's two graphs answer as it does."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

torch = pytest.importorskip("torch")
onnxruntime = pytest.importorskip("onnxruntime")

from motioncast.core.basis_points import WIDTH, hip_frame  # noqa: E402
from motioncast.core.card import ModelCard  # noqa: E402
from motioncast.core.skeletons import MRT15  # noqa: E402
from motioncast.core.voxels import turned_back  # noqa: E402
from motioncast.models.sast import SAST, SASTConfig  # noqa: E402
from motioncast.training.export_diffusion import export_diffusion  # noqa: E402

pytestmark = pytest.mark.torch

CONFIG = SASTConfig(
    history=9, horizon=18, channels=(32, 32, 64), others_channels=(32, 32, 32), scene_width=32, scene_layers=1,
    people_width=32, people_layers=2,
)  # fmt: skip


@pytest.fixture(scope="module")
def model() -> SAST:
    torch.manual_seed(0)
    model = SAST(CONFIG).eval()
    for parameter in model.decoder.blocks[-1].parameters():
        torch.nn.init.normal_(parameter, std=0.03)
    return model.half().float()  # what ships is rounded


@pytest.fixture(scope="module")
def folder(model: SAST, tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("graphs")
    card = ModelCard("toy", "SAST", "forecast", "mrt15", CONFIG.history, CONFIG.horizon, CONFIG.fps, stochastic=True)
    done = export_diffusion(model, card, folder)
    assert done.parameters == sum(parameter.numel() for parameter in model.parameters())
    assert ModelCard.from_json((folder / "toy.json").read_text()) == done
    return folder


@pytest.mark.parametrize(("people", "objects"), [(1, 1), (2, 3), (5, 6)])
def test_graphs_and_torch_agree(model: SAST, folder: Path, people: int, objects: int) -> None:
    random = np.random.default_rng(people)

    def normal(*size: int) -> np.ndarray:
        return random.normal(size=size).astype(np.float32)

    codes, there = np.abs(normal(people, objects, WIDTH)) * 3, np.arange(objects) > 0
    given = {
        "history": normal(CONFIG.history, people, 15, 3),
        "observed": random.random((CONFIG.history, people)) < 0.9,
        "noisy": normal(people, CONFIG.horizon, 15, 3),
        "estimate": normal(CONFIG.horizon, people, 15, 3),
        "level": np.array(-1.5, np.float32),
    }
    scene, step = (onnxruntime.InferenceSession(folder / f"toy{part}.onnx") for part in (".scene", ""))
    (memory,) = scene.run(None, {"codes": codes, "objects": there})
    free = {"goal": normal(people, 15, 3), "pull": np.zeros((CONFIG.horizon, people), np.float32)}
    clean, future = step.run(None, given | free | {"memory": memory, "objects": there})
    assert clean.shape == given["noisy"].shape
    assert future.shape == given["estimate"].shape
    with torch.no_grad():
        tensors = {name: torch.from_numpy(value)[None] for name, value in given.items()}
        tensors["level"] = tensors["level"][0]
        tensors["there"] = torch.from_numpy(there)[None]
        tensors["memory"] = model.encode_objects(torch.from_numpy(codes)[None], tensors["there"])
        expected = model(**tensors)
    np.testing.assert_allclose(memory, tensors["memory"][0], atol=1e-4)
    np.testing.assert_allclose(clean, expected[0][0], atol=1e-4)
    np.testing.assert_allclose(future, expected[1][0], atol=1e-4)


def test_a_future_is_led_to_a_goal(folder: Path) -> None:
    random = np.random.default_rng(4)
    history = random.normal(size=(CONFIG.history, 2, 15, 3)).astype(np.float32)
    goal = random.normal(size=(2, 15, 3)).astype(np.float32)
    hips = [MRT15.index(f"{side}_hip") for side in ("left", "right")]
    goal[:, hips, :2] = np.array([[-0.1, 0.0], [0.1, 0.0]])
    pull = np.linspace(0, 1, CONFIG.horizon, dtype=np.float32)[:, None] * np.array([[1, 0]], np.float32)
    given = {
        "history": history, "observed": np.ones((CONFIG.history, 2), bool), "level": np.array(2.0, np.float32),
        "noisy": random.normal(size=(2, CONFIG.horizon, 15, 3)).astype(np.float32),
        "estimate": np.repeat(history[-1:], CONFIG.horizon, 0),
        "memory": np.zeros((2, 1, 32), np.float32), "objects": np.zeros(1, bool), "goal": goal,
    }  # fmt: skip
    step = onnxruntime.InferenceSession(folder / "toy.onnx")
    clean, future = step.run(None, given | {"pull": pull})
    free_clean, free_future = step.run(None, given | {"pull": 0 * pull})
    np.testing.assert_array_equal(future[:, 1], free_future[:, 1])  # who has no goal
    np.testing.assert_array_equal(clean[1], free_clean[1])
    origin, across = hip_frame(future[-1, 0], MRT15)
    reached = turned_back(future[-1, 0] - origin, across)
    np.testing.assert_allclose(reached, goal[0], atol=1e-4)
    assert np.abs(clean[0] - free_clean[0]).max() > 0.01
