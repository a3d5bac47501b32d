"""Faults of released trainers, a test each that ours does not have it; the numbers are those of ``docs/faults.md``."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

torch = pytest.importorskip("torch")

from motioncast.benchmarks import open_cmu  # noqa: E402
from motioncast.benchmarks.run import evaluate  # noqa: E402
from motioncast.core.skeletons import MRT15  # noqa: E402
from motioncast.datasets.mixer import turned  # noqa: E402
from motioncast.inference.registry import load  # noqa: E402
from motioncast.models.somoformer import SoMoFormer, SoMoFormerConfig  # noqa: E402
from motioncast.testing import walkers  # noqa: E402
from motioncast.training import loop, windows_task  # noqa: E402
from motioncast.training.batches import Sampler  # noqa: E402
from motioncast.training.recipe import Recipe  # noqa: E402
from motioncast.training.ship import ship  # noqa: E402

pytestmark = pytest.mark.torch

RECIPE = Recipe(
    name="toy",
    model="somoformer_fast",
    sizes={"width": 16, "layers": 1, "heads": 2, "feed_forward": 16},
    steps=3,
    batch=4,
    warmup=1,
    validate_every=1,
    card={"source": "a toy"},
)

PLAIN = replace(RECIPE, speed=(1.0, 1.0), scale=(1.0, 1.0), mirror=0.0, reverse=0.0, hide=0.0, late=0.0, drop=0.0)


def sampler(recipe: Recipe) -> Sampler:
    singles, couples = ([walkers(people, 400, 60, seed=people)] for people in (1, 2))
    return Sampler(singles, couples, recipe, 15, 45, 15.0)


def test_fault_03_the_test_chooses_the_model(data: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    asked = []
    for name in ("single_scenes", "couple_scenes"):
        original = getattr(open_cmu, name)

        def noted(folder: Path, split: str, *rest: object, original=original) -> list:
            asked.append(split)
            return original(folder, split, *rest)

        monkeypatch.setattr(open_cmu, name, noted)
    for folds in (0, 2):
        windows_task.training_takes(replace(RECIPE, folds=folds), data, MRT15)
    assert asked.count("train") >= 2
    assert "test" not in asked


def test_fault_06_the_grid_is_constant() -> None:
    model = SoMoFormer(SoMoFormerConfig(width=32, layers=1, heads=2, feed_forward=16, grid_width=4))
    x, y = torch.meshgrid(torch.linspace(-4.9, 4.9, 20), torch.linspace(-4.9, 4.9, 20), indexing="ij")
    neck = torch.stack([x.flatten(), y.flatten(), torch.ones(400)], -1)[None]
    cells = model.cell(neck, torch.ones(1, 400, dtype=torch.bool))
    assert len(torch.unique(cells[0], dim=0)) == 25


def test_fault_07_people_are_turned_without_their_places() -> None:
    random = np.random.default_rng(0)
    turning = sampler(replace(PLAIN, yaw=True))
    positions, _ = turning.scene(3, random)
    apart = np.linalg.norm(positions[:, :, None, 0] - positions[:, None, :, 0], axis=-1)
    spun = turned(positions, 2.0)
    again = np.linalg.norm(spun[:, :, None, 0] - spun[:, None, :, 0], axis=-1)
    np.testing.assert_allclose(again, apart, atol=1e-5)
    # a scene is turned as a whole: the couple of a turned scene is as far apart as it was recorded
    couple, _ = turning.scene(2, np.random.default_rng(1))
    straight, _ = sampler(PLAIN).scene(2, np.random.default_rng(1))
    for scene in (couple, straight):
        assert np.isfinite(scene).all()
    between = [np.linalg.norm(scene[:, 0] - scene[:, 1], axis=-1) for scene in (couple, straight)]
    assert sorted(map(float, between[0].mean(-1))) == pytest.approx(sorted(map(float, between[1].mean(-1))), abs=1e-4)


def test_fault_08_reversal_of_joints_instead_of_time() -> None:
    window, _ = sampler(PLAIN).window(1, np.random.default_rng(2))
    backwards, _ = sampler(replace(PLAIN, reverse=1.0)).window(1, np.random.default_rng(2))
    np.testing.assert_array_equal(backwards[::-1], window)  # reversed twice is the same
    for joint, parent in MRT15.bones:
        forth, back = (
            np.linalg.norm(motion[:, :, joint] - motion[:, :, parent], axis=-1) for motion in (window, backwards)
        )
        np.testing.assert_allclose(back[::-1], forth, atol=1e-6)


def test_fault_28_a_state_that_somebody_chose(data: Path, tmp_path: Path) -> None:
    loop.train(RECIPE, data, tmp_path, lambda line: None)
    entries = [json.loads(line) for line in (tmp_path / "metrics.jsonl").read_text(encoding="utf-8").splitlines()]
    best = min(entries, key=lambda entry: entry["score"])
    card = ship(tmp_path)
    assert card.figures["chosen_at_step"] == best["step"]  # by the validation takes, and the card says so
    assert card.training["scenes"] == best["step"] * RECIPE.batch


def test_fault_29_trainers_that_cannot_run(data: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    loop.train(RECIPE, data, tmp_path, lambda line: None)
    ship(tmp_path)
    result = evaluate(load(tmp_path / "toy.onnx"), "cmu-duet", data, split="validation")
    assert result.ratio.value > 0
