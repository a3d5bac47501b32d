from __future__ import annotations

from importlib import resources
from pathlib import Path

import numpy as np
import pytest

from motioncast.core.limbs import middle_joint
from motioncast.core.shapes import signed_distance
from motioncast.core.skeletons import CMU31, MRT15
from motioncast.datasets.rooms import windows
from motioncast.datasets.rooms.bodies import PELVIS, bone_lengths, facing
from motioncast.datasets.rooms.check import check
from motioncast.datasets.rooms.clips import Clip, Library, load
from motioncast.datasets.rooms.compose import RECIPES, Room, room
from motioncast.datasets.rooms.contacts import FEET, floor_height, foot_contact, lasting, runs, sliding
from motioncast.datasets.rooms.events import PELVIS_ABOVE_SEAT_M, events_of
from motioncast.datasets.rooms.figure import directions
from motioncast.datasets.rooms.footprint import footprint
from motioncast.datasets.rooms.furnish import decoys, walls
from motioncast.datasets.rooms.gait import walking
from motioncast.datasets.rooms.ground import Ground
from motioncast.datasets.rooms.keys import hermite
from motioncast.datasets.rooms.people import Cast, cast
from motioncast.datasets.rooms.splits import split_of
from motioncast.formats.load import load_scene

POSE = {
    "root": (0, 0, 0.93), "lowerback": (0, 0, 1.05), "upperback": (0, 0, 1.17), "thorax": (0, 0, 1.3),
    "lowerneck": (0, 0, 1.4), "upperneck": (0.01, 0, 1.5), "head": (0.02, 0, 1.6),
    "hipjoint": (0, 0.1, 0.87), "femur": (0.02, 0.1, 0.48), "tibia": (0, 0.1, 0.08), "foot": (0.13, 0.1, 0.03),
    "toes": (0.2, 0.1, 0.02), "clavicle": (0, 0.18, 1.37), "humerus": (-0.02, 0.2, 1.1), "radius": (0.05, 0.2, 0.93),
    "wrist": (0.08, 0.2, 0.86), "hand": (0.1, 0.2, 0.81), "fingers": (0.12, 0.2, 0.77), "thumb": (0.12, 0.17, 0.82),
}  # fmt: skip
"""Somebody who stands at the origin and faces +x, the left side; metres."""


def standing(frames: int) -> np.ndarray:
    """A person who stands still, ``(frames, 31, 3)``."""
    pose = [POSE.get(name) or np.array(POSE[name[1:]]) * [1, 1 if name[0] == "l" else -1, 1] for name in CMU31.names]
    return np.broadcast_to(np.array(pose, np.float64), (frames, 31, 3)).copy()


def walk(frames: int, pace: float = 1.1, stride_s: float = 1.12) -> np.ndarray:
    """A person who walks straight on: feet stand for 0.6 of a stride each and are carried forwards in the rest."""
    body = standing(frames)
    seconds = np.arange(frames) / 25
    body[..., 0] += pace * seconds[:, None]
    for side, start in zip("lr", (0.0, 0.5), strict=True):
        hip, knee, ankle, foot, toes = (
            CMU31.index(side + name) for name in ("hipjoint", "femur", "tibia", "foot", "toes")
        )
        stride, phase = np.divmod(seconds / stride_s + start, 1)
        carried = np.clip((phase - 0.6) / 0.4, 0, 1)
        step = stride + carried**2 * (3 - 2 * carried)
        moved = pace * stride_s * (step - start + 0.3) - body[:, ankle, 0]
        for joint in (ankle, foot, toes):
            body[:, joint, 0] += moved
            body[:, joint, 2] += 0.08 * np.sin(np.pi * carried) ** 2
        body[:, knee], _ = middle_joint(body[:, hip], body[:, ankle], 0.45, 0.45, np.array([1.0, 0, 0]))
    return body


def test_a_foot_in_contact_is_low_and_at_rest() -> None:
    body = standing(50)
    body[20:30, FEET[:2], 2] += 0.2
    contact = foot_contact(body)
    assert contact[:, 1].all()
    assert not contact[20:30, 0].any()


def test_the_floor_lies_under_the_low_feet() -> None:
    body = standing(50)
    body[..., 2] += 0.3
    assert abs(floor_height(body) - 0.3) < 0.03


