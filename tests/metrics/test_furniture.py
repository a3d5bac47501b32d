from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from motioncast.core.rotation import multiply
from motioncast.core.scene_object import SceneObject
from motioncast.core.skeletons import MRT15
from motioncast.metrics.furniture import (
    Legs,
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

LEGS = Legs.of(MRT15)


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


def sitting_pose(seat_m: float = 0.45) -> np.ndarray:
    """Somebody whose pelvis is 10 cm above the stool's place at that height, the hips 6 cm lower, ``(15, 3)``."""
    pose = np.tile(np.array([-1.0, 0.3, seat_m + 0.1]), (15, 1))
    for side, x in zip((0, 1), (-0.1, 0.1), strict=True):
        pose[LEGS.hips[side]] = (-1.0 + x, 0.3, seat_m + 0.04)
        pose[LEGS.knees[side]] = (-1.0 + x, 0.7, seat_m + 0.04)
        pose[LEGS.ankles[side]] = (-1.0 + x, 0.7, 0.09)
    return pose


def held(pose: np.ndarray, frames: int = 20) -> np.ndarray:
    return np.repeat(pose[None], frames, 0)


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


def test_a_person_sits_on_a_seat_or_in_the_air_or_stands() -> None:
    pose = sitting_pose()
    assert sits(held(pose), LEGS, 25).all()
    assert not stands(pose, LEGS)
    assert seated(THINGS, pose, LEGS)
    assert not seated([TABLE, WALL], pose, LEGS)  # no seat at all
    assert not seated(THINGS, pose + np.array([0.6, 0, 0]), LEGS)  # beside it
    assert not seated(THINGS, pose + 0.15 * UP, LEGS)  # too high above it
    assert not seated(THINGS, pose - 0.15 * UP, LEGS)  # within it
    standing = standing_pose()
    assert stands(standing, LEGS)
    assert not sits(held(standing), LEGS, 25).any()
    assert not sits(held(standing - 0.4 * UP), LEGS, 25).any()  # as low, but the thighs hang
    assert sits(held(pose + 5 * UP), LEGS, 25, floor_m=5.0).all()


def test_on_a_high_stool_thighs_slope_and_feet_are_ahead() -> None:
    pose = sitting_pose(0.8)
    pose[list(LEGS.knees), 2] -= 0.35  # 41 degrees
    assert sits(held(pose), LEGS, 25).all()
    pose[list(LEGS.ankles), 1] = 0.4  # under the body: bent knees, which carry it
    assert not sits(held(pose), LEGS, 25).any()


def test_who_goes_down_and_up_again_does_not_sit() -> None:
    down = np.abs(np.arange(60) % 20 - 10)[:, None, None] * 0.03 * UP
    assert not sits(sitting_pose() + down, LEGS, 25).any()
    paused = down.copy()
    paused[30:43] = down[30]  # half a second at the bottom
    assert sits(sitting_pose() + paused, LEGS, 25).nonzero()[0].tolist() == list(range(31, 43))


def test_naive_twin_of_sitting() -> None:
    random = np.random.default_rng(7)
    motion = sitting_pose() + np.cumsum(random.normal(0, 0.0025, (3, 80, 15, 3)), 1)
    found = sits(motion, LEGS, 25)
    assert 0.1 < found.mean() < 0.9
    for n in range(3):
        good = []
        for t in range(80):
            pose, step = motion[n, t], motion[n, max(t, 1)] - motion[n, max(t, 1) - 1]
            slopes = []
            for hip, knee in zip(LEGS.hips, LEGS.knees, strict=True):
                x, y, z = pose[knee] - pose[hip]
                slopes.append(np.degrees(np.arctan2(abs(z), np.hypot(x, y))))
            root = pose[LEGS.root[0]]
            chair = 0.3 <= root[2] <= 0.65 and max(slopes) <= 35
            good.append(chair and np.linalg.norm(step[LEGS.root[0]]) * 25 < 0.15)
        for t in range(80):
            runs = [range(first, first + 12) for first in range(max(0, t - 11), min(t, 68) + 1)]
            assert found[n, t] == any(all(good[k] for k in run) for run in runs)


def test_seats_do_not_count_as_obstacles_for_who_sits_but_tables_do() -> None:
    pose = sitting_pose(0.35)  # sunk into the stool: hips 6 cm below its top
    deep = joint_depth(THINGS, pose, np.array(False))
    assert deep.max() == pytest.approx(0.06, abs=1e-6)
    assert joint_depth(THINGS, pose, np.array(True)).max() == 0
    table = replace(TABLE, position=np.array([-1.0, 0.3, 0.35]))
    assert joint_depth([table], pose, np.array(True)).max() > 0.2


def test_feet_are_on_the_floor_or_on_a_step() -> None:
    pose = standing_pose()
    stepping = pose.copy()
    stepping[LEGS.ankles[0], 2] += 0.4  # the other foot is still down
    pair = np.stack([pose, stepping])
    assert grounded([], pair, LEGS).all()
    assert not grounded([], pair + 0.2 * UP, LEGS).any()  # they float
    assert not grounded([], pair - 0.2 * UP, LEGS).any()  # they wade
    step = SceneObject("step", "occluder", "box", (2, 2, 0.2), (0, 0, 0.1))
    assert grounded([step], pair + 0.2 * UP, LEGS).all()


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
