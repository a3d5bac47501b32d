"""Humans in Kitchens, measured on tiny files in its owners' layout."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from motioncast.benchmarks.hik import NEVER_IN_TRAINING, evaluate_hik, hik_windows, score
from motioncast.benchmarks.run import evaluate
from motioncast.bodies import smpl
from motioncast.datasets import hik
from motioncast.datasets.hik_furniture import pieces
from motioncast.errors import FormatError, InputError
from motioncast.inference.baselines import SimpleGuess
from motioncast.inference.denoiser import DiffusionForecaster
from motioncast.inference.registry import load
from motioncast.testing.smpl import write_smpl

ITEMS = {"D": {"walking": [{"pid": 1, "frame": 300}, {"pid": 2, "frame": 320}], "sink": [{"pid": 5, "frame": 300}]}}
CORNERS = np.array(
    [[0, 0, 0.8], [1, 0, 0.8], [1, 0, 0], [0, 0, 0], [0, 0.5, 0.8], [1, 0.5, 0.8], [1, 0.5, 0], [0, 0.5, 0]]
)


@pytest.fixture(scope="module")
def kitchen(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Person 1 walks at 1 m/s, person 2 at 0.5, person 5 comes in with the first future frame of its item."""
    folder = tmp_path_factory.mktemp("hik")
    model = smpl.load(write_smpl(folder / "m.npz", "smplx"))
    x, y, z = smpl.joints(model, np.zeros(10), np.zeros((1, 165)))[0].T
    body = np.zeros((29, 3))
    body[:24] = np.stack([x, -z, y + 0.95], -1)[:24]
    body[24:] = body[15] + (0, -0.1, 0.05)
    (folder / "poses").mkdir()
    for person, first, last, speed in ((1, 40, 560, 1.0), (2, 60, 600, 0.5), (5, 300, 600, 0.5)):
        frames = np.arange(first, last + 1)
        path = np.stack([frames * speed / 25, np.full(len(frames), 3.0 * person), np.zeros(len(frames))], -1)
        np.savez(
            folder / "poses" / f"D_{person}_0.npz", poses3d=(body + path[:, None]).astype(np.float32), frames=frames
        )
    (folder / "test.json").write_text(json.dumps(ITEMS), encoding="utf-8")
    put(folder, "sink0", "StaticObjectType.SINK", "box", 0, CORNERS[None] + [2, 3, 0])
    put(folder, "stool1", "SITTABLE", "cylinder", 2, np.arange(700)[:, None] * [0.01, 0, 0, 0] + [0, 0, 0.5, 0.2])
    put(folder, "oob1", "OUT_OF_BOUND", "box", 0, CORNERS[None])
    return folder


def put(folder: Path, name: str, kind: str, shape: str, step: int, places: np.ndarray) -> Path:
    path = folder / "scenes" / "D_scene" / f"{name}.json"
    path.parent.mkdir(parents=True, exist_ok=True)
    told = {"name": name, "type": kind, "shape": shape, "frame_multiplier": step}
    path.write_text(json.dumps(told), encoding="utf-8")
    np.save(path.with_suffix(".npy"), places.astype(np.float32))
    return path


def test_an_item_is_a_history_with_the_furniture_as_it_stood_and_what_came_then(kitchen: Path) -> None:
    first, second = hik_windows(kitchen)  # the third item's person is not there at now
    assert (first.scene.people, second.scene.people) == (("person 1", "person 2"), ("person 2", "person 1", "person 5"))
    assert first.scene.frames == 250
    assert first.seen.sum(0).tolist() == [250, 250]
    assert second.seen.sum(0).tolist() == [250, 241, 250]
    things = {thing.name: thing for thing in first.scene.objects}
    assert set(things) == {"sink0", "stool1"}
    np.testing.assert_allclose(things["stool1"].position, [1.49, 0, 0.25], atol=1e-6)  # row 149 holds frames 298, 299
    assert things["sink0"].category == "sink"


