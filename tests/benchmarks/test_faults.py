"""Faults of released evaluations, a test each that ours does not have it; the numbers are those of ``docs/faults.md``.

Those that concern training are in ``tests/training/test_faults_of_training.py``.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from motioncast.benchmarks import leaderboard, open_cmu, spread
from motioncast.benchmarks.conditions import CONDITIONS, worsened
from motioncast.benchmarks.protocol import Protocol
from motioncast.benchmarks.protocols import BENCHMARKS
from motioncast.benchmarks.result import Result, Row, comparable
from motioncast.benchmarks.run import forecast_windows
from motioncast.benchmarks.scoring import figures_of, independent, score
from motioncast.core.forecast import Forecast
from motioncast.core.scene import Scene
from motioncast.core.skeletons import MRT15, SKELETONS, SMPL24, SOMOF13
from motioncast.datasets import cmu
from motioncast.datasets.catalogue import metric
from motioncast.datasets.mixer import arrange, turned
from motioncast.datasets.windows import Windows, cut
from motioncast.errors import InputError, MotioncastError
from motioncast.inference.registry import list_models, load
from motioncast.inference.session import GraphForecaster
from motioncast.metrics.samples import best_of
from motioncast.testing import walkers

DUET = BENCHMARKS["cmu-duet"][0]
SOMOF = BENCHMARKS["somof"][0]


def takes(count: int = 12, people: int = 2) -> Windows:
    """Windows of takes of made-up walkers, two of each take."""
    scenes = [replace(walkers(people, 70, seed=seed), source=f"take {seed}") for seed in range(count)]
    return cut(scenes, 15, 45, stride=10)


def with_positions(windows: Windows, positions: np.ndarray) -> Windows:
    return replace(windows, positions=positions.astype(np.float32))


def figures(protocol: Protocol, windows: Windows, forecasts: np.ndarray) -> dict[tuple[str, float], float]:
    return {(row.metric, row.horizon_s): row.value for row in score(protocol, windows, forecasts)}


def guessed(windows: Windows) -> np.ndarray:
    return forecast_windows("root-velocity-damped", DUET, windows)


def test_fault_01_the_future_is_used_as_input() -> None:
    windows = takes(2)
    changed = windows.positions.copy()
    changed[:, 15:] += 3.0
    other = with_positions(windows, changed)
    for condition in CONDITIONS:
        seen, also = worsened(windows, condition, 0), worsened(other, condition, 0)
        for one, two in zip(seen.past, also.past, strict=True):
            np.testing.assert_array_equal(one, two)
    np.testing.assert_array_equal(
        forecast_windows("somoformer-fast", DUET, windows), forecast_windows("somoformer-fast", DUET, other)
    )


def test_fault_02_centring_on_the_whole_window() -> None:
    one, two = (walkers(1, 60, seed=seed).positions for seed in (1, 2))
    later = one.copy()
    later[15:, ..., 2] += 1.0
    first, second = (arrange([group, two], 14, np.random.default_rng(3)) for group in (one, later))
    assert first is not None
    assert second is not None
    np.testing.assert_array_equal(first.positions[:15], second.positions[:15])


def test_fault_04_every_metric_from_its_own_best_state() -> None:
    asked = []

    class Counting:
        card = load("zero-velocity").card

        def forecast(self, scene: Scene, **options: object) -> Forecast:
            asked.append(scene)
            return load("zero-velocity").forecast(scene, horizon_s=3.0)

    windows = takes(3)
    score(DUET, windows, forecast_windows(Counting(), DUET, windows))
    assert len(asked) == len(windows)  # one answer a window serves all figures


def graphs() -> list[str]:
    return [card.name for card in list_models("forecast") if card.parameters and not card.diffusion]


@pytest.mark.parametrize("name", graphs())
def test_fault_05_the_padding_mask_has_no_effect(name: str) -> None:
    model = load(name)
    assert isinstance(model, GraphForecaster)
    random = np.random.default_rng(0)
    history = random.normal(0, 0.5, (1, model.card.history, 2, len(model.card.joints), 3)).astype(np.float32)
    seen = np.ones(history.shape[:-1], bool)
    padded = np.concatenate([history, random.normal(0, 5, history.shape).astype(np.float32)], 2)
    absent = np.concatenate([seen, ~seen], 2)
    # the middle of a scene is taken off before the graph: give both the same
    alone = model.run(np.concatenate([history, history], 0), np.concatenate([seen, seen], 0))
    beside = model.run(padded, absent)[:, :, :2]
    np.testing.assert_allclose(beside, alone[:1], atol=1e-4)
    np.testing.assert_array_equal(alone[0], alone[1])


def test_fault_09_rotation_about_a_horizontal_axis() -> None:
    scene = walkers(2, 60, seed=4).positions
    np.testing.assert_array_equal(turned(scene, 1.3)[..., 2], scene[..., 2])
    arrangement = arrange([scene[:, :1], scene[:, 1:]], 14, np.random.default_rng(0))
    assert arrangement is not None
    np.testing.assert_allclose(arrangement.positions[..., 2], scene[..., 2], atol=1e-6)


def test_fault_10_the_head_for_the_neck() -> None:
    body = walkers(1, 3).positions[:, :, :1].repeat(24, 2) + np.arange(24, dtype=np.float32)[:, None]
    neck = Scene(body, SMPL24, 30).on(SOMOF13).positions[:, :, SOMOF13.names.index("neck")]
    np.testing.assert_array_equal(neck, body[:, :, SMPL24.names.index("neck")])
    assert all(len(set(skeleton.names)) == len(skeleton) for skeleton in SKELETONS.values())


def test_fault_11_training_takes_in_the_test() -> None:
    splits = {(subject, number): cmu.split_of(subject, number) for subject in range(1, 145) for number in range(1, 80)}
    assert set(splits.values()) == {"train", "validation", "test"}
    held_out = {take for take, split in splits.items() if split == "test"}
    assert {(60, 14), (61, 14), (60, 15), (61, 15)} <= held_out  # the couple's test takes, on both sides
    for take in range(1, 16):
        assert splits[60, take] == splits[61, take]


def test_fault_12_off_by_one_frame() -> None:
    windows = takes(12)
    perfect = figures(DUET, windows, windows.future[0])
    assert all(value == 0 for value in perfect.values())
    late_by_one = np.concatenate([windows.positions[:, 14:15], windows.future[0][:, :-1]], 1)
    assert figures(DUET, windows, late_by_one)["mpjpe_at", 1.0] > 5


def test_fault_13_metrics_that_count_frames_differently() -> None:
    windows = takes(12)
    frames = np.arange(1, 46)[:, None, None, None]
    growing = windows.future[0] + 0.001 * frames * np.array([1, 0, 0])  # k mm at frame k, the whole body
    found = figures(DUET, windows, growing)
    for frame in DUET.summary:
        assert found["mpjpe_at", frame / 15] == pytest.approx(frame, rel=1e-3)
        assert found["root_error_at", frame / 15] == pytest.approx(frame, rel=1e-3)
        assert found["mpjpe_until", frame / 15] == pytest.approx((frame + 1) / 2, rel=1e-3)
        assert found["root_aligned_mpjpe_at", frame / 15] == pytest.approx(0, abs=1e-3)


@pytest.mark.parametrize("protocol", [DUET, SOMOF], ids=["mpjpe", "vim"])
def test_fault_14_frames_and_people_are_mixed(protocol: Protocol) -> None:
    windows = takes(12)
    protocol = replace(protocol, skeleton="mrt15", horizon=45)
    answers = guessed(windows)
    swapped = with_positions(windows, windows.positions[:, :, ::-1])
    assert figures(protocol, windows, answers) == pytest.approx(figures(protocol, swapped, answers[:, :, ::-1]))


def test_fault_15_the_best_of_k_for_each_joint() -> None:
    random = np.random.default_rng(0)
    truth = np.zeros((20, 6, 2, 15, 3), np.float32)
    samples = random.normal(0, 0.3, (20, 6, *truth.shape[1:])).astype(
        np.float32
    )  # (windows, K, time, people, joints, 3)
    each = np.linalg.norm(samples - truth[:, None], axis=-1).mean(2)  # (windows, K, people, joints)
    found = best_of("mpjpe_m", each.mean(-1), 6, "scene") | best_of("mpjpe_m", each.mean(-1), 6, "person")
    assert set(found) == {"mpjpe_m_k1", "mpjpe_m_best_of_6_per_scene", "mpjpe_m_best_of_6_per_person"}
    chimera = each.min(1).mean()  # a sample for each joint: better than any that exists
    assert chimera < found["mpjpe_m_best_of_6_per_person"] <= found["mpjpe_m_best_of_6_per_scene"] < found["mpjpe_m_k1"]


def test_fault_16_the_truth_chooses_among_samples() -> None:
    scene = walkers(1, 15)
    samples = np.stack([scene.positions[-1:] + shift for shift in (0.0, 0.1, 0.2)])
    weights = np.array([0.2, 0.5, 0.3])
    answer = Forecast(samples, scene, scene.people, load("zero-velocity").card, weights)
    np.testing.assert_array_equal(answer.best, samples[1])  # the likeliest, whatever happened
    assert all(protocol.samples == 1 for protocol, _ in BENCHMARKS.values())


@pytest.mark.parametrize("name", ["somoformer-fast", "somoformer"])
def test_fault_17_forecasts_that_differ_from_run_to_run(name: str) -> None:
    windows = takes(1)
    np.testing.assert_array_equal(forecast_windows(name, DUET, windows), forecast_windows(load(name), DUET, windows))


def test_fault_18_units() -> None:
    scene = walkers(1, 10)
    assert metric(scene) is scene
    for factor in (100, 1000, 1 / 1.8):
        with pytest.raises(MotioncastError, match=r"metre|0\.2"):
            metric(replace(scene, positions=scene.positions * np.float32(factor)))


def test_fault_19_means_of_means_of_batches(monkeypatch: pytest.MonkeyPatch) -> None:
    windows = takes(12)
    whole = score(DUET, windows, guessed(windows))
    monkeypatch.setattr(spread, "CHUNK", 1)
    assert score(DUET, windows, guessed(windows)) == whole
    order = np.random.default_rng(1).permutation(len(windows))
    mixed = Windows(
        windows.positions[order], windows.observed[order], tuple(windows.takes[index] for index in order),
        tuple(windows.starts[index] for index in order), 15,
    )  # fmt: skip
    for one, two in zip(score(DUET, mixed, guessed(mixed)), whole, strict=True):
        assert one.value == pytest.approx(two.value, rel=1e-6)


def test_fault_20_the_last_batch_is_dropped() -> None:
    windows = takes(12)
    assert len(windows) % spread.CHUNK
    answers = guessed(windows)
    assert len(answers) == len(windows)
    rows = score(DUET, windows, answers)
    assert all(row.n == len(windows) for row in rows)
    spoilt = answers.copy()
    spoilt[-1] += 1
    assert score(DUET, windows, spoilt)[0].value > rows[0].value  # the last window counts


@pytest.mark.parametrize("protocol", [DUET, SOMOF], ids=["mpjpe", "vim"])
def test_fault_21_people_count_less_beside_padding(protocol: Protocol) -> None:
    windows = takes(12)
    protocol = replace(protocol, skeleton="mrt15", horizon=45)
    answers = guessed(windows)
    padding = np.zeros_like(windows.positions[:, :, :1])
    unseen = np.zeros_like(windows.observed[:, :, :1])
    padded = replace(
        windows,
        positions=np.concatenate([windows.positions, padding], 2),
        observed=np.concatenate([windows.observed, unseen], 2),
    )
    more = np.concatenate([answers, np.full_like(answers[:, :, :1], 9.0)], 2)
    assert figures(protocol, padded, more) == pytest.approx(figures(protocol, windows, answers))


def test_fault_22_an_own_vim() -> None:
    truth = np.zeros((1, 14, 2, 13, 3), np.float32)
    forecast = truth + np.array([0.1, 0, 0], np.float32)
    (first, *_) = figures_of(SOMOF, forecast, truth, np.ones(truth.shape[:-1], bool))
    assert first.metric == "vim_at"
    assert first.mean(np.ones(1)) == pytest.approx(10 * 13**0.5)  # cm; not divided by the joints


def result(model: str, protocol: str, **more: object) -> Result:
    rows = (Row("mpjpe_at", 1.0, 86.66, "mm", 5, 80.0, 90.0), Row("ratio_to_zero_velocity", 3.0, 0.86666, "1", 5))
    values = {
        "data": "", "setting": {}, "windows": 5, "takes": 5, "independent": "", "weights": "", "parameters": 1,
        "training": {}, "command": "", "commit": "", "seed": 0, "rows": rows,
    }  # fmt: skip
    return Result(model, "cmu-duet", protocol, **{**values, **more})


def test_fault_23_windows_that_are_not_the_benchmarks() -> None:
    windows = takes(12)
    fewer = replace(
        windows, positions=windows.positions[1:], observed=windows.observed[1:], takes=windows.takes[1:],
        starts=windows.starts[1:],
    )  # fmt: skip
    assert DUET.hash(windows) != DUET.hash(fewer)
    with pytest.raises(InputError, match="do not compare"):
        comparable([result("one", DUET.hash(windows)), result("two", DUET.hash(fewer))])


def test_fault_24_the_left_hip_for_the_root() -> None:
    truth = np.zeros((1, 14, 1, 13, 3), np.float32)
    forecast = truth.copy()
    forecast[..., SOMOF13.names.index("left_hip"), 0] = 0.1
    protocol = replace(SOMOF, metric="mpjpe")
    roots = [
        figure for figure in figures_of(protocol, forecast, truth, np.ones(truth.shape[:-1], bool))
        if figure.metric == "root_error_at"
    ]  # fmt: skip
    assert roots
    assert roots[0].mean(np.ones(1)) == pytest.approx(50, rel=1e-5)  # the middle of the hips has moved by half


def test_fault_25_a_shoulder_for_the_middle() -> None:
    assert MRT15.names[0] == "pelvis"  # the joint by which the mixer sets people down
    group = walkers(1, 20).positions
    arrangement = arrange([group], 9, np.random.default_rng(0))
    assert arrangement is not None
    (x, y, _) = arrangement.places[0]
    np.testing.assert_allclose(arrangement.positions[9, 0, 0, :2], [x, y], atol=1e-5)


def test_fault_26_a_generator_that_cannot_be_repeated() -> None:
    groups = [walkers(1, 60, seed=5).positions, walkers(2, 60, seed=6).positions]
    before = [group.copy() for group in groups]
    first, second = (arrange(groups, 14, np.random.default_rng(8)) for _ in range(2))
    assert first is not None
    assert second is not None
    np.testing.assert_array_equal(first.positions, second.positions)
    for group, copy in zip(groups, before, strict=True):
        np.testing.assert_array_equal(group, copy)  # offsets do not pile up in the takes
    singles = [replace(walkers(1, 90, seed=seed), source=f"take {seed}") for seed in range(5)]
    couples = [replace(walkers(2, 90, seed=9), source="couple")]
    one, two = (open_cmu.crowd(singles, couples, 15, 45) for _ in range(2))
    np.testing.assert_array_equal(one.positions, two.positions)
    assert all(len(set(names.split(" + "))) == len(names.split(" + ")) for names in one.takes)


def test_fault_27_decimals_are_cut_off() -> None:
    place = leaderboard.Place("model", result("model", "x"), (0.86666,), None)
    line = leaderboard.cells(place)
    assert line[1] == "87"
    assert line[2] == "0.867"
    interval = replace(result("model", "x"), rows=(Row("ratio_to_zero_velocity", 3.0, 0.9, "1", 5, 0.8666, 0.9333),))
    assert "0.867 to 0.933" in leaderboard.cells(replace(place, best=interval))


def test_fault_30_one_mean_for_another_and_times_that_are_rounded() -> None:
    windows = takes(12)
    protocol = replace(SOMOF, skeleton="mrt15", horizon=14)
    short = replace(windows, positions=windows.positions[:, :29], observed=windows.observed[:, :29])
    still = np.repeat(short.positions[:, 14:15], 14, 1)
    rows = score(protocol, short, still)
    means = {row.metric: row.value for row in rows if "mean" in row.metric}
    assert set(means) == {"vim_mean_of_moments", "vim_mean_of_frames"}
    moments = [row.value for row in rows if row.metric == "vim_at"]
    assert means["vim_mean_of_moments"] == pytest.approx(np.mean(moments))
    assert means["vim_mean_of_frames"] != pytest.approx(means["vim_mean_of_moments"], rel=1e-3)
    assert [round(row.horizon_s * 1000) for row in rows if row.metric == "vim_at"] == [133, 267, 533, 667, 933]


def test_fault_31_until_for_at() -> None:
    windows = takes(12)
    found = figures(DUET, windows, np.repeat(windows.positions[:, 14:15], 45, 1))
    assert {name.rpartition("_")[2] for name, _ in found if "mpjpe" in name} == {"at", "until"}
    for seconds in (1.0, 2.0, 3.0):
        assert found["mpjpe_until", seconds] < found["mpjpe_at", seconds]


def test_fault_32_overlapping_windows_as_independent_ones() -> None:
    windows = takes(12)
    interval = _interval(windows, guessed)
    many = Windows(
        windows.positions.repeat(10, 0), windows.observed.repeat(10, 0),
        tuple(take for take in windows.takes for _ in range(10)),
        tuple(start for start in windows.starts for _ in range(10)), 15,
    )  # fmt: skip
    np.testing.assert_allclose(_interval(many, guessed), interval, rtol=1e-5)  # ten times as many tell no more
    assert independent(DUET, many) == "12 takes"


def _interval(windows: Windows, forecaster: Callable[[Windows], np.ndarray]) -> list[float | None]:
    first = score(DUET, windows, forecaster(windows))[2]
    return [first.low, first.high]
