from __future__ import annotations

from pathlib import Path

import pytest

from motioncast.cli.app import run
from motioncast.core.scene import Scene
from motioncast.formats.load import save_scene
from motioncast.formats.moments_tsv import read_moments


def test_the_rule_alone_writes_a_table_beside_each_motion_and_leaves_it_then(
    walkers: Scene, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    files = [save_scene(walkers, tmp_path / f"{name}.npz")[0] for name in ("a", "b")]
    assert run(["annotate", *map(str, files), "--automatic"]) == 0
    tables = [tmp_path / f"{name}.moments.tsv" for name in ("a", "b")]
    assert all(table.is_file() for table in tables)
    told = f"{sum(len(read_moments(table)) for table in tables)} moments"
    assert capsys.readouterr().out.startswith(told)
    before = tables[0].read_bytes()
    assert run(["annotate", str(files[0]), "--automatic"]) == 0
    assert tables[0].read_bytes() == before


def test_one_table_for_all(walkers: Scene, tmp_path: Path) -> None:
    (file,) = save_scene(walkers, tmp_path / "a.npz")
    assert run(["annotate", str(file), "--automatic", "--out", str(tmp_path / "all.tsv")]) == 0
    assert (tmp_path / "all.tsv").is_file()
    assert not (tmp_path / "a.moments.tsv").exists()


def test_what_is_missing_is_told(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["annotate"]) == 2
    assert "one of the two" in capsys.readouterr().err
    assert run(["annotate", str(tmp_path / "nowhere.bvh")]) == 2
    assert "there is no file" in capsys.readouterr().err


def test_a_port_that_is_taken_is_told(walkers: Scene, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    import socket

    (file,) = save_scene(walkers, tmp_path / "a.npz")
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        taken.listen()
        assert run(["annotate", str(file), "--closed", "--port", str(taken.getsockname()[1])]) == 2
    assert "cannot be used" in capsys.readouterr().err