def test_sliding_is_the_speed_of_feet_on_the_floor() -> None:
    body = standing(20)
    assert sliding(body[:, FEET]) == 0
    body[..., 0] += 0.2 * np.arange(20)[:, None] / 25
    assert abs(sliding(body[:, FEET]) - 0.2) < 1e-6


def test_short_runs_are_left_out() -> None:
    mask = np.array([True, False, True, True, True])
    assert runs(lasting(mask, 2)) == [(2, 5)]


def test_sitting_on_a_chair_is_seen_and_standing_is_not() -> None:
    body = standing(75)
    assert not events_of(body)
    hips, knees = [CMU31.index(name) for name in ("lhipjoint", "rhipjoint")], [2, 7]
    lower = body[0, PELVIS, 2] - 0.5
    legs = {joint for name in ("femur", "tibia", "foot", "toes") for joint in _both(name)}
    for joint in range(31):
        if joint not in legs:
            body[25:60, joint, 2] -= lower
    for hip, knee in zip(hips, knees, strict=True):
        body[25:60, knee] = body[25:60, hip] + [0.4, 0, 0]
    (event,) = events_of(body)
    assert event.kind == "sit"
    assert 25 <= event.start <= 28
    assert 57 <= event.end <= 60
    assert abs(event.point[2] - (0.5 - PELVIS_ABOVE_SEAT_M)) < 1e-6
    assert not event.synthetic


def _both(name: str) -> tuple[int, int]:
    return CMU31.index("l" + name), CMU31.index("r" + name)


def test_whole_takes_lie_in_one_split() -> None:
    assert split_of(86, 1) == split_of(86, 9) == "test"
    assert split_of(16, 1) == split_of(1, 6) == "train"
    assert split_of(60, 12) == "validation"


def test_a_walk_is_walking_and_standing_is_not() -> None:
    assert walking(walk(100))[10:90].all()
    assert not walking(standing(100)).any()


def test_a_limb_bends_by_the_law_of_cosines_and_stops_at_its_length() -> None:
    knee, ankle = middle_joint(np.zeros(3), np.array([0, 0, -2.0]), 0.4, 0.4, np.array([1.0, 0, 0]))
    assert np.linalg.norm(ankle) == pytest.approx(0.8, abs=1e-3)
    assert np.linalg.norm(knee) == pytest.approx(0.4)
    assert knee[0] > 0


def test_keys_are_passed_with_their_slopes() -> None:
    times, values, slopes = np.array([0.0, 2.0]), np.array([1.0, 3.0]), np.array([1.0, -1.0])
    around = hermite(times, values, slopes, np.array([0.0, 1e-6, 2 - 1e-6, 2.0]))
    assert around[[0, 3]] == pytest.approx([1, 3])
    assert np.diff(around)[[0, 2]] / 1e-6 == pytest.approx([1, -1], abs=1e-4)


def test_walls_leave_doors_open() -> None:
    half, doors = np.array([3.0, 2.0]), np.array([[3.0, 0.5, np.pi]])
    solid = walls(half, doors)
    gap = np.array([[3.05, 0.5, 1.0], [3.05, -1.5, 1.0], [-3.05, 0.5, 1.0]])
    inside = [min(float(signed_distance(wall, point)) for wall in solid) < 0 for point in gap]
    assert inside == [False, True, True]


def test_decoys_keep_clear_of_bodies_and_there_are_three_of_each_used_kind() -> None:
    random = np.random.default_rng(0)
    ground = Ground(np.array([4.0, 4.0]), np.zeros((0, 3)), 100)
    joints = np.stack([np.linspace(-3, 3, 200), np.zeros(200), np.ones(200)], -1)
    found = decoys(["chair", "table"], 12, footprint(joints, ground.half), ground, random)
    assert len(found) >= 12
    assert sum(item.name.startswith("chair") for item in found) >= 3
    assert sum(item.category == "table" for item in found) >= 3
    assert all(item.role == "decoy" for item in found)
    assert min(float(signed_distance(item, joints * [1, 1, 0.4]).min()) for item in found) > 0.1


@pytest.fixture(scope="module")
def players() -> Cast:
    """One made-up person who walks straight on."""
    return cast(Library({2: [Clip("02_01", walk(150)[:, None].astype(np.float32))]}, []))


@pytest.fixture(scope="module")
def made(players: Cast) -> Room:
    return next(one for seed in range(20) if (one := room(players, "train", seed)).events)


