"""From made-up rooms to two shipped graphs: what a batch holds, and that what ships answers."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

torch = pytest.importorskip("torch")

from motioncast.core.scene_object import SceneObject  # noqa: E402
from motioncast.core.shapes import surface_distance  # noqa: E402
from motioncast.inference.registry import load  # noqa: E402
from motioncast.testing import walkers  # noqa: E402
from motioncast.training import rooms_task  # noqa: E402
from motioncast.training.loop import train  # noqa: E402
from motioncast.training.recipe import Recipe  # noqa: E402
from motioncast.training.ship import ship  # noqa: E402

pytestmark = pytest.mark.torch

SIZES = {
    "channels": (32, 32), "others_channels": (32, 32), "scene_width": 32, "scene_layers": 1, "people_width": 32,
    "people_layers": 1, "history": 25, "horizon": 39,
}  # fmt: skip
RECIPE = Recipe(
    name="toy-rooms", model="sast", task="rooms", rooms=2, sizes=SIZES, steps=2, batch=2, warmup=1, validate_every=2
)
TABLE = SceneObject(
    "table", "table", "box", np.array([1, 0.6, 0.7]), np.array([1, 2, 0.35]), np.array([0.9, 0, 0, np.sqrt(0.19)])
)


def made_up(data, split, count, seed):
    for number in range(count):
        scene = walkers(people=2 + number, frames=90, fps=25, seed=seed + number)
        here = np.ones(scene.observed.shape[:2], bool)
        here[60:, 1] = False
        scene = replace(scene, objects=(TABLE,) * (1 + number), observed=here[..., None].repeat(15, -1))
        yield SimpleNamespace(scene=scene, here=here)


@pytest.fixture(autouse=True)
def rooms(monkeypatch):
    monkeypatch.setattr(rooms_task, "rooms", made_up)
    monkeypatch.setattr(rooms_task, "VALIDATION_ROOMS", 1)
    monkeypatch.setattr(rooms_task, "VALIDATION_BATCHES", 1)


def task(**changes):
    from motioncast.models import build

    recipe = replace(RECIPE, **changes)
    return rooms_task.RoomsTask(recipe, build(recipe.model, recipe.sizes), Path())


def test_a_batch_is_of_people_who_are_there_now_and_what_they_see():
    learning = task()
    batch = learning.batch(learning.train, 4, np.random.default_rng(0), mirror=0.0)
    assert batch.present[:, 24].all()
    assert batch.codes.shape[:2] == batch.positions.shape[:1] + batch.positions.shape[2:3]
    assert len(batch.positions) == max(1, 4 // batch.positions.shape[2])
    assert batch.there.any(1).all()
    assert (batch.step == batch.step[:, :1]).all(), "everybody of a scene is equally noisy, as in use"


def test_mirrored_people_stand_as_far_from_mirrored_things():
    points = np.random.default_rng(0).normal(0, 2, (50, 3))
    image = points * [-1, 1, 1]
    np.testing.assert_allclose(
        surface_distance(rooms_task.mirrored(TABLE), image), surface_distance(TABLE, points), atol=1e-6
    )


def test_who_stands_about_is_drawn_less_often():
    learning = task()
    standing = [(np.repeat(positions[:1], 90, 0), here, things) for positions, here, things in learning.train]
    random = np.random.default_rng(1)
    share = [
        np.ptp(learning.window([*learning.train[:1], *standing[:1]], random, 0.0)[0][:, 0, 0, 0]) > 0.1
        for _ in range(200)
    ]
    assert 0.58 < np.mean(share) < 0.75


def test_what_is_trained_ships_and_answers(tmp_path):
    train(RECIPE, Path(), tmp_path, lambda line: None)
    card = ship(tmp_path)
    assert card.stochastic
    assert set(card.figures["validation_loss"]) == {"little", "medium", "much"}
    scene = replace(walkers(people=3, frames=40, fps=25), objects=(TABLE,), floor_m=0.0)
    answer = load(tmp_path / "toy-rooms.onnx").forecast(scene, samples=2)
    assert answer.samples.shape == (2, 39, 3, 15, 3)
    assert np.abs(answer.samples[0] - answer.samples[1]).max() > 1e-3
