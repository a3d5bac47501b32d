from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from motioncast.core.skeletons import MRT15
from motioncast.datasets import cmu_mrt, mixes, mupots, umpm
from motioncast.errors import FormatError, InputError
from motioncast.testing import walkers


def stored(scenes: int, people: int, frames: int, scale: float) -> tuple[np.ndarray, np.ndarray]:
    """Walkers in metres with z up, and as MRT stores them: people before frames, y up, another unit."""
    metres = np.stack([walkers(people=people, frames=frames, seed=seed).on(MRT15).positions for seed in range(scenes)])
    x, y, z = np.moveaxis(metres, -1, 0)
    values = np.stack([x, z, -y], -1).swapaxes(1, 2).reshape(scenes, people, frames, 45) * scale
    return metres, values.astype(np.float64)


def test_cmu_becomes_metres_with_z_up(tmp_path: Path) -> None:
    metres, values = stored(2, 3, 120, 0.06 * 0.45 / 0.0254)
    np.save(tmp_path / "test_3_120_mocap.npy", values)
    first, second = cmu_mrt.read(tmp_path / "test_3_120_mocap.npy")
    np.testing.assert_allclose(second.positions, metres[1], atol=1e-5)
    assert (first.fps, first.skeleton, len(first.people)) == (30.0, MRT15, 3)
    assert first.source != second.source


def test_windows_are_every_second_frame(tmp_path: Path) -> None:
    metres, values = stored(2, 3, 120, 1 / cmu_mrt.UNIT_M)
    np.save(tmp_path / "test_3_120_mocap.npy", values)
    windows = cmu_mrt.windows(tmp_path, "test")
    assert windows.past[0].shape == (2, 15, 3, 15, 3)
    assert windows.future[0].shape == (2, 45, 3, 15, 3)
    np.testing.assert_allclose(windows.positions, metres[:, ::2], atol=1e-5)
    assert len(set(windows.takes)) == 2
    with pytest.raises(InputError, match="train_3_120"):
        cmu_mrt.windows(tmp_path, "train")
    with pytest.raises(InputError, match='"validation"'):
        cmu_mrt.windows(tmp_path, "validation")


def test_people_and_frames_are_not_mixed(tmp_path: Path) -> None:
    """A reshape of (people, frames) to (frames, people) would pass every check of shapes."""
    values = stored(1, 3, 75, 1 / umpm.UNIT_M)[1]
    swapped = values[:, [2, 0, 1]]
    for name, array in (("test_3_75_mocap_umpm.npy", values), ("train_3_75_mocap_umpm.npy", swapped)):
        np.save(tmp_path / name, array)
    plain, other = umpm.windows(tmp_path, "test").positions, umpm.windows(tmp_path, "train").positions
    np.testing.assert_array_equal(other, plain[:, :, [2, 0, 1]])


def test_umpm_and_its_mixes(tmp_path: Path) -> None:
    metres, values = stored(1, 6, 75, 1 / umpm.UNIT_M)
    np.save(tmp_path / "mix1_6persons.npy", values)
    windows = umpm.windows(tmp_path, "mix1")
    np.testing.assert_allclose(windows.positions, metres, atol=1e-5)
    assert (windows.history, windows.future[0].shape[1]) == (50, 25)
    (scene,) = umpm.read(tmp_path / "mix1_6persons.npy")
    assert scene.fps == 25.0


@pytest.mark.parametrize("scale", mupots.SCALES)
def test_the_scale_of_mupots_is_told_by_the_people(scale: float, tmp_path: Path) -> None:
    metres, values = stored(2, 3, 120, scale)
    np.save(tmp_path / "mupots_120_3persons.npy", values)
    (scene, _) = mupots.read(tmp_path / "mupots_120_3persons.npy")
    np.testing.assert_allclose(scene.positions, metres[0], atol=1e-5)
    assert f"{scale:g} units" in scene.remarks[0]
    assert scene.skeleton.find("head_top") == MRT15.index("head")
    np.testing.assert_allclose(mupots.windows(tmp_path).positions, metres[:, ::2], atol=1e-5)
    with pytest.raises(InputError, match="2persons"):
        mupots.windows(tmp_path, 2)


@pytest.mark.parametrize("scale", [1000.0, 17.7, 0.3])
def test_another_unit_is_refused(scale: float, tmp_path: Path) -> None:
    path = tmp_path / "test_3_120_mocap.npy"
    np.save(path, stored(1, 3, 120, scale)[1])
    with pytest.raises(InputError, match="another unit"):
        list(cmu_mrt.read(path))
    with pytest.raises(InputError, match="another unit"):
        cmu_mrt.windows(tmp_path)


def test_odd_files_are_named(tmp_path: Path) -> None:
    path = tmp_path / "test_3_120_mocap.npy"
    whole = stored(1, 3, 120, 1 / cmu_mrt.UNIT_M)[1]
    np.save(path, whole)
    path.write_bytes(path.read_bytes()[:5000])
    with pytest.raises(FormatError, match="no whole npy"):
        mixes.stored(path)
    np.save(path, np.array([{"a": 1}, print], object), allow_pickle=True)
    with pytest.raises(FormatError, match="no whole npy"):
        mixes.stored(path)
    np.savez(path.with_suffix(".npz"), whole)
    with pytest.raises(FormatError, match="no whole npy"):
        mixes.stored(path.with_suffix(".npz"))
    for odd in (whole[0], whole[..., :39], whole[:0], whole.astype(np.int64)):
        np.save(path, odd)
        with pytest.raises(FormatError, match="expected floats"):
            mixes.stored(path)
    whole[0, 1, 7] = np.nan
    np.save(path, whole)
    with pytest.raises(FormatError, match="not finite"):
        list(cmu_mrt.read(path))
    np.save(path, stored(1, 3, 20, 1 / cmu_mrt.UNIT_M)[1])
    with pytest.raises(InputError, match="more than 15"):
        cmu_mrt.windows(tmp_path)
