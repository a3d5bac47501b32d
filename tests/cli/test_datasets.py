from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from motioncast.core.scene import Scene
from motioncast.core.skeletons import SOMOF13
from motioncast.datasets import somof
from motioncast.formats.load import load_scene, save_scene
from motioncast.testing import walkers as made_up


@pytest.fixture
def windows(tmp_path: Path) -> Path:
    """Three windows in SoMoF's own files, of one split."""
    scenes = [made_up(people=2, frames=30, fps=15.0, seed=seed).on(SOMOF13) for seed in range(3)]
    folder = tmp_path / "somof"
    folder.mkdir()
    somof.write(scenes, folder)
    return folder


def test_the_list_has_licence_size_and_where(command) -> None:
    done = command("datasets")
    assert done.status == 0
    for word in ("threedpw", "licence:", "size:", "from:", "mocap.cs.cmu.edu"):
        assert word in done.out
    answer = command("datasets", "--json").answer("datasets")
    assert "umpm" in {entry["name"] for entry in answer["datasets"]}


def test_a_whole_copy_is_fine(walkers: Scene, command) -> None:
    save_scene(walkers.select(["ada"]), "ada.bvh")
    done = command("datasets", "check", "bvh-folder", "--data", ".")
    assert (done.status, done.err) == (0, "")
    assert done.out.splitlines() == ["there:   *.bvh or *.BVH: 1 files, 0.0 MB", done.out.splitlines()[1]]
    assert "1 scenes of one person" in done.out


def test_what_is_missing_gives_a_status(windows: Path, command) -> None:
    done = command("datasets", "check", "somof", "--data", windows)
    assert done.status == 2
    assert "missing: *valid_in.json" in done.out
    assert "there:   all: 3 scenes" in done.out
    assert "lacks *valid_in.json" in done.err
    assert "somof.stanford.edu" in done.err
    assert len(done.err.splitlines()) == 1


def test_findings_as_json(windows: Path, command) -> None:
    done = command("datasets", "check", "somof", "--data", windows, "--json")
    assert done.status == 2
    answer = done.answer("check")
    assert answer["dataset"] == "somof"
    assert {finding["kind"] for finding in answer["findings"]} == {"there", "missing"}


def test_converted_and_back(windows: Path, command) -> None:
    done = command("datasets", "convert", "somof", "--data", windows, "--out", "ours")
    assert (done.status, done.out) == (0, "3 files in ours\n")
    names = sorted(path.name for path in Path("ours").iterdir())
    assert names == ["SoMoF_test_0.npz", "SoMoF_test_1.npz", "SoMoF_test_2.npz"]
    assert load_scene("ours/SoMoF_test_1.npz").frames == 30
    done = command("datasets", "convert", "somof", "--data", "ours", "--out", "theirs", "--back")
    assert (done.status, done.out) == (0, "2 files in theirs\n")
    np.testing.assert_array_equal(somof.read("theirs").positions, somof.read(windows).positions)


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (("convert", "amass", "--data", ".", "--out", "ours", "--back"), "only read"),
        (("convert", "somof", "--data", ".", "--out", "ours", "--back"), "no npz files"),
        (("convert", "umpm", "--data", ".", "--out", "ours"), "holds no"),
        (("convert", "umpn", "--data", ".", "--out", "ours"), 'did you mean "umpm"'),
        (("check", "umpm", "--data", "nowhere"), "there is no folder"),
    ],
)
def test_mistakes(arguments: tuple[str, ...], says: str, command) -> None:
    done = command("datasets", *arguments)
    assert done.status == 2
    assert says in done.err
    assert len(done.err.splitlines()) == 1


def test_files_of_another_origin_are_not_somofs(walk: Path, command) -> None:
    done = command("datasets", "convert", "somof", "--data", walk.parent, "--out", "theirs", "--back")
    assert done.status == 2
    assert "comes from SoMoF" in done.err


def test_one_name_for_two_takes_gives_two_files(walkers: Scene, command) -> None:
    for folder in ("a", "b"):
        Path(folder).mkdir()
        save_scene(walkers.select(["ada"]), f"{folder}/ada.bvh")
    done = command("datasets", "convert", "bvh-folder", "--data", ".", "--out", "ours")
    assert done.status == 0
    assert len(list(Path("ours").iterdir())) == 2
