from __future__ import annotations

from dataclasses import dataclass, replace
from importlib import resources
from pathlib import Path

import numpy as np
import pytest

from motioncast.benchmarks.protocols import BENCHMARKS
from motioncast.benchmarks.result import load_result, save_result
from motioncast.benchmarks.rooms import run
from motioncast.benchmarks.rooms.run import forecast_rooms, real_words, result_of, room_windows, score
from motioncast.benchmarks.rooms.scoring import figures_of
from motioncast.benchmarks.rooms.tally import Mean, Pooled, Ratio, Tally, rows
from motioncast.benchmarks.rooms.windows import PROTOCOL, RoomWindow, checksum, digest, manifest, windows_of_room
from motioncast.benchmarks.run import evaluate, forecast_windows
from motioncast.benchmarks.spread import over_processes
from motioncast.core.card import ModelCard
from motioncast.core.forecast import Forecast
from motioncast.core.scene import Scene
from motioncast.core.scene_object import SceneObject
from motioncast.datasets.rooms import Event, Room
from motioncast.datasets.windows import cut
from motioncast.errors import InputError
from motioncast.inference.baselines import SimpleGuess
from motioncast.testing import walkers

THINGS = (
    SceneObject("stool of person 2", "sittable", "cylinder", (0.4, 0.4, 0.45), (3.0, 1.0, 0.225), role="caused"),
    SceneObject("stool 9", "sittable", "cylinder", (0.4, 0.4, 0.45), (-3.0, 1.0, 0.225), role="decoy"),
    SceneObject("wall 1", "occluder", "box", (0.1, 30, 2.4), (12.0, 0.0, 1.2), role="decoy"),
)


def made_up_room(seed: int = 0) -> Room:
    """Four walkers for 13 s; the second leaves after 5 s, the third comes after 2 s, the fourth is never seen."""
    scene = walkers(people=4, frames=325, fps=25, seed=seed)
    observed = scene.observed.copy()
    observed[125:, 1] = False
    observed[:50, 2] = False
    observed[:, 3] = False
    scene = replace(scene, observed=observed, objects=THINGS, floor_m=0.0, source=f"room {seed}")
    events = (Event("sit", 0, 100, 150, "stool of person 2"), Event("sit", 2, 60, 90, "stool 9"))
    pairs = {(0, 1): "recorded", (0, 2): "composed", (1, 2): "composed"}
    synthetic = np.zeros(observed.shape[:2], bool)
    synthetic[90:160, 0] = seed == 1
    takes = (("01_01",), ("01_01", f"02_0{seed}"), ("09_09",), ())
    return Room(
        scene=scene, events=events, pairs=pairs, synthetic=synthetic, takes=takes, half=np.ones(2), seed=seed,
        split="test",
    )  # fmt: skip


@pytest.fixture(scope="module")
def windows() -> list[RoomWindow]:
    return [window for seed in range(3) for window in windows_of_room(made_up_room(seed))]


def futures(windows: list[RoomWindow]) -> list[np.ndarray]:
    return [window.future[None] for window in windows]


def test_only_who_is_there_at_now_is_handed_over_and_masked_when_gone(windows: list[RoomWindow]) -> None:
    window = windows[0]
    assert window.scene.people == ("person 1", "person 2")
    assert window.scene.frames == PROTOCOL.history
    assert window.future.shape == (250, 2, 15, 3)
    assert window.seen.sum(0).tolist() == [250, 100]  # frames 25 to 124
    assert window.pairs == {frozenset((0, 1))}
    assert [(goal.person, goal.frame, goal.kind) for goal in window.goals] == [(0, 100 - 24, "sit")]


def test_nothing_tells_a_model_what_will_be_used(windows: list[RoomWindow]) -> None:
    window = windows[0]
    assert {thing.role for thing in window.scene.objects} == {""}
    assert [thing.name for thing in window.scene.objects] == ["sittable 1", "sittable 2", "occluder 3"]
    assert window.scene.objects[window.goals[0].thing].position[0] == 3.0
    turned = replace(made_up_room(), scene=replace(made_up_room().scene, objects=THINGS[::-1]))
    assert digest(windows_of_room(turned)[0]) == digest(window)


def test_what_comes_after_now_reaches_no_model(windows: list[RoomWindow]) -> None:
    room = made_up_room()
    positions = room.scene.positions.copy()
    positions[25:] += np.float32(1.0)
    other = windows_of_room(replace(room, scene=replace(room.scene, positions=positions)))[0]
    guess = SimpleGuess("root-velocity-damped")
    np.testing.assert_array_equal(forecast_rooms(guess, [other])[0], forecast_rooms(guess, windows[:1])[0])
    assert checksum([other]) != checksum(windows[:1])


