"""A scene put into a room: floor, furniture, and who stands inside it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from motioncast.core.card import ModelCard
from motioncast.core.forecast import Forecast
from motioncast.core.room import Room, floor_under, furnish
from motioncast.core.scene import Scene
from motioncast.core.scene_object import SceneObject

AWAY = SceneObject("desk", "table", "box", np.array([1.6, 0.8, 0.7]), np.array([5.0, 5.0, 0.35]))


def at_bea(walkers: Scene, category: str = "table") -> SceneObject:
    x, y = walkers.positions[-1, 1, 0, :2]
    return SceneObject("bar", category, "box", np.array([1, 1, 1.0]), np.array([x, y, 0.5]))


def test_furniture_stands_beside_what_was_there(walkers: Scene) -> None:
    scene = furnish(replace(walkers, objects=(AWAY,)), Room((replace(AWAY, name="second"),), 0.0, ("said",)))
    assert [thing.name for thing in scene.objects] == ["desk", "second"]
    assert (scene.floor_m, scene.remarks) == (0.0, ("said",))


def test_a_floor_that_nobody_states_is_inferred_and_said(walkers: Scene) -> None:
    scene = furnish(walkers, Room((AWAY,)))
    assert scene.floor_m == pytest.approx(walkers.positions[..., 2].min() - 0.08, abs=0.01), "ankles stand above it"
    (remark,) = scene.remarks
    assert "lowest feet" in remark
    assert furnish(replace(walkers, floor_m=0.3), Room((AWAY,))).floor_m == 0.3


def test_the_floor_is_not_read_from_the_future(walkers: Scene) -> None:
    later = walkers.positions.copy()
    later[40:] -= 1
    fallen = replace(walkers, positions=later)
    assert furnish(fallen, Room(()), history=40).floor_m == pytest.approx(floor_under(walkers[:40]))
    assert furnish(fallen, Room(())).floor_m < -0.5  # pyright: ignore[reportOptionalOperand]


def test_nobody_seen_is_no_floor(walkers: Scene) -> None:
    assert floor_under(replace(walkers, observed=np.zeros_like(walkers.observed))) == 0


def test_who_stands_inside_a_thing_is_named(walkers: Scene) -> None:
    (remark,) = furnish(walkers, Room((AWAY, at_bea(walkers)), 0.0)).remarks
    assert remark.startswith("bea stands ")
    assert '"bar"' in remark
    assert furnish(walkers, Room((at_bea(walkers, "sittable"),), 0.0)).remarks == (), "people sit in seats"
    gone = walkers.observed.copy()
    gone[-1, 1] = False
    assert furnish(replace(walkers, observed=gone), Room((at_bea(walkers),), 0.0)).remarks == ()


def test_things_stay_through_a_forecast(walkers: Scene) -> None:
    way = np.linspace((0, 0, 1), (1, 0, 1), 30)
    kettle = SceneObject("kettle", "kettle", "cylinder", np.full(3, 0.2), way)
    history = replace(walkers[:30], objects=(AWAY, kettle), floor_m=0.1)
    card = ModelCard("m", "s", "forecast", "mrt15", 15, 45, 15.0)
    answer = Forecast(walkers.positions[None, 30:], history, walkers.people, card)
    assert answer.scene().floor_m == answer.continued().floor_m == 0.1
    desk, moved = answer.continued().objects
    assert not desk.moves
    np.testing.assert_allclose(moved.position[:30], way, atol=1e-6)
    assert (moved.position[30:] == moved.position[29]).all()
    assert [thing.moves for thing in answer.scene().objects] == [False, False]
