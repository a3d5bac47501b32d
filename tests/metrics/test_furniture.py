from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from motioncast.core.rotation import multiply
from motioncast.core.scene_object import SceneObject
from motioncast.core.skeletons import MRT15
from motioncast.metrics.furniture import (
    above_top,
    crosses,
    grounded,
    joint_depth,
    nearest_of_kind,
    seated,
    sits,
    stands,
)
from motioncast.testing.scenes import standing_pose

HIPS = (MRT15.index("left_hip"), MRT15.index("right_hip"))
KNEES = (MRT15.index("left_knee"), MRT15.index("right_knee"))
ANKLES = (MRT15.index("left_ankle"), MRT15.index("right_ankle"))


def turned(angle: float) -> np.ndarray:
    return np.array([np.cos(angle / 2), 0, 0, np.sin(angle / 2)])


TABLE = SceneObject("table 1", "table", "box", (1.6, 0.8, 0.7), (0.5, 0.2, 0.35), turned(0.4))
STOOL = SceneObject("stool 1", "sittable", "cylinder", (0.5, 0.5, 0.45), (-1.0, 0.3, 0.225))
CHAIR = SceneObject("chair 1", "sittable", "box", (0.6, 0.5, 0.45), (0.0, -1.0, 0.225), turned(1.0))
WALL = SceneObject("wall 1", "occluder", "box", (0.1, 4.0, 2.5), (1.5, 0.0, 1.25), turned(-0.3))
CLOUD = SceneObject("cup", "kettle", "points", points=np.ones((1, 3)))
UP = np.array([0.0, 0.0, 1.0])
THINGS = [TABLE, STOOL, CHAIR, WALL, CLOUD]


@pytest.fixture
def motion() -> np.ndarray:
    """Joints all over the room, ``(people 3, time 8, joints 5, 3)``."""
    return np.random.default_rng(4).uniform((-2, -2, -0.1), (2, 2, 1.2), (3, 8, 5, 3))


def sitting_pose(seat_m: float) -> np.ndarray:
    """Somebody whose hips are over the stool, 10 cm above a seat of that height, ``(15, 3)``."""
    pose = np.zeros((15, 3))
    for side, x in zip((0, 1), (-0.1, 0.1), strict=True):
        pose[HIPS[side]] = (-1.0 + x, 0.3, seat_m + 0.1)
        pose[KNEES[side]] = (-1.0 + x, 0.7, seat_m + 0.05)
        pose[ANKLES[side]] = (-1.0 + x, 0.7, 0.09)
    return pose


def inside(thing: SceneObject, point: np.ndarray) -> float:
    """How far a point is from the nearest face, from inside; 0 outside."""
    local = np.abs(thing.inward(point))
    if thing.shape == "box":
        return max(0.0, float((thing.size / 2 - local).min()))
    return max(0.0, min(thing.size[0] / 2 - np.hypot(local[0], local[1]), thing.size[2] / 2 - local[2]))


def test_naive_twin_of_joint_depth(motion: np.ndarray) -> None:
    sitting = np.random.default_rng(1).random((3, 8)) < 0.5
    found = joint_depth(THINGS, motion, sitting)
    assert (found > 0).mean() > 0.05
    for index in np.ndindex(3, 8, 5):
        counts = [thing for thing in THINGS[:4] if not (thing.category == "sittable" and sitting[index[:2]])]
        assert found[index] == pytest.approx(max(inside(thing, motion[index]) for thing in counts), abs=1e-6)


def test_naive_twin_of_tops(motion: np.ndarray) -> None:
    found = above_top(THINGS, motion, floor_m=0.05)
    for index in np.ndindex(3, 8, 5):
        point, tops = motion[index], [0.05]
        for thing in THINGS[:4]:
            top, (x, y, _) = thing.position[2] + thing.size[2] / 2, thing.inward(point)
            over = (
                abs(x) <= thing.size[0] / 2 and abs(y) <= thing.size[1] / 2
                if thing.shape == "box"
                else np.hypot(x, y) <= thing.size[0] / 2
            )
            if over and point[2] >= top - 0.03:
                tops.append(top)
        assert found[index] == pytest.approx(point[2] - max(tops), abs=1e-6)


def test_naive_twin_of_walls() -> None:
    path = np.random.default_rng(5).uniform(-3, 3, (4, 9, 2))
    found = crosses(THINGS, path)
    assert 0.1 < found.mean() < 0.9
    for w, t in np.ndindex(4, 8):
        line = path[w, t] + np.linspace(0, 1, 4001)[:, None] * (path[w, t + 1] - path[w, t])
        on_it = WALL.inward(np.c_[line, np.full(len(line), 1.25)])[:, :2]
        assert found[w, t] == (np.abs(on_it) <= WALL.size[:2] / 2).all(1).any()