@dataclass(frozen=True)
class Short:
    """A model that answers with one frame, whatever is asked."""

    card: ModelCard = SimpleGuess("zero-velocity").card

    def forecast(self, scene: Scene, **asked: object) -> Forecast:
        answer = SimpleGuess("zero-velocity").forecast(scene)
        return replace(answer, samples=answer.samples[:, :1])


def test_an_answer_of_another_shape_than_the_truth_is_refused(windows: list[RoomWindow]) -> None:
    with pytest.raises(InputError, match="1 frames of 2 people; 250 of 2 were asked for"):
        forecast_rooms(Short(), windows)
    scene = walkers(people=2, frames=60)
    with pytest.raises(InputError, match="1 frames of 2 people; 45 of 2 were asked for"):
        forecast_windows(Short(), BENCHMARKS["cmu-duet"][0], cut([scene], 15, 45))


def test_the_truth_is_what_it_is_measured_against(windows: list[RoomWindow]) -> None:
    real = real_words(windows)
    found = {(figure.metric, figure.frame): figure for figure in figures_of(windows, futures(windows), real)}
    ones = np.ones((1, len(windows)))
    value = {key: figure.mean(ones)[0] for key, figure in found.items()}
    for metric in ("ade_k1", "fde_k1", "path_length_w1", "nearest_approach_w1", "apd_of_4"):
        assert value[metric, 250] == pytest.approx(0, abs=1e-9), metric
    assert value["mpjpe_at", 100] == pytest.approx(0, abs=1e-9)
    assert value["ndms", 250] > 0.9  # its own words are in the reference
    assert value["speed_in_second", 25] == pytest.approx(value["path_length", 250] / 10, rel=0.3)
    assert 0.7 < value["seam_over_real", 250] < 1.5
    assert value["sitting_frames", 250] == 0
    assert ("seat_under_sitting", 250) not in value  # nobody sits: not measurable
    assert value["goal_chance", 250] == value["goal_sit_chance", 250] == 0.5


def test_couples_that_set_out_together_lag_less_than_strangers(windows: list[RoomWindow]) -> None:
    """Both stand for 40 frames, or 120 in the next window, and walk then."""
    together = []
    for number, window in enumerate(windows):
        pose = np.repeat(window.scene.positions[-1:], 250, 0)
        pose[:, 1] = pose[:, 0] + np.float32((1.0, 0.0, 0.0))
        start = 40 + 80 * (number % 2)
        walked = np.maximum(np.arange(250) - start, 0).astype(np.float32) / 25
        near = window.scene.positions.copy()
        near[-1] = pose[0]
        kept = replace(window, scene=replace(window.scene, positions=near), seen=np.ones((250, 2), bool))
        together.append((kept, (pose + walked[:, None, None, None] * np.float32((0.0, 1.0, 0.0)))[None]))
    some, samples = zip(*together, strict=True)
    ones = np.ones((1, len(windows)))
    value = {figure.metric: figure.mean(ones)[0] for figure in figures_of(some, samples)}
    assert value["onset_lag_recorded"] == 0
    assert value["onset_lag_recorded_over_strangers"] < -1
    assert value["nearest_approach"] == pytest.approx(1.0, abs=1e-3)


def test_who_has_left_counts_no_more(windows: list[RoomWindow]) -> None:
    wild = []
    for window in windows:
        future = window.future[None].copy()
        future[0][~window.seen] = 1e3
        wild.append(future)
    ones = np.ones((1, len(windows)))
    plain, other = (figures_of(windows, samples) for samples in (futures(windows), wild))
    for one, two in zip(plain, other, strict=True):
        assert one.mean(ones)[0] == pytest.approx(two.mean(ones)[0]), one.metric


def test_a_result_ends_with_the_ratio_to_standing_still_and_can_be_written(
    windows: list[RoomWindow], tmp_path: Path
) -> None:
    guess = SimpleGuess("zero-velocity")
    result = result_of(guess.card, windows, forecast_rooms(guess, windows), None)
    assert result.ratio.metric == "ratio_to_zero_velocity"
    assert result.ratio.value == pytest.approx(1.0)
    assert result.takes == 4  # 01_01 in all, another in each; nobody of 09_09 is there
    assert result.independent == "3 rooms"
    assert load_result(save_result(result, tmp_path)).rows == result.rows
    truth = result_of(guess.card, windows, futures(windows), None)
    assert truth.ratio.value == pytest.approx(0, abs=1e-9)
    assert truth.protocol == result.protocol


