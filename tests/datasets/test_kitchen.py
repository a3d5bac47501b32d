"""The kitchen grammar: what is known of it holds."""

from __future__ import annotations

from collections import Counter

import numpy as np
import pytest

from motioncast.core.skeletons import UPPER9
from motioncast.datasets import kitchen
from motioncast.datasets.action_windows import cut_steps, window_of
from motioncast.datasets.kitchen.dishes import DISHES, ITEMS, LABELS, PLACES, draw_objects, draw_pair, draw_steps
from motioncast.datasets.kitchen.sequences import scenery
from motioncast.errors import InputError, SceneError
from motioncast.metrics.actions import asymmetry


def test_the_same_seed_gives_the_same_numbers_and_splits_differ():
    one, again, other = (kitchen.sequence(split, 3) for split in ("train", "train", "test"))
    np.testing.assert_array_equal(one.pixels, again.pixels)
    assert one.actions.shape != other.actions.shape or (one.actions != other.actions).any()
    with pytest.raises(InputError, match="no split"):
        kitchen.sequence("all", 0)


def test_only_what_is_there_is_taken():
    random = np.random.default_rng(0)
    for _ in range(50):
        objects = draw_objects(random)
        homes = {item.home for item, there in zip(ITEMS, objects, strict=True) if there}
        steps = draw_steps(objects, random)
        assert {step.place for step in steps if step.label == "take"} <= homes
        assert {step.label for step in steps} <= set(LABELS)
        assert {step.place for step in steps} <= set(PLACES)


def work(name):
    """The labels and the places of what is done with an item."""
    item = next(item for item in ITEMS if item.name == name)
    return tuple(step.label for step in item.work), item.home, item.work[-1].place


def test_neither_labels_nor_places_alone_tell_an_item():
    ways = Counter(work(item.name)[0] for item in ITEMS)
    homes = Counter(item.home for item in ITEMS)
    assert set(ways.values()) == {4}
    assert set(homes.values()) == {2}
    assert len({work(item.name) for item in ITEMS}) == len(ITEMS)


def test_dishes_have_twins_that_labels_tell_apart_after_three_items():
    for dish, twin in zip(DISHES[::2], DISHES[1::2], strict=True):
        one, other = ([work(name)[0] for name in names] for names in (dish, twin))
        assert one[:3] == other[:3]
        assert one[3:] != other[3:]
        assert [work(name)[1:] for name in dish[:3]] != [work(name)[1:] for name in twin[:3]]


def test_places_tell_labels_ahead_and_labels_tell_places_ahead():
    """What is known four steps ahead from three steps, in bits of the label and of the place left open."""
    random, rows = np.random.default_rng(1), []
    for _ in range(400):
        steps = draw_steps(np.ones(12, bool), random)
        for at in range(3, len(steps) - 4):
            past = steps[at - 3 : at]
            labels, places = tuple(step.label for step in past), tuple(step.place for step in past)
            rows.append((labels, places, steps[at + 3].label, steps[at + 3].place))

    def left_open(what, known):
        pairs = [(tuple(row[part] for part in known), row[what]) for row in rows]
        joint, alone = Counter(pairs), Counter(past for past, _ in pairs)
        return -sum(count * np.log2(count / alone[past]) for (past, _), count in joint.items()) / len(pairs)

    assert left_open(2, (0, 1)) < left_open(2, (0,)) - 0.3
    assert left_open(3, (0, 1)) < left_open(3, (1,)) - 0.1


def test_two_cooks_meet_to_hand_over():
    first, second = draw_pair(np.ones(12, bool), np.random.default_rng(0))
    assert len(first) == len(second)
    assert all((a.label == "hand over") == (b.label == "receive") for a, b in zip(first, second, strict=True))
    pair = kitchen.sequence("train", 0, people=2)
    assert pair.pixels.shape == (len(pair), 2, 9, 2)


def test_bodies_are_symmetric_keep_their_bones_and_move_without_a_jump():
    _, _, (motion,), _ = scenery("train", 0, 0, 1)
    poses = motion.at(np.arange(0, motion.ends_s[-1], 0.02))
    assert asymmetry(poses).max() < 1e-9
    bones = np.stack([np.linalg.norm(poses[:, a] - poses[:, b], axis=-1) for a, b in UPPER9.bones])
    assert np.ptp(bones, axis=1).max() < 1e-6
    assert np.linalg.norm(np.diff(poses, axis=0), axis=-1).max() < 0.02 * 6


def test_the_characteristic_pose_reaches_farthest():
    _, _, (motion,), _ = scenery("train", 1, 0, 1)
    peak, border = (
        np.linalg.norm(motion.at(times)[:, 4, :2], axis=-1).mean() for times in (motion.peak_s, motion.ends_s)
    )
    assert peak > border + 0.1


def test_the_camera_sees_what_is_there_within_its_noise():
    one = kitchen.sequence("train", 2)
    errors = one.pixels - one.camera.project(one.positions)
    assert 1.5 < errors.std() < 5.5


def test_other_moments_are_other_poses_of_the_same_actions():
    usual = kitchen.sequence("train", 4)
    for moments in ("middle", "random"):
        other = kitchen.sequence("train", 4, moments=moments)
        np.testing.assert_array_equal(other.actions, usual.actions)
        assert np.abs(other.positions - usual.positions).max() > 0.1
    piece = next(kitchen.uncoupled("train", 5, 10, 10))
    assert len(piece) == 20


def test_the_bank_is_centred_faces_the_camera_and_is_as_often_mirrored():
    poses = kitchen.bank(600)
    np.testing.assert_array_equal(poses[:, 1], 0)
    assert asymmetry(poses).max() < 1e-5
    assert (poses[:, 5, 0] > poses[:, 2, 0]).mean() > 0.95
    busier = np.linalg.norm(poses[:, 4], axis=-1) > np.linalg.norm(poses[:, 7], axis=-1)
    assert busier.mean() == pytest.approx(0.5, abs=0.1)


def test_windows_do_not_look_ahead():
    sequences = list(kitchen.sequences("train", 2))
    windows = cut_steps(sequences, 10, 10)
    assert len(windows) == sum(len(one) - 19 for one in sequences)
    sequences[0].pixels[15:] += 100
    again = cut_steps(sequences, 10, 10)
    np.testing.assert_array_equal(again.depth[0], windows.depth[0])
    for before, after in zip(windows.past(10, [0]), again.past(10, [0]), strict=True):
        np.testing.assert_array_equal(before, after)
    with pytest.raises(SceneError, match="no sequence has"):
        cut_steps(sequences, 50, 50)


def test_a_short_past_is_told_to_be_short():
    one = kitchen.sequence("train", 0)
    window = window_of(one, 60)
    assert (window.actions[0, : 60 - len(one)] == -1).all()
    assert not window.seen[0, : 60 - len(one)].any()
    np.testing.assert_array_equal(window.actions[0, 60 - len(one) :], one.actions)
