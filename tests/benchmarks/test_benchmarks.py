from __future__ import annotations

from functools import cache
from pathlib import Path

import numpy as np
import pytest

from motioncast.benchmarks.calibration import held, radii
from motioncast.benchmarks.manifest import manifest
from motioncast.benchmarks.protocol import Protocol
from motioncast.benchmarks.protocols import BENCHMARKS, windows_of
from motioncast.benchmarks.run import evaluate, forecast_windows
from motioncast.benchmarks.scoring import independent, score, sources_of
from motioncast.core.skeletons import MRT15
from motioncast.datasets.windows import Windows, cut
from motioncast.errors import InputError
from motioncast.inference.baselines import RULES
from motioncast.inference.registry import load
from motioncast.testing import walkers

built = cache(windows_of)

TOY = Protocol("toy", "mrt15", 15.0, 15, 45, (15, 30, 45), (15, 30, 45), "mpjpe", "walkers")


def toy_windows() -> Windows:
    scenes = [walkers(people=2, frames=90, seed=seed) for seed in range(12)]
    windows = cut(scenes, 15, 45)
    takes = tuple(f"take {index // 7}" for index in range(len(windows)))
    return Windows(windows.positions, windows.observed, takes, windows.starts, 15)


def test_standing_still_has_the_ratio_one() -> None:
    windows = toy_windows()
    rows = score(TOY, windows, forecast_windows(load("zero-velocity"), TOY, windows))
    assert rows[-1].metric == "ratio_to_zero_velocity"
    assert rows[-1].value == pytest.approx(1.0)


def test_the_truth_scores_zero_and_intervals_enclose_the_value() -> None:
    windows = toy_windows()
    assert all(row.value == 0 for row in score(TOY, windows, windows.future[0]))
    for row in score(TOY, windows, forecast_windows(load("neck-velocity"), TOY, windows)):
        assert row.low is not None
        assert row.high is not None
        assert row.low <= row.value <= row.high


def test_few_takes_are_drawn_by_blocks_of_eight_seconds() -> None:
    windows = toy_windows()
    starts = tuple((60 * index,) for index in range(9))  # every 4 s
    few = Windows(windows.positions[:9], windows.observed[:9], ("a",) * 5 + ("b",) * 4, starts, 15)
    assert independent(TOY, few) == "6 blocks of 8 s of 2 takes"


def test_a_composed_scene_comes_from_all_of_its_takes() -> None:
    windows = toy_windows()
    takes = tuple(f"take {index % 11} + take {(index + 1) % 11}" for index in range(11))
    starts = tuple((15, 30) for _ in takes)
    composed = Windows(windows.positions[:11], windows.observed[:11], takes, starts, 15)
    assert independent(TOY, composed) == "11 takes"
    assert sources_of(TOY, composed)[3] == [("take 3", 1.0), ("take 4", 2.0)]


def test_order_of_windows_and_people_changes_no_figure() -> None:
    windows = toy_windows()
    answers = forecast_windows(load("root-velocity-damped"), TOY, windows)
    order = np.random.default_rng(0).permutation(len(windows))
    shuffled = Windows(
        windows.positions[order][:, :, ::-1], windows.observed[order][:, :, ::-1],
        tuple(windows.takes[index] for index in order), tuple(windows.starts[index] for index in order), 15,
    )  # fmt: skip
    for one, other in zip(score(TOY, windows, answers), score(TOY, shuffled, answers[order][:, :, ::-1]), strict=True):
        assert one.value == pytest.approx(other.value)


def test_the_future_does_not_reach_the_forecast() -> None:
    windows = toy_windows()
    windows = Windows(windows.positions[:3], windows.observed[:3], windows.takes[:3], windows.starts[:3], 15)
    changed = windows.positions.copy()
    changed[:, 15:] += 1.0
    other = Windows(changed, windows.observed, windows.takes, windows.starts, 15)
    for name in ("root-velocity-damped", "somoformer-fast"):
        model = load(name)
        np.testing.assert_array_equal(forecast_windows(model, TOY, windows), forecast_windows(model, TOY, other))


def test_another_protocol_or_another_frame_is_another_hash() -> None:
    windows = toy_windows()
    moved = windows.positions.copy()
    moved[0, 0, 0, 0, 0] += 0.001
    other = Windows(moved, windows.observed, windows.takes, windows.starts, 15)
    longer = Protocol("toy", "mrt15", 15.0, 15, 45, (15, 30), (15, 30), "mpjpe", "walkers")
    assert len({TOY.hash(windows), TOY.hash(other), longer.hash(windows)}) == 3
    assert manifest(TOY, windows) != manifest(TOY, other)


def test_unknown_benchmark(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="cmu-duet"):
        windows_of("cmu-trio", tmp_path)


def test_radii_weigh_takes_not_windows() -> None:
    short, long = np.full((2, 1, 1), 1.0), np.full((200, 1, 1), 0.1)
    assert radii([short, long, long[:50]])["0.9"][0][0] == 1.0  # a third of the takes, one window in a hundred
    assert radii([long, long, short])["0.5"][0][0] == 0.1


def test_radii_hold_their_share_of_what_they_were_made_from() -> None:
    random = np.random.default_rng(0)
    takes = [random.gamma(2, 0.1, (40, 3, 4)).cumsum(1) for _ in range(20)]
    table = radii(takes)
    for level in ("0.5", "0.9"):
        share = held(np.concatenate(takes), table[level])
        assert (share >= float(level)).all()
        assert (share <= float(level) + 0.1).all()


@pytest.mark.data
def test_the_composed_scenes_are_those_of_the_manifest(shared: Path) -> None:
    import motioncast.benchmarks as package

    listed = Path(package.__file__).parent / "manifests" / "cmu-crowd.csv"
    protocol, windows = built("cmu-crowd", shared)
    assert manifest(protocol, windows) == listed.read_text(encoding="utf-8")


@pytest.mark.data
def test_simple_guesses_on_the_couple_are_those_that_were_measured(shared: Path) -> None:
    published = {
        "zero-velocity": (125, 231, 451, 616, 618),
        "neck-velocity": (102, 205, 527, 1165, 1658),
        "root-velocity-damped": (112, 217, 499, 849, 932),
    }
    assert set(published) <= set(RULES)
    for name, errors in published.items():
        result = evaluate(name, "cmu-duet", shared)
        assert [round(row.value) for row in result.rows[:5]] == list(errors)


@pytest.mark.data
@pytest.mark.parametrize("name", [name for name in BENCHMARKS if name != "somof"])
def test_every_benchmark_builds(name: str, shared: Path) -> None:
    protocol, windows = built(name, shared)
    assert windows.positions.shape[1] == protocol.history + protocol.horizon
    assert np.isfinite(windows.positions).all()
    thigh = np.linalg.norm(windows.positions[..., 2, :] - windows.positions[..., 0, :], axis=-1)
    assert 0.2 < np.median(thigh) < 0.6  # metres: pelvis to knee, or hip to knee
    assert len(MRT15) == 15