def test_who_is_moved_by_inverse_kinematics_counts_only_in_figures_that_say_so(windows: list[RoomWindow]) -> None:
    assert [window.synthetic.tolist() for window in windows] == [[False, False], [True, False], [False, False]]
    assert not windows[1].recorded().seen[:, 0].any()
    assert windows[1].recorded().goals == ()
    astray = [window.future[None] + window.synthetic[:, None, None] * np.float32(5.0) for window in windows]
    found = {(row.metric, row.horizon_s): row for row in score(windows, astray)}
    assert found["mpjpe_at", 1.0].value == 0
    assert found["mpjpe_at_with_synthetic", 1.0].value == pytest.approx(5000 * np.sqrt(3) / 6, rel=1e-4)
    assert found["ratio_to_zero_velocity", 10.0].value == 0
    assert (found["goal_chance", 10.0].n, found["goal_chance_with_synthetic", 10.0].n) == (2, 3)


def test_each_person_alone_is_asked_alone(windows: list[RoomWindow]) -> None:
    guess = SimpleGuess("neck-velocity")
    for together, alone in zip(forecast_rooms(guess, windows), forecast_rooms(guess, windows, alone=True), strict=True):
        np.testing.assert_allclose(together, alone, atol=1e-6)


def test_the_manifest_lists_every_window(windows: list[RoomWindow]) -> None:
    lines = manifest(windows).splitlines()
    assert len(lines) == 1 + len(windows)
    assert lines[1].startswith("0,room 0,0,274,25,2,3,1,")


@pytest.mark.data
def test_the_first_rooms_are_those_of_the_manifest(shared: Path) -> None:
    path = resources.files("motioncast.benchmarks") / "manifests" / "rooms.csv"
    found = manifest(room_windows(shared, "test", 2)).splitlines()
    assert len(found) > 3
    assert path.read_text(encoding="utf-8").splitlines()[: len(found)] == found


def test_evaluated_by_name(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setattr(run, "rooms", lambda data, split, count, seed: map(made_up_room, range(2)))
    result = evaluate("replay", "rooms", tmp_path)
    assert (result.model, result.benchmark, result.windows) == ("replay", "rooms", 2)
    assert {row.metric for row in result.rows} >= {"ndms", "path_length_w1", "seam_over_real", "goal_accuracy"}
    with pytest.raises(InputError, match="skeleton"):
        evaluate("somoformer-somof", "rooms", tmp_path)


def test_rooms_are_not_shared_among_processes() -> None:
    with pytest.raises(InputError, match="one room after the other"):
        evaluate("zero-velocity", "rooms", "nowhere", spread=over_processes(2))


def test_naive_twin_of_the_intervals() -> None:
    tally = Tally(windows=4, horizon=250)
    values, names = [[1.0, 2.0], [4.0], [np.nan], [8.0, 6.0, 1.0]], ["a", "a", "b", "c"]
    for number, some in enumerate(values):
        tally.add(number, "error", np.array(some), "m")
        tally.add(number, "one", np.ones(len(some)), "m")
    error, one = tally.figures()["error"][0], tally.figures()["one"][0]
    pooled = Pooled("largest", 250, "m", [np.array(some) for some in values[:2]] * 2, lambda items: items.max())
    found = rows([error, Ratio("ratio", error, one), Mean("mean", [error, one]), pooled], names, fps=25)
    assert [row.value for row in found] == pytest.approx([22 / 6, 22 / 6, (22 / 6 + 1) / 2, 4.0])
    assert rows([Pooled("nothing", 250, "m", [np.zeros(0)] * 4, np.mean)], names, fps=25) == []
    assert found[0].n == 3
    assert found[0].horizon_s == 10.0
    # all draws of three rooms, each by its probability, are near what a thousand draws give
    means = []
    for draw in np.ndindex(3, 3, 3):
        drawn = [
            v for room in draw for name, some in zip(names, values, strict=True) if name == "abc"[room] for v in some
        ]
        means.append(np.nanmean(drawn) if not np.isnan(drawn).all() else np.nan)
    low, high = np.nanpercentile(means, (2.5, 97.5))
    assert found[0].low == pytest.approx(low, abs=0.2)
    assert found[0].high == pytest.approx(high, abs=0.2)
