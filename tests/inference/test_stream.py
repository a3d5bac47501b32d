from __future__ import annotations

import numpy as np
import pytest

from motioncast.core.skeletons import MRT15
from motioncast.errors import SceneError
from motioncast.inference.registry import DEFAULT_MODEL, load
from motioncast.inference.session import GraphForecaster
from motioncast.inference.stream import Stream
from motioncast.testing import walkers

SCENE = walkers(people=2, frames=90, fps=30)


def frame(index: int, *people: int) -> dict[str, np.ndarray]:
    return {SCENE.people[person]: SCENE.positions[index, person] for person in people or (0, 1)}


@pytest.fixture
def stream() -> Stream:
    model = load(DEFAULT_MODEL)
    assert isinstance(model, GraphForecaster)
    return model.stream(fps=30)


def test_the_numbers_of_a_stream_are_those_of_a_batch(stream: Stream) -> None:
    answer = None
    for index in range(90):
        answer = stream.push(frame(index), index / 30)
    assert answer is not None
    np.testing.assert_array_equal(answer.samples, load(DEFAULT_MODEL).forecast(SCENE).samples)
    assert not answer.guessed.any()


def test_the_first_moments_are_a_flagged_guess(stream: Stream) -> None:
    answer = stream.push(frame(0))
    assert answer is not None
    assert answer.guessed.all()
    np.testing.assert_allclose(answer.samples[0, -1], SCENE.positions[0], atol=1e-5)


def test_a_late_frame_fills_its_place(stream: Stream) -> None:
    other = load(DEFAULT_MODEL).stream(fps=30)  # pyright: ignore[reportAttributeAccessIssue]
    for index in (*range(30), *range(31, 40)):
        stream.push(frame(index), index / 30)
    stream.push(frame(30), 30 / 30)
    for index in range(40):
        other.push(frame(index), index / 30)
    np.testing.assert_array_equal(stream.observed, other.observed)
    np.testing.assert_array_equal(stream.positions, other.positions)


def test_a_lost_frame_is_a_gap_and_an_ancient_one_is_ignored(stream: Stream) -> None:
    for index in (*range(60), *range(63, 80)):
        answer = stream.push(frame(index), index / 30)
    assert answer is not None
    before = stream.positions.copy()
    answer = stream.push(frame(0), -100.0)
    assert answer is not None
    assert "too late" in answer.warnings[-1]
    np.testing.assert_array_equal(stream.positions, before)


def test_people_come_and_go(stream: Stream) -> None:
    for index in range(40):
        stream.push(frame(index, 0))
    answer = stream.push(frame(40))
    assert answer is not None
    assert answer.guessed.tolist() == [False, True]
    for index in range(41, 90):
        answer = stream.push(frame(index, 1))
    for _ in range(stream.memory):
        answer = stream.push(frame(89, 1))
    assert stream.people == [SCENE.people[1]]
    assert answer is not None
    assert answer.people == (SCENE.people[1],)
    assert stream.push({}) is None


def test_what_is_not_seen_may_be_nan_and_odd_poses_are_refused(stream: Stream) -> None:
    poses = frame(0)
    poses[SCENE.people[0]] = poses[SCENE.people[0]].copy()
    poses[SCENE.people[0]][MRT15.index("left_wrist")] = np.nan
    answer = stream.push(poses)
    assert answer is not None
    assert np.isfinite(answer.samples).all()
    with pytest.raises(SceneError, match="15 joints"):
        stream.push({"ada": np.zeros((14, 3))})
    with pytest.raises(SceneError, match="time stamp"):
        stream.push(frame(0), float("nan"))


def test_stamps_may_begin_later_and_a_clock_may_be_set_back(stream: Stream) -> None:
    for index in range(40):
        stream.push(frame(index))
    stream.push(frame(40), 1000.0)
    assert stream.now == pytest.approx(40)
    stream.push(frame(41), 3.0)
    answer = stream.push(frame(42), 3.0 + 1 / 30)
    assert answer is not None
    assert "starts afresh" in answer.warnings[-1]
    for index in range(43, 89):
        answer = stream.push(frame(index), 3.0 + (index - 41) / 30)
    assert answer is not None
    assert not answer.warnings


def test_a_wrong_pose_leaves_the_stream_as_it_was(stream: Stream) -> None:
    stream.push(frame(0))
    with pytest.raises(SceneError):
        stream.push({**frame(1), "odd": np.zeros((3, 3))})
    assert stream.now == 0


def test_a_clock_that_jitters_leaves_no_gap_and_moves_nobody() -> None:
    """Walkers seen at jittered moments, nearly half a frame off, are read where they were on the grid."""
    scene = walkers(people=2, frames=8 * 60, fps=240)
    stream = load("zero-velocity").stream(fps=30)
    jitter = np.random.default_rng(0).integers(-3, 4, 60)
    answer = None
    for at in (8 * np.arange(60) + 4 + jitter).tolist():
        answer = stream.push(dict(zip(scene.people, scene.positions[at], strict=True)), at / 240)
        now = at
    assert answer is not None
    history = answer.history
    assert history.observed.all()
    true = scene.positions[now - 8 * (history.frames - 1) : now + 1 : 8]
    assert np.linalg.norm(history.positions - true, axis=-1).max() < 0.006


def test_two_cameras_may_each_see_a_person_at_their_own_times() -> None:
    stream = load("zero-velocity").stream(fps=30)
    answer = None
    for index in range(40):
        stream.push(frame(index, 0), index / 30)
        answer = stream.push(frame(index, 1), (index + 0.3) / 30)
    assert answer is not None
    assert answer.people == SCENE.people
    assert answer.history.observed[1:].all()
    np.testing.assert_array_equal(answer.history.positions[:, 1], SCENE.positions[40 - answer.history.frames : 40, 1])
    # the first person is read between frames, at 0.3 of a frame after each
    expected = 0.7 * SCENE.positions[20:30, 0] + 0.3 * SCENE.positions[21:31, 0]
    np.testing.assert_allclose(answer.history.positions[-20:-10, 0], expected, atol=1e-5)
