from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from motioncast.benchmarks.run import evaluate
from motioncast.core.skeletons import SOMOF13
from motioncast.datasets import somof
from motioncast.errors import FormatError, InputError
from motioncast.testing import walkers


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """Three windows of two walkers in the benchmark's layout: y up, people before frames."""
    scenes = [walkers(people=2, frames=30, seed=seed).on(SOMOF13).positions for seed in range(3)]
    y_up = np.stack([[s[..., 0], s[..., 2], -s[..., 1]] for s in scenes])
    nested = np.moveaxis(y_up, 1, -1).swapaxes(1, 2).reshape(3, 2, 30, 39)
    for part, frames in (("in", slice(0, 16)), ("out", slice(16, 30))):
        (tmp_path / f"3dpw_test_{part}.json").write_text(json.dumps(nested[:, :, frames].tolist()), encoding="utf-8")
    (tmp_path / "3dpw_test_frames_in.json").write_text("[]", encoding="utf-8")
    return tmp_path


def test_windows_stand_upright_and_in_order(folder: Path) -> None:
    windows = somof.read(folder)
    expected = walkers(people=2, frames=30, seed=1).on(SOMOF13).positions
    np.testing.assert_allclose(windows.positions[1], expected, atol=1e-6)
    assert windows.history == 16


def test_vim_is_the_norm_of_the_flattened_pose(folder: Path) -> None:
    result = evaluate("zero-velocity", "somof", folder)
    windows = somof.read(folder)
    error = windows.positions[:, 17] - windows.positions[:, 15]
    expected = np.linalg.norm(error.reshape(3, 2, 39), axis=-1).mean() * 100
    assert result.rows[0].value == pytest.approx(expected, rel=1e-5)
    assert [round(row.horizon_s * 1000) for row in result.rows[:5]] == [133, 267, 533, 667, 933]


def test_missing_and_odd_files_are_named(folder: Path) -> None:
    with pytest.raises(InputError, match="valid_in"):
        somof.read(folder, "validation")
    (folder / "3dpw_test_in.json").write_text("[[1, 2], [3]]", encoding="utf-8")
    with pytest.raises(FormatError, match="nested"):
        somof.read(folder)
    (folder / "3dpw_test_in.json").write_text("[[1, 2], [3, 4]]", encoding="utf-8")
    with pytest.raises(FormatError, match="shape"):
        somof.read(folder)


def test_scenes_written_back_are_the_files_to_the_last_bit(folder: Path, tmp_path: Path) -> None:
    scenes = list(somof.scenes(folder / "3dpw_test_in.json"))
    assert [(scene.source, scene.frames, scene.fps) for scene in scenes[:2]] == [
        ("SoMoF test 0", 30, 15.0),
        ("SoMoF test 1", 30, 15.0),
    ]
    again = tmp_path / "again"
    again.mkdir()
    files = somof.write(scenes, again)
    for path in files:
        read, given = (np.array(json.loads((place / path.name).read_text("utf-8"))) for place in (again, folder))
        np.testing.assert_array_equal(read.astype(np.float32), given.astype(np.float32))
    np.testing.assert_array_equal(somof.read(again).positions, somof.read(folder).positions)


def test_what_the_files_cannot_hold_is_refused(folder: Path) -> None:
    scenes = list(somof.scenes(folder / "3dpw_test_in.json"))
    with pytest.raises(InputError, match="expected 30 at 15"):
        somof.write([scenes[0], scenes[1][:20]], folder)
    with pytest.raises(InputError, match="1 people"):
        somof.write([scenes[0], scenes[1].select(["person 1"])], folder)
    hidden = replace(scenes[0], observed=np.arange(30)[:, None, None] * np.ones((30, 2, 13)) != 3)
    with pytest.raises(InputError, match="not observed"):
        somof.write([hidden], folder)
    with pytest.raises(InputError, match="no windows"):
        somof.write([], folder)


def test_a_copy_of_one_split_lacks_the_others(folder: Path) -> None:
    findings = somof.DATASET.check(folder)
    assert [finding.what for finding in findings if finding.kind == "missing"] == [
        "*valid_in.json",
        "*valid_out.json",
        "*train_in.json",
        "*train_out.json",
    ]
    assert findings[-1].what.startswith("all: 3 scenes of up to 2 people")
