from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest

from motioncast.core.scene import Scene
from motioncast.core.skeletons import CMU31, H36M17
from motioncast.datasets import cmu
from motioncast.datasets.cmu_goals import samples_of, table, windows_of
from motioncast.formats.moments_tsv import Moment, read_moments


def counting(people: tuple[str, ...] = ("13_29",), hidden: slice = slice(0, 0)) -> Scene:
    """Each frame and person at a place that tells which it is."""
    positions = np.zeros((90, len(people), 17, 3), np.float32)
    positions += np.arange(90).reshape(90, 1, 1, 1) + 1000 * np.arange(len(people)).reshape(1, -1, 1, 1)
    seen = np.ones(positions.shape[:3], bool)
    seen[hidden, 0] = False
    return Scene(positions, H36M17, 30, seen, people)


def at(*seconds: float, person: str = "13_29") -> dict[str, list[Moment]]:
    return {person: [Moment(person, person, second, 1.0) for second in seconds]}


def frames(way: np.ndarray) -> list[int]:
    return [int(way[0, 0, 0]), int(way[-1, 0, 0])]


def test_a_sample_reaches_from_the_moment_before_to_the_frame_before_the_pose() -> None:
    samples = list(samples_of(counting(), at(1.0, 2.5)))
    assert [frames(sample.history) for sample in samples] == [[0, 29], [30, 74]]
    assert [sample.target[0, 0] for sample in samples] == [30, 75]
    assert samples[0].partner is None


def test_no_sample_reaches_over_a_gap_or_is_shorter_than_14_frames() -> None:
    assert [frames(sample.history) for sample in samples_of(counting(hidden=slice(40, 45)), at(1.0, 2.5))] == [
        [0, 29], [45, 74],
    ]  # fmt: skip
    assert list(samples_of(counting(hidden=slice(70, 72)), at(2.5))) == []
    assert len(list(samples_of(counting(), at(13 / 30)))) == 0
    assert len(list(samples_of(counting(), at(14 / 30)))) == 1


def test_the_partner_moves_on_the_same_clock() -> None:
    (sample,) = samples_of(counting(("60_01", "61_01")), at(1.0, person="61_01"))
    assert sample.partner is not None
    np.testing.assert_array_equal(sample.history - sample.partner, np.full((30, 17, 3), 1000.0))


def test_windows_begin_at_the_first_frame_and_end_before_the_pose() -> None:
    (sample,) = samples_of(counting(), at(2.0))
    windows = windows_of(sample.history)
    assert windows.shape == (5, 10, 17, 3)
    assert frames(windows[0]) == [0, 9]
    assert frames(windows[-1]) == [50, 59]


def test_the_table_of_the_package_holds_every_split_and_keeps_moments_apart() -> None:
    moments = read_moments(table())
    splits = [cmu.split_of(*map(int, moment.take.split("_"))) for moment in moments]
    assert {split: splits.count(split) > 100 for split in splits} == dict.fromkeys(splits, True)
    assert set(splits) == {"train", "validation", "test"}
    kept = [moment for moment in moments if moment.source != "rejected"]
    for one, other in pairwise(kept):
        assert one.person != other.person or other.second - one.second > 0.4


def test_a_rejected_moment_is_no_pose_and_what_the_eye_saw_is() -> None:
    moments = read_moments(table())
    counts = {source: sum(moment.source == source for moment in moments) for source in ("rejected", "manual")}
    assert counts == {"rejected": 14, "manual": 11}
    assert all(moment.note for moment in moments if moment.source in counts)


@pytest.mark.parametrize(("joint", "place"), [("Nose", "upperneck"), ("Head", "head"), ("RWrist", "rwrist")])
def test_cmu_bodies_have_all_17_joints(joint: str, place: str) -> None:
    assert H36M17.map_from(CMU31)[H36M17.index(joint)] == (CMU31.index(place),)
