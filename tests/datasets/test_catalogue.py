from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from motioncast.core.scene import Scene
from motioncast.core.skeletons import MRT15
from motioncast.datasets import bvh_folder
from motioncast.datasets.catalogue import DataSet, Finding, catalogue, data_set, limb_lengths, metric, oddities
from motioncast.errors import FormatError, InputError
from motioncast.formats.load import save_scene

NAMES = {
    "amass", "bvh-folder", "cmu", "cmu-mrt", "extra", "grab", "h36m", "hik", "mupots", "somof", "threedpw", "umpm",
}  # fmt: skip


def test_every_module_with_an_entry_is_found() -> None:
    found = catalogue()
    assert set(found) >= NAMES
    for name, entry in found.items():
        assert entry.name == name
        assert all((entry.what, entry.licence, entry.size, entry.origin, entry.files))


@pytest.mark.parametrize("name", sorted(NAMES))
def test_an_empty_folder_and_no_folder(name: str, tmp_path: Path) -> None:
    entry = data_set(name)
    with pytest.raises(InputError, match="there is no folder"):
        entry.check(tmp_path / "nowhere")
    with pytest.raises(InputError, match="there is no folder"):
        list(entry.scenes(tmp_path / "nowhere"))
    with pytest.raises(InputError, match="holds no"):
        list(entry.scenes(tmp_path))
    if name != "cmu":  # whose reader says better what was looked for
        assert {finding.kind for finding in entry.check(tmp_path)} == {"missing"}


def test_an_unknown_name_says_the_closest() -> None:
    with pytest.raises(InputError, match='did you mean "threedpw"'):
        data_set("threepw")


@pytest.fixture
def toy(walkers: Scene, tmp_path: Path) -> DataSet:
    def read(path: Path) -> Iterator[Scene]:
        if path.stem == "bad":
            raise FormatError(path, "is damaged")
        yield replace(walkers, source=path.stem)
        if path.stem == "b":
            yield replace(walkers, source="giant", positions=walkers.positions * 3)
            yield replace(walkers[:30], source="statue", positions=np.repeat(walkers.positions[:1], 30, 0))

    for name in ("a", "b", "bad"):
        (tmp_path / f"{name}.toy").write_text(name, encoding="utf-8")
    files = ("*.toy", "list.txt or other.txt")
    return DataSet("toy", "w", "l", "s", "o", files, lambda folder: sorted(folder.glob("*.toy")), read)


def test_a_check_says_what_is_there_missing_and_odd(toy: DataSet, tmp_path: Path) -> None:
    shares: list[float] = []
    findings = toy.check(tmp_path, shares.append)
    assert findings[0] == Finding("there", "*.toy: 3 files, 0.0 MB")
    assert findings[1] == Finding("missing", "list.txt or other.txt")
    odd = [finding.what for finding in findings if finding.kind == "odd"]
    assert sum("giant: " in what for what in odd) == 8  # each thigh, shin, upper arm and forearm
    assert "statue: nobody moves" in odd
    assert any("bad.toy: is damaged" in what for what in odd)
    assert findings[-1] == Finding("there", "all: 4 scenes of up to 2 people, 0.1 minutes")
    assert shares[-1] == 1.0
    (tmp_path / "other.txt").write_text("", encoding="utf-8")
    assert not any(finding.kind == "missing" for finding in toy.check(tmp_path))


def test_counts_by_split_and_masked_frames(toy: DataSet, walkers: Scene, tmp_path: Path) -> None:
    gone = replace(walkers, observed=np.arange(60)[:, None, None] + np.zeros((60, 2, 15)) >= 4)
    entry = replace(toy, read=lambda path: iter([gone]), split=lambda scene: "test")
    assert entry.check(tmp_path)[-1].what == "test: 3 scenes of up to 2 people, 0.1 minutes, 12 frames masked"


def test_limbs_tell_the_unit(walkers: Scene) -> None:
    assert metric(walkers) is walkers
    lengths = limb_lengths(walkers)
    assert len(lengths) == 8
    assert lengths["left_hip to left_knee"] == pytest.approx(0.42, abs=0.01)
    for scale in (100.0, 2.0, 0.3):
        with pytest.raises(InputError, match="another unit"):
            metric(replace(walkers, positions=walkers.positions * scale))
    hidden = replace(walkers, observed=np.zeros((60, 2, 15), bool))
    assert limb_lengths(metric(hidden)) == {}
    assert list(oddities(Scene(walkers.positions[:1], MRT15, 30))) == ["it has 1 frames"]


def test_any_folder_of_bvh(walkers: Scene, tmp_path: Path) -> None:
    (tmp_path / "deep").mkdir()
    save_scene(walkers.select(["ada"]), tmp_path / "deep" / "ada.bvh")
    (tmp_path / "broken.bvh").write_text("HIERARCHY\n", encoding="utf-8")
    findings = bvh_folder.DATASET.check(tmp_path)
    assert findings[0].what.startswith("*.bvh or *.BVH: 2 files")
    assert [finding.kind for finding in findings] == ["there", "odd", "there"]
    (scene,) = bvh_folder.read(tmp_path / "deep" / "ada.bvh")
    assert scene.frames == walkers.frames


@pytest.mark.data
def test_the_open_data_beside_the_checkout(shared: Path) -> None:
    (count,) = (finding for finding in data_set("extra").check(shared) if finding.what.startswith("all"))
    assert count.what == "all: 99 scenes of one person, 4.0 minutes"
    from motioncast.datasets import cmu_check

    small = shared / "cmu" / "cmu_003.tar.xz"
    assert small in cmu_check.parts(shared)
    assert {cmu_check.split(scene) for scene in cmu_check.read(small)} == {"validation"}


def test_the_page_lists_every_data_set() -> None:
    page = (Path(__file__).parents[2] / "docs" / "datasets.md").read_text(encoding="utf-8")
    for name in catalogue():
        assert f"| `{name}` |" in page
