from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from motioncast.core.rotation import from_axis_angle
from motioncast.core.scene_object import SceneObject
from motioncast.core.skeletons import MRT15
from motioncast.inference.guidance import APART_M, FARTHEST_M, kept_clear
from motioncast.metrics.furniture import joint_depth
from motioncast.testing.scenes import standing_pose

FPS, SECONDS = 25.0, 6.0
TABLE = SceneObject(
    "table", "table", "box", (1.2, 0.8, 0.75), (0.0, 0.3, 0.375), from_axis_angle(np.array([0, 0, 0.4]))
)
BIN = SceneObject("bin", "trash", "cylinder", (0.5, 0.5, 0.7), (0.0, 0.1, 0.35))


def walk(start: tuple[float, float], speed: tuple[float, float]) -> np.ndarray:
    """Somebody who glides from a place at a speed for seven seconds, ``(time, joints, 3)``."""
    seconds = np.arange(round((1 + SECONDS) * FPS)) / FPS - 1
    path = np.array([*start, 0.0]) + seconds[:, None] * np.array([*speed, 0.0])
    return standing_pose() + path[:, None]


def asked(*people: np.ndarray, things: tuple[SceneObject, ...] = ()) -> tuple[np.ndarray, np.ndarray]:
    """What was forecast, and what is left of it."""
    motion = np.stack(people, 1)
    history, future = motion[: round(FPS)], motion[round(FPS) :]
    return future, kept_clear(history, future, things, MRT15, FPS)


@pytest.mark.parametrize("thing", [TABLE, BIN], ids=lambda thing: thing.name)
def test_who_would_walk_through_a_thing_walks_by_it_at_the_same_pace(thing: SceneObject) -> None:
    future, clear = asked(walk((-3.0, 0.0), (1.0, 0.0)), things=(thing,))
    assert joint_depth([thing], future).max() > 0.1
    assert joint_depth([thing], clear).max() == 0
    aside = (clear - future)[:, 0]
    assert np.abs(aside).max() < FARTHEST_M
    np.testing.assert_allclose(aside, np.broadcast_to(aside[:, :1], aside.shape), atol=1e-12)  # the pose is kept
    np.testing.assert_array_equal(aside[..., 2], 0)
    assert np.linalg.norm(np.diff(aside, axis=0), axis=-1).max() * FPS < 1.0
    assert np.linalg.norm(np.diff(aside, n=2, axis=0), axis=-1).max() * FPS < 0.2  # real feet change faster
    assert np.linalg.norm(aside[0], axis=-1).max() < 0.002  # there is no jump at the seam


def test_who_is_in_nobodys_way_is_left_alone() -> None:
    seat = replace(BIN, category="sittable", position=np.array([0.0, 5.0, 0.35]))
    future, clear = asked(walk((-3.0, 0.0), (1.0, 0.0)), walk((-3.0, 2.0), (1.0, 0.0)), things=(seat,))
    np.testing.assert_array_equal(clear, future)


def test_strangers_give_way_to_one_another_and_friends_stay_as_near_as_they_were() -> None:
    future, clear = asked(walk((-3.0, 0.1), (1.0, 0.0)), walk((3.0, 0.0), (-1.0, 0.0)))
    pelvis = clear[:, :, 0, :2]
    assert np.linalg.norm(pelvis[:, 0] - pelvis[:, 1], axis=-1).min() > 0.99 * APART_M
    np.testing.assert_allclose((clear - future).sum(1), 0, atol=1e-9)  # half of the way each
    couple = walk((0.0, 0.0), (1.0, 0.0)), walk((0.4, 0.0), (1.0, 0.0))
    np.testing.assert_allclose(*asked(*couple), atol=1e-9)


def sitting(place: tuple[float, float]) -> np.ndarray:
    """Somebody who sits on a seat of 45 cm, thighs level, facing -y."""
    pose = standing_pose()
    pose[:, 2] -= 0.4
    for side in ("left", "right"):
        hip, knee, ankle = (MRT15.index(f"{side}_{name}") for name in ("hip", "knee", "ankle"))
        pose[knee] = pose[hip] + (0, -0.42, 0)
        pose[ankle] = pose[knee] - (0, 0, 0.42)
    return np.broadcast_to(pose + np.array([*place, 0.0]), (round((1 + SECONDS) * FPS), 15, 3))


def test_a_seat_moves_nobody_off_it_and_who_sits_does_not_give_way() -> None:
    seat = SceneObject("stool", "sittable", "cylinder", (0.4, 0.4, 0.56), (0.0, 0.0, 0.28))
    future, clear = asked(sitting((0.0, 0.0)), walk((-3.0, 0.0), (1.0, 0.0)), things=(seat,))
    assert joint_depth([seat], future[:, 0]).max() > 0
    np.testing.assert_array_equal(clear[:, 0], future[:, 0])
    pelvis = clear[:, :, 0, :2]
    assert np.linalg.norm(pelvis[:, 0] - pelvis[:, 1], axis=-1).min() > 0.99 * APART_M


def test_nobody_is_moved_out_of_what_is_too_large() -> None:
    hall = SceneObject("hall", "cupboard", "box", (8.0, 8.0, 2.5), (0.0, 0.0, 1.25))
    np.testing.assert_array_equal(*asked(walk((0.0, 0.0), (0.1, 0.0)), things=(hall,)))


def test_a_turned_and_moved_world_has_the_same_way_aside() -> None:
    angle, shift = 1.1, np.array([4.0, -7.0, 0.0])
    turn = np.array([[np.cos(angle), -np.sin(angle), 0], [np.sin(angle), np.cos(angle), 0], [0, 0, 1]])
    plain = asked(walk((-3.0, 0.0), (1.0, 0.0)), things=(TABLE,))[1]
    table = replace(
        TABLE, position=turn @ TABLE.position + shift, rotation=from_axis_angle(np.array([0, 0, 0.4 + angle]))
    )
    moved = asked(walk((-3.0, 0.0), (1.0, 0.0)) @ turn.T + shift, things=(table,))[1]
    np.testing.assert_allclose(moved, plain @ turn.T + shift, atol=1e-4)
