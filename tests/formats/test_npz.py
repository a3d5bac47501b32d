"""Scene and forecast files: all comes back, and what is damaged is refused."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest

from motioncast.core.card import ModelCard
from motioncast.core.forecast import Forecast
from motioncast.core.kinematics import fit_rotations
from motioncast.errors import FormatError, InputError
from motioncast.formats import npz
from motioncast.formats.files import read_npz


def forecast_of(scene):
    card = ModelCard("toy", "Toy", "forecast", "mrt15", 15, 45, 15)
    samples = np.random.default_rng(0).normal(size=(2, 5, 2, 15, 3)).astype(np.float32)
    return Forecast(
        samples, scene, scene.people, card, np.array([0.25, 0.75], np.float32),
        {"0.5": np.ones((5, 15), np.float32)}, seed=7, warnings=("the future is open",),
    )  # fmt: skip


def test_a_scene_comes_back_whole(tmp_path, walkers):
    seen = walkers.observed.copy()
    seen[40:, 1] = False
    scene = replace(fit_rotations(walkers), observed=seen, remarks=("said",))
    npz.write(scene, tmp_path / "a.npz")
    back = npz.read(tmp_path / "a.npz")
    for name in ("skeleton", "fps", "people", "source", "remarks"):
        assert getattr(back, name) == getattr(scene, name)
    for name in ("positions", "observed", "rotations", "offsets"):
        np.testing.assert_array_equal(getattr(back, name), getattr(scene, name))


def test_a_forecast_comes_back_whole(tmp_path, walkers):
    forecast = forecast_of(walkers)
    npz.write_forecast(forecast, tmp_path / "f.npz", truth=walkers[:5])
    back, truth = npz.read_forecast(tmp_path / "f.npz"), npz.read_truth(tmp_path / "f.npz")
    assert truth is not None
    np.testing.assert_array_equal(truth.positions, walkers[:5].positions)
    for name in ("samples", "weights", "carried", "guessed"):
        np.testing.assert_array_equal(getattr(back, name), getattr(forecast, name))
    assert (back.people, back.seed, back.warnings, back.card) == (walkers.people, 7, forecast.warnings, forecast.card)
    np.testing.assert_array_equal(back.radius_m["0.5"], forecast.radius_m["0.5"])
    np.testing.assert_array_equal(npz.read(tmp_path / "f.npz").positions, walkers.positions)
    npz.write_forecast(forecast, tmp_path / "g.npz")
    assert npz.read_truth(tmp_path / "g.npz") is None


def test_the_same_scene_is_the_same_file(tmp_path, walkers):
    for name in ("a.npz", "b.npz"):
        npz.write(walkers, tmp_path / name)
    assert (tmp_path / "a.npz").read_bytes() == (tmp_path / "b.npz").read_bytes()


@pytest.mark.parametrize(
    ("entry", "value", "message"),
    [
        ("schema", "motioncast.scene/9", "has the schema"),
        ("fps", "fast", 'entry "fps"'),
        ("fps", -3.0, "frame rate"),
        ("people", ["ada"], "ids came"),
        ("people", [1, 2], "texts only"),
        ("skeleton", {"names": ["a"], "parents": [-1], "landmarks": [""], "label": "x"}, 'array "positions"'),
        ("skeleton", {"names": ["a"], "parents": [0.5], "landmarks": [""], "label": "x"}, "whole numbers"),
    ],
)
def test_wrong_entries_are_named(tmp_path, walkers, entry, value, message):
    path = tmp_path / "a.npz"
    npz.write(walkers, path)
    arrays = read_npz(path)
    meta = json.loads(str(arrays.pop("meta")))
    np.savez(path, meta=np.array(json.dumps({**meta, entry: value})), **arrays)
    with pytest.raises(FormatError, match=message):
        npz.read(path)


def test_wrong_arrays_are_named(tmp_path, walkers):
    path = tmp_path / "a.npz"
    npz.write(walkers, path)
    arrays = read_npz(path)
    broken = arrays["positions"].copy()
    broken[0, 0, 0] = np.nan
    for positions, message in ((broken, "not finite"), (broken[..., :2], "expected kind f")):
        np.savez(path, **{**arrays, "positions": positions})
        with pytest.raises(FormatError, match=message):
            npz.read(path)
    np.savez(path, positions=broken)
    with pytest.raises(FormatError, match='no text "meta"'):
        npz.read(path)


def test_other_axes_and_units_are_refused(tmp_path, walkers):
    npz.write(walkers, tmp_path / "a.npz")
    with pytest.raises(InputError, match="metres with z up"):
        npz.read(tmp_path / "a.npz", up="y")
