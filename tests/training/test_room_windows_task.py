"""What SAST's rivals learn from: windows of the same rooms, empty slots where nobody is."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

torch = pytest.importorskip("torch")

from motioncast.models import build  # noqa: E402
from motioncast.testing import walkers  # noqa: E402
from motioncast.training import room_windows_task, rooms_task  # noqa: E402
from motioncast.training.recipe import read_recipe  # noqa: E402

pytestmark = pytest.mark.torch


def made_up(data, split, count, seed):
    for number in range(count):
        scene = walkers(people=2 + number, frames=90, fps=25, seed=seed + number)
        here = np.ones(scene.observed.shape[:2], bool)
        here[60:, 1] = False
        yield SimpleNamespace(scene=replace(scene, observed=here[..., None].repeat(15, -1)), here=here)


@pytest.fixture(autouse=True)
def rooms(monkeypatch):
    monkeypatch.setattr(rooms_task, "rooms", made_up)
    monkeypatch.setattr(room_windows_task, "VALIDATION_ROOMS", 1)
    monkeypatch.setattr(room_windows_task, "VALIDATION_WINDOWS", 4)


def task(name):
    recipe = replace(read_recipe(name), rooms=2, batch=5)
    model = build(recipe.model, recipe.sizes)
    return room_windows_task.RoomWindowsTask(recipe, model, Path()), model


def test_slots_beyond_those_who_are_there_are_empty():
    learning, _ = task("mrt-rooms")
    batch = learning.batch(learning.train, 20, np.random.default_rng(0), mirror=0.5)
    assert batch.positions.shape == (20, 50, 4, 15, 3)
    there = batch.observed[:, 24].all(-1)
    assert set(there.sum(1)) == {1, 2, 3}
    nobody = ~batch.observed.any((1, 3))
    assert nobody.any()
    assert not batch.positions.swapaxes(1, 2)[nobody].any()


def test_a_model_of_one_person_gets_one():
    learning, model = task("simlpe-rooms")
    batch = next(learning.batches(np.random.default_rng(0)))
    assert batch.positions.shape[2] == 1
    assert batch.observed[:, 24].all()
    assert learning.loss(model, batch, torch.from_numpy).item() > 0
    assert set(learning.scores(model)) == {"rooms"}