@pytest.mark.parametrize("angle", [0.0, 0.7, 2.5])
@pytest.mark.parametrize("order", [range(8), [1, 2, 3, 0, 5, 6, 7, 4], [4, 5, 6, 7, 0, 1, 2, 3]])
def test_a_box_is_where_its_corners_are(tmp_path: Path, angle: float, order: list[int]) -> None:
    turn = np.array([[np.cos(angle), np.sin(angle), 0], [-np.sin(angle), np.cos(angle), 0], [0, 0, 1]])
    corners = CORNERS[list(order)] @ turn + [1, 2, 0.3]
    put(tmp_path, "table", "TABLE", "box", 0, corners[None])
    box = pieces(tmp_path, "D")[0].at(7)
    found = {tuple(corner) for corner in box.corners.round(4) + 0.0}
    assert found == {tuple(corner) for corner in corners.round(4) + 0.0}


def test_perfect_answers_score_zero_and_people_are_told_apart(kitchen: Path) -> None:
    windows = hik_windows(kitchen)
    found = {(row.metric, row.horizon_s): row for row in score(windows, [window.future for window in windows])}
    assert {metric for metric, _ in found} == {
        "mpjpe_at", "mpjpe_at_walking", "mpjpe_at_of_seen_people", "mpjpe_at_of_unseen_people", "mpjpe_at_of_everybody",
        "ratio_to_zero_velocity",
    }  # fmt: skip
    assert max(row.value for row in found.values()) == 0
    late = [window.future.copy() for window in windows]
    late[1][:, 0] += np.float32((0.0, 0.0, 0.3))  # person 2, who is in no training kitchen
    late[0][:, 1] += np.float32((0.0, 0.0, 0.1))  # who is there beside person 1
    found = {(row.metric, row.horizon_s): row.value for row in score(windows, late)}
    for metric, expected in (
        ("mpjpe_at", 150), ("mpjpe_at_of_seen_people", 0), ("mpjpe_at_of_unseen_people", 300),
        ("mpjpe_at_of_everybody", 400 / 5),
    ):  # fmt: skip
        assert found[metric, 0.2] == pytest.approx(expected, rel=1e-4), metric


def test_who_stands_still_is_as_wrong_as_people_walk(kitchen: Path) -> None:
    result = evaluate_hik(SimpleGuess("zero-velocity"), kitchen)
    found = {(row.metric, row.horizon_s): row for row in result.rows}
    assert found["mpjpe_at_of_seen_people", 1.0].value == pytest.approx(1000, rel=1e-3)
    assert found["mpjpe_at_of_unseen_people", 10.0].value == pytest.approx(5000, rel=1e-3)
    assert (result.ratio.value, result.windows, result.independent) == (1.0, 2, "2 people")
    assert (found["mpjpe_at", 1.0].low, found["mpjpe_at", 1.0].high) == pytest.approx((500, 1000), rel=1e-3)


def test_evaluated_by_name_and_by_a_model_of_other_joints(kitchen: Path) -> None:
    model = load("sast")
    assert isinstance(model, DiffusionForecaster)
    result = evaluate(model.sampled_by(None, 1), "hik", kitchen, alone=True)
    assert (result.model, result.benchmark) == ("sast (others hidden)", "hik")
    assert 0 < result.ratio.value < 2
    assert evaluate("root-velocity-damped", "hik", kitchen).ratio.value < 1
    with pytest.raises(InputError, match="its owners' test list"):
        evaluate("zero-velocity", "hik", kitchen, split="validation")


def test_odd_copies_are_refused(kitchen: Path, tmp_path: Path) -> None:
    path = put(tmp_path, "table", "TABLE", "box", 0, np.zeros((1, 7, 3)))
    with pytest.raises(FormatError, match="places of shape"):
        pieces(tmp_path, "D")
    path.with_suffix(".npy").unlink()
    with pytest.raises(FormatError, match=r"its \.npy beside it"):
        pieces(tmp_path, "D")
    (tmp_path / "test.json").write_text(json.dumps(ITEMS | {"D": {"sink": []}}), encoding="utf-8")
    path.unlink()
    with pytest.raises(InputError, match="no stay of kitchen D"):
        hik_windows(tmp_path)


@pytest.mark.data
def test_most_items_are_of_people_who_are_in_the_training_kitchens(shared: Path) -> None:
    items = hik.items(shared / "hik")
    assert sum(item.person not in NEVER_IN_TRAINING for item in items) == 819
    assert len({item.person for item in items}) == 24
