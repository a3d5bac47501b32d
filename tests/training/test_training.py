"""From made-up takes in CMU's layout to a shipped graph: train, be killed, go on, export, agree."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

torch = pytest.importorskip("torch")

from motioncast.errors import InputError  # noqa: E402
from motioncast.training.batches import Sampler  # noqa: E402
from motioncast.training.recipe import Recipe, read_recipe  # noqa: E402

pytestmark = pytest.mark.torch

RECIPE = Recipe(
    name="toy",
    model="somoformer_fast",
    sizes={"width": 16, "layers": 1, "heads": 2, "feed_forward": 16},
    steps=4,
    batch=4,
    warmup=1,
    validate_every=2,
    card={"source": "a toy"},
)


PAPER = replace(
    RECIPE,
    name="toy-paper",
    model="somoformer",
    sizes={"width": 16, "layers": 2, "heads": 2, "feed_forward": 16, "grid_width": 4},
    steps=2,
    yaw=True,
)


@pytest.fixture(scope="module")
def run(data: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A run that was stopped after two steps and went on to four."""
    from motioncast.training.loop import train

    out = tmp_path_factory.mktemp("run")
    said: list[str] = []
    train(replace(RECIPE, steps=2), data, out, said.append)
    train(RECIPE, data, out, said.append)
    assert any("going on from step 2" in line for line in said)
    return out


def test_the_log_goes_on_where_it_stopped(run: Path) -> None:
    entries = [json.loads(line) for line in (run / "metrics.jsonl").read_text(encoding="utf-8").splitlines()]
    assert [entry["step"] for entry in entries] == [2, 4]
    assert set(entries[0]["validation"]) == {"couple", "crowd"}


def test_another_recipe_does_not_go_on_in_the_same_folder(run: Path, data: Path) -> None:
    from motioncast.training.loop import train

    with pytest.raises(InputError, match="another recipe"):
        train(replace(RECIPE, batch=5), data, run)


def test_the_papers_model_trains_and_its_graph_agrees(data: Path, tmp_path: Path) -> None:
    from motioncast.training.loop import train

    train(PAPER, data, tmp_path, lambda line: None)
    agree(PAPER, tmp_path)


def test_graph_and_torch_agree_for_any_number_of_people(run: Path) -> None:
    agree(RECIPE, run)


def agree(recipe: Recipe, run: Path) -> None:
    """The exported graph of a run answers as its torch model does."""
    from motioncast.inference.registry import load
    from motioncast.models import build
    from motioncast.training.ship import ship
    from motioncast.training.weights import load_weights
    from motioncast.training.windows_task import final

    card = ship(run)
    assert card.parameters > 0
    forecaster = load(run / f"{recipe.name}.onnx")
    model = load_weights(build(recipe.model, recipe.sizes), run / "best.pt")
    random = np.random.default_rng(0)
    for people in (1, 2, 5):
        history = random.normal(size=(2, 15, people, 15, 3)).astype(np.float32)
        observed = random.random((2, 15, people, 15)) < 0.9
        with torch.no_grad():
            expected = final(model(torch.from_numpy(history), torch.from_numpy(observed))).numpy()
        np.testing.assert_allclose(forecaster.run(history, observed), expected, atol=1e-4)  # pyright: ignore


def test_a_damaged_graph_is_refused(run: Path, tmp_path: Path) -> None:
    from motioncast.inference.registry import load
    from motioncast.training.ship import ship

    ship(run, tmp_path)
    weights = tmp_path / "toy.onnx"
    weights.write_bytes(weights.read_bytes()[:-1])
    forecaster = load(weights)
    with pytest.raises(InputError, match="checksum"):
        forecaster.run(np.zeros((1, 15, 1, 15, 3), np.float32), np.ones((1, 15, 1, 15), bool))  # pyright: ignore


def sampler(data: Path, recipe: Recipe) -> Sampler:
    from motioncast.benchmarks.open_cmu import couple_scenes, single_scenes
    from motioncast.core.skeletons import MRT15

    return Sampler(single_scenes(data, "train", 60, MRT15), couple_scenes(data, "train", 60, MRT15), recipe, 15, 45, 15)


def test_batches_are_seeded_and_finite(data: Path) -> None:
    draws = [next(sampler(data, RECIPE).batches(np.random.default_rng(3))) for _ in range(2)]
    np.testing.assert_array_equal(draws[0].positions, draws[1].positions)
    assert np.isfinite(draws[0].positions).all()
    assert draws[0].positions.shape[1:] == (60, draws[0].positions.shape[2], 15, 3)


def test_a_fixed_number_of_scenes_is_drawn_once_and_seen_again(data: Path) -> None:
    recipe = replace(RECIPE, scenes=3 * RECIPE.batch, seed=4)
    batches = sampler(data, recipe).batches(np.random.default_rng(0))
    seen = {next(batches).seen.tobytes() for _ in range(40)}
    assert len(seen) == 3
    other = sampler(data, recipe).batches(np.random.default_rng(1))
    assert {next(other).seen.tobytes() for _ in range(40)} == seen


def test_mirroring_swaps_sides_and_reversal_keeps_bones(data: Path) -> None:
    plain = replace(RECIPE, reverse=0.0, mirror=0.0, speed=(1.0, 1.0), scale=(1.0, 1.0))
    lengths = []
    for recipe in (plain, replace(plain, reverse=1.0), replace(plain, mirror=1.0)):
        window, _ = sampler(data, recipe).window(1, np.random.default_rng(0))
        lengths.append(np.linalg.norm(window[:, 0, 2] - window[:, 0, 1], axis=-1))  # left hip to left knee
        right = np.linalg.norm(window[:, 0, 5] - window[:, 0, 4], axis=-1)
        lengths.append(right)
    np.testing.assert_allclose(lengths[0], lengths[2][::-1], atol=1e-4)
    np.testing.assert_allclose(lengths[0], lengths[5], atol=1e-4)  # mirrored: the left thigh was the right one


def test_the_future_is_not_worsened_and_not_seen(data: Path) -> None:
    batch = next(sampler(data, replace(RECIPE, hide=0.0, drop=0.5)).batches(np.random.default_rng(0)))
    assert batch.observed[:, 15:].all()
    assert not batch.observed[:, :15].all()
    assert batch.seen.shape[1] == 15


def test_recipes_are_checked(tmp_path: Path) -> None:
    assert read_recipe("somoformer-fast").model == "somoformer_fast"
    with pytest.raises(InputError, match="no recipe"):
        read_recipe("nothing")
    odd = tmp_path / "odd.toml"
    odd.write_text('name = "a"\nmodel = "b"\nsteeps = 3\n', encoding="utf-8")
    with pytest.raises(InputError, match="steeps"):
        read_recipe(odd)


def test_the_mean_of_the_weights_follows_and_takes_statistics_as_they_are() -> None:
    from motioncast.training.loop import follow

    model, mean = torch.nn.BatchNorm1d(2), torch.nn.BatchNorm1d(2)
    torch.nn.init.constant_(model.weight, 3.0)
    model(torch.randn(8, 2) + 5)
    follow(mean, model, 0.75)
    torch.testing.assert_close(mean.weight, torch.full((2,), 1.5))
    torch.testing.assert_close(mean.running_mean, model.running_mean)