def test_the_same_seed_makes_the_same_room(players: Cast) -> None:
    one, other, third = (room(players, "train", seed) for seed in (3, 3, 4))
    assert np.array_equal(one.scene.positions, other.scene.positions)
    assert one.events == other.events
    assert [item.name for item in one.scene.objects] == [item.name for item in other.scene.objects]
    assert one.scene.positions.shape != third.scene.positions.shape


def test_bones_keep_their_lengths_through_blends_and_acts(made: Room) -> None:
    for person in range(len(made.scene.people)):
        body = made.scene.positions[made.here[:, person], person].astype(np.float64)
        for joint, parent in CMU31.bones:
            length = np.linalg.norm(body[:, joint] - body[:, parent], axis=-1)
            assert np.ptp(length) < 0.004, CMU31.names[joint]
        assert bone_lengths(body)[1] > 0


def test_nobody_leaps(made: Room) -> None:
    here = made.here[1:] & made.here[:-1]
    step = np.linalg.norm(np.diff(made.scene.positions, axis=0), axis=-1).max(-1)[here]
    assert step.max() * 25 < 6  # metres a second, a carried foot of a walk is the quickest


def test_a_made_up_room_keeps_its_promises(made: Room) -> None:
    found = check(made)
    assert made.synthetic.any()
    assert found.depth_m.max() < 0.1
    assert found.nearest_m > 0.7
    assert not found.short_of_decoys
    assert all(error < 0.05 for error in found.seat_m)
    assert found.sliding_m_s["synthetic"] < 0.15
    assert sum(found.time_share.values()) == pytest.approx(1)
    things = {item.name: item for item in made.scene.objects}
    assert all(things[event.thing].role == "caused" for event in made.events if event.thing)
    assert set(made.pairs.values()) <= {"composed"}


def test_windows_hold_who_is_there_now(made: Room) -> None:
    samples = list(windows(made, 50))
    assert samples
    for sample in samples:
        assert sample.positions.shape == (275, sample.present.shape[1], 15, 3)
        assert sample.primary == tuple(np.flatnonzero(sample.present[24]))
        assert len(sample.still) == len(sample.primary)
        pelvis = made.scene.on(MRT15).positions[sample.start : sample.start + 275, :, 0]
        assert np.isin(sample.positions[..., 0, :][sample.present], pelvis).all()
        assert all(event.start < 275 and event.end > 0 for event in sample.events)


def test_the_example_room_has_people_and_furniture_with_roles() -> None:
    with resources.as_file(resources.files("motioncast") / "data" / "room.npz") as example:
        scene = load_scene(example)
    assert scene.skeleton.names == MRT15.names
    assert (scene.frames, scene.floor_m) == (500, 0.0)
    assert {item.role for item in scene.objects} == {"caused", "decoy"}
    assert "NSF EIA-0196217" in scene.source


def test_directions_are_seen_from_the_body() -> None:
    body = standing(1)
    turned_body = body.copy()
    turned_body[..., 0], turned_body[..., 1] = -body[..., 1], body[..., 0]
    one, other = (directions(pose, facing(pose)) for pose in (body, turned_body))
    assert np.allclose(one, other, atol=1e-9)


@pytest.mark.data
def test_real_rooms_of_every_split(shared: Path) -> None:
    seen: dict[str, set[str]] = {}
    for split in ("train", "validation", "test"):
        real = cast(load(shared, split))
        one = room(real, split, 1)
        found = check(one)
        assert RECIPES[split].people[0] <= len(one.scene.people) <= RECIPES[split].people[1]
        assert np.percentile(found.depth_m, 95) < 0.03
        assert found.nearest_m > 0.7
        walks = {str(name) for actor in real.actors.values() for name in actor.gait.takes}
        seen[split] = walks | {clip.name for clip in (*real.solos, *real.couples)}
    assert not seen["train"] & seen["test"]
    assert not seen["train"] & seen["validation"]
    assert not seen["validation"] & seen["test"]


@pytest.mark.data
def test_the_high_stool_is_sat_on(shared: Path) -> None:
    (clip,) = (clip for clip in load(shared, "test").singles[86] if clip.name == "86_09" and len(clip.positions) > 900)
    (event,) = (event for event in events_of(clip.positions[:, 0]) if event.kind == "sit")
    assert 12 < (event.end - event.start) / 25 < 15
    assert 0.75 < event.point[2] < 0.9