def test_who_stands_by_a_wall_or_walks_along_it_does_not_cross_it() -> None:
    wall = replace(WALL, rotation=turned(0.0))
    assert not crosses([wall], np.array([[1.4, 0.0], [1.4, 0.0], [1.4, 1.0]])).any()
    assert crosses([wall], np.array([[1.4, 0.0], [1.4, 3.0], [1.6, 3.0], [1.6, 0.0]])).sum() == 0  # around its end
    assert crosses([wall], np.array([[1.5, 0.0], [1.5, 0.0]])).all()  # within it
    step = replace(wall, size=np.array([0.1, 4.0, 0.2]))
    assert not crosses([step], np.array([[1.4, 0.0], [1.6, 0.0]])).any()


def test_a_person_who_sits_on_a_seat_sits_in_the_air_or_stands() -> None:
    pose = sitting_pose(0.45)
    assert sits(pose, HIPS, KNEES)
    assert not stands(pose, HIPS)
    assert seated(THINGS, pose, HIPS)
    assert not seated([TABLE, WALL], pose, HIPS)  # no seat at all
    assert not seated(THINGS, pose + np.array([0.6, 0, 0]), HIPS)  # beside it
    assert not seated(THINGS, pose + 0.15 * UP, HIPS)  # too high above it
    assert not seated(THINGS, pose - 0.15 * UP, HIPS)  # within it
    standing = standing_pose()
    assert stands(standing, HIPS)
    assert not sits(standing, HIPS, KNEES)
    assert not sits(standing - 0.4 * UP, HIPS, KNEES)  # as low, but the thighs hang
    assert sits(pose + 5 * UP, HIPS, KNEES, floor_m=5.0)


def test_seats_do_not_count_as_obstacles_for_who_sits_but_tables_do() -> None:
    pose = sitting_pose(0.38)  # sunk 7 cm into the stool, hips 3 cm above its top
    pose[0] = (-1.0, 0.3, 0.40)
    deep = joint_depth(THINGS, pose, np.array(False))
    assert deep.max() == pytest.approx(0.05, abs=1e-6)
    assert joint_depth(THINGS, pose, np.array(True)).max() == 0
    table = replace(TABLE, position=np.array([-1.0, 0.3, 0.35]))
    assert joint_depth([table], pose, np.array(True)).max() > 0.2


def test_feet_are_on_the_floor_or_on_a_step() -> None:
    pose = standing_pose()
    stepping = pose.copy()
    stepping[ANKLES[0], 2] += 0.4  # the other foot is still down
    pair = np.stack([pose, stepping])
    assert grounded([], pair, ANKLES).all()
    assert not grounded([], pair + 0.2 * UP, ANKLES).any()  # they float
    assert not grounded([], pair - 0.2 * UP, ANKLES).any()  # they wade
    step = SceneObject("step", "occluder", "box", (2, 2, 0.2), (0, 0, 0.1))
    assert grounded([step], pair + 0.2 * UP, ANKLES).all()


def test_goals_among_decoys() -> None:
    sinks = [SceneObject(f"sink {x}", "sink", "box", (0.5, 0.5, 0.9), (x, 0, 0.45)) for x in (0, 2, 4)]
    places = np.array([[0.4, 0, 0.9], [1.2, 0, 0.9], [2.5, 1, 0.9], [9.0, 0, 0.9]])
    for used, sink in enumerate(sinks):
        nearest = [int(np.argmin(np.abs(np.array([0, 2, 4]) - x))) for x in places[:, 0]]
        assert nearest_of_kind([*sinks, TABLE], sink, places).tolist() == [n == used for n in nearest]


def test_turning_and_moving_the_world_changes_nothing(motion: np.ndarray) -> None:
    angle, shift = 0.7, np.array([3.0, -2.0, 0.0])
    cosine, sine = np.cos(angle), np.sin(angle)
    matrix = np.array([[cosine, -sine, 0], [sine, cosine, 0], [0, 0, 1]])
    moved = [
        replace(thing, position=matrix @ thing.position + shift, rotation=multiply(turned(angle), thing.rotation))
        for thing in THINGS[:4]
    ]
    there = motion @ matrix.T + shift
    np.testing.assert_allclose(joint_depth(moved, there), joint_depth(THINGS, motion), atol=1e-5)
    np.testing.assert_allclose(above_top(moved, there, 0.0), above_top(THINGS, motion, 0.0), atol=1e-5)
    np.testing.assert_array_equal(
        crosses(moved, there[..., 0, :2]),
        crosses(THINGS, motion[..., 0, :2]),
    )
    np.testing.assert_array_equal(joint_depth(THINGS[::-1], motion), joint_depth(THINGS, motion))
    np.testing.assert_array_equal(joint_depth(THINGS, motion[1, 2]), joint_depth(THINGS, motion)[1, 2])
