from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from motioncast.core.scene import Scene
from motioncast.core.skeleton import Skeleton
from motioncast.core.skeletons import MRT15
from motioncast.errors import InputError, ModelNotFound, SceneError, SkeletonError
from motioncast.inference.lift import Lift
from motioncast.inference.question import error_radius
from motioncast.inference.registry import DEFAULT_MODEL, list_models, load
from motioncast.inference.session import GraphForecaster
from motioncast.testing import walkers


@pytest.fixture(scope="module")
def model() -> GraphForecaster:
    model = load(DEFAULT_MODEL)
    assert isinstance(model, GraphForecaster)
    return model


def test_the_default_model_comes_first_and_ships() -> None:
    assert list_models()[0].name == DEFAULT_MODEL


def test_an_unknown_name_brings_the_closest() -> None:
    with pytest.raises(ModelNotFound, match='did you mean "somoformer-fast"'):
        load("somoformer-fsat")
    with pytest.raises(ModelNotFound, match="no file"):
        load("nowhere.onnx")


def test_a_short_history_is_refused_with_what_is_needed(model: GraphForecaster) -> None:
    with pytest.raises(SceneError, match="at least 29 frames"):
        model.forecast(walkers(frames=20, fps=30))


def test_geographic_coordinates_are_refused(model: GraphForecaster) -> None:
    scene = walkers()
    with pytest.raises(SceneError, match="from the origin"):
        model.forecast(replace(scene, positions=scene.positions + 5e5))


def test_a_skeleton_without_knees_is_refused(model: GraphForecaster) -> None:
    scene = walkers()
    names = tuple("thing" if name == "left_knee" else name for name in MRT15.names)
    odd = Skeleton(names, MRT15.parents, tuple("" if n == "thing" else n for n in names), "odd")
    with pytest.raises(SkeletonError, match="left_knee"):
        model.forecast(Scene(scene.positions, odd, 15))


def test_far_from_the_origin_the_answer_is_as_exact(model: GraphForecaster) -> None:
    scene = walkers()
    far = replace(scene, positions=scene.positions + np.array([800.0, -600.0, 0.0], np.float32))
    apart = model.forecast(far).samples - model.forecast(scene).samples - np.array([800.0, -600.0, 0.0])
    assert np.abs(apart).max() < 5e-3  # the history itself is rounded to 6e-5 there


def test_every_shipped_model_states_its_doubt_and_is_measured() -> None:
    for card in list_models():
        if card.parameters:
            if not card.stochastic:  # whose samples say how far apart futures are
                table = np.array(card.radius["levels"]["0.9"])
                assert table.shape == (card.horizon, len(card.joints)), card.name
                assert card.radius["n_takes"] > 0
            assert card.checksum
            assert card.licence


def test_the_radius_grows_with_time_and_nests(model: GraphForecaster) -> None:
    answer = model.forecast(walkers(fps=30, frames=60), horizon_s=4.0)
    half, most = answer.radius_m["0.5"], answer.radius_m["0.9"]
    assert half.shape == (120, 15)
    assert (np.diff(half, axis=0) >= -1e-6).all()
    assert (half <= most).all()


def test_radii_of_a_horizon_below_a_second_go_on(model: GraphForecaster) -> None:
    table = np.linspace(0.1, 1.4, 14)[:, None].repeat(15, 1).tolist()
    short = replace(model.card, horizon=14, radius={"levels": {"0.5": table}})
    radius = error_radius(short, Lift.between(MRT15, MRT15), walkers(), 28)["0.5"]
    np.testing.assert_allclose(radius[[0, 13, 27], 0], [0.1, 1.4, 2.8], rtol=1e-5)


@pytest.mark.parametrize("horizon_s", [0.0, -1.0, float("nan"), float("inf")])
@pytest.mark.parametrize("name", [DEFAULT_MODEL, "zero-velocity"])
def test_a_horizon_that_is_no_time_ahead_is_refused(name: str, horizon_s: float) -> None:
    with pytest.raises(InputError, match="positive number of seconds"):
        load(name).forecast(walkers(), horizon_s=horizon_s)


def test_without_rigid_bones_the_graph_speaks_for_itself(model: GraphForecaster) -> None:
    scene = walkers()
    raw = replace(model, rigid=False).forecast(scene).samples[0]
    graph = model.run(scene.positions[None, -15:], scene.observed[None, -15:])[0]
    np.testing.assert_allclose(raw, graph, atol=1e-5)


def test_a_card_that_is_missing_is_named(tmp_path) -> None:
    (tmp_path / "lonely.onnx").write_bytes(b"")
    with pytest.raises(InputError, match=r"lonely\.json"):
        load(tmp_path / "lonely.onnx")


def test_seventeen_people_are_too_many(model: GraphForecaster) -> None:
    with pytest.raises(SceneError, match="at most 16"):
        model.forecast(walkers(people=17))


@pytest.mark.parametrize("radius", [{}, {"levels": {"0.5": np.full((45, 15), 0.1).tolist()}}])
def test_the_error_radius_is_spoken_of_only_where_there_is_one(model: GraphForecaster, radius: dict) -> None:
    stated = replace(model, card=replace(model.card, radius=radius))
    scene = walkers(people=2)
    late = scene.observed.copy()
    late[:-3, 1] = False
    answer = stated.forecast(replace(scene, observed=late), horizon_s=4.0, samples=2)
    assert len(answer.warnings) == 3
    assert all(("radius" in warning) == bool(radius) for warning in answer.warnings)
