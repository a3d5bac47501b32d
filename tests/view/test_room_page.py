"""A furnished room in the page's file: things, their tracks, the floor."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from pages import forecast_of, read

from motioncast.core import rotation
from motioncast.core.scene import Scene
from motioncast.core.scene_object import SceneObject
from motioncast.view.furniture import MOST_POINTS, MOST_TRIANGLES
from motioncast.view.page import page_html

TURN = rotation.from_axis_angle(np.array([0.0, 0.0, 0.7]))
TABLE = SceneObject(
    "table 1", "table", "box", np.array([1.6, 0.8, 0.72]), np.array([2.0, 1.0, 1.36]), TURN, role="decoy"
)


def test_things_stand_where_they_stand(walkers: Scene) -> None:
    about, arrays = read(page_html(forecast_of(replace(walkers, objects=(TABLE,), floor_m=1.0), 30)))
    size = pytest.approx([1.6, 0.8, 0.72])
    assert about["objects"] == [{"name": "table 1", "category": "table", "shape": "box", "size": size}]
    np.testing.assert_allclose(arrays["object/0/position"] + about["origin"], [TABLE.position], atol=1e-3)
    np.testing.assert_allclose(arrays["object/0/rotation"], [TURN], atol=1e-4)
    assert about["origin"][2] == 1.0, "the page's floor is at 0"


def test_nobody_is_told_which_things_are_decoys(walkers: Scene) -> None:
    things = tuple(replace(TABLE, role=role) for role in ("", "caused", "decoy"))
    about, _ = read(page_html(forecast_of(replace(walkers, objects=things), 30)))
    assert about["objects"][0] == about["objects"][1] == about["objects"][2]


def test_a_thing_that_moves_has_a_place_a_frame_of_the_history(walkers: Scene) -> None:
    way = np.linspace((0, 0, 0.2), (1, 0, 0.2), 60)
    ball = SceneObject("ball", "kettle", "cylinder", np.full(3, 0.2), way)
    about, arrays = read(page_html(forecast_of(replace(walkers, objects=(ball,)), 30)))
    shown = arrays["object/0/position"] + about["origin"]
    np.testing.assert_allclose(shown, way[:30], atol=1e-3)


def test_large_clouds_and_meshes_are_thinned(walkers: Scene) -> None:
    points = np.random.default_rng(0).uniform(-1, 1, (5000, 3)).astype(np.float32)
    faces = np.resize(np.arange(5000), (MOST_TRIANGLES + 1, 3))
    things = (
        SceneObject("cloud", "occluder", "points", points=points),
        SceneObject("fine", "occluder", "mesh", points=points, faces=faces),
        SceneObject("coarse", "occluder", "mesh", points=points, faces=faces[:10]),
    )
    about, arrays = read(page_html(forecast_of(replace(walkers, objects=things), 30)))
    assert [thing["shape"] for thing in about["objects"]] == ["points", "points", "mesh"]
    assert len(arrays["object/0/points"]) == len(arrays["object/1/points"]) <= MOST_POINTS
    np.testing.assert_array_equal(arrays["object/2/faces"], faces[:10])
