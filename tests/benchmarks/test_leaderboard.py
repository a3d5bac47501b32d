from __future__ import annotations

import csv
import io
import json
from dataclasses import replace
from pathlib import Path

import pytest

from motioncast.benchmarks import leaderboard as boards
from motioncast.benchmarks.result import Result, Row, load_result, save_result
from motioncast.errors import InputError

ROWS = (Row("mpjpe_at", 1.0, 100.0, "mm", 5, 90.0, 110.0), Row("ratio_to_zero_velocity", 3.0, 0.8, "1", 5, 0.7, 0.9))
SETTING = {"windows": "toys", "split": "test", "metric": "mpjpe", "condition": "clean"}


def made(model: str, ratio: float, *, seed: int = 0, protocol: str = "abc", parameters: int = 10) -> Result:
    rows = (ROWS[0], replace(ROWS[1], value=ratio))
    return Result(
        model=model, benchmark="toy", protocol=protocol, data="d", setting=SETTING, windows=5, takes=5,
        independent="5 takes", weights="w", parameters=parameters,
        training={"seed": seed, "scenes": 1000, "minutes": 2.4}, command="", commit="", seed=0, rows=rows,
    )  # fmt: skip


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    for result in (made("slow", 0.9), made("quick", 0.7)):
        save_result(result, tmp_path)
    (tmp_path / boards.SPEED).write_text(json.dumps({"runtime": "a clock", "median_ms": {"quick": 1.25}}))
    return tmp_path


def test_a_result_comes_back_as_it_was_written(tmp_path: Path) -> None:
    result = made("quick (others hidden)", 0.7)
    path = save_result(result, tmp_path)
    assert path.name == "toy.quick-others-hidden.json"
    assert load_result(path) == result


@pytest.mark.parametrize("text", ["", "[]", "{}", '{"schema": "motioncast.result/1", "rows": [], "x": 1}'])
def test_damaged_results_are_named(tmp_path: Path, text: str) -> None:
    path = tmp_path / "toy.bad.json"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(InputError, match="holds no result"):
        load_result(path)


def test_the_most_accurate_comes_first_with_its_time(folder: Path) -> None:
    board = boards.leaderboard("toy", [folder])
    assert [place.model for place in board.places] == ["quick", "slow"]
    line = dict(zip(boards.heads(board), boards.cells(board.places[0]), strict=True))
    assert line == {
        "model": "quick", "1000 ms": "100", "over standing still": "0.700", "95 %": "0.700 to 0.900", "seeds": "1",
        "parameters": "10", "ms a pass": "1.2", "scenes": "1,000", "minutes": "2",
    }  # fmt: skip
    assert boards.cells(board.places[1])[6] == "-"


def test_seeds_are_one_line_with_their_spread(folder: Path) -> None:
    for seed, ratio in ((1, 0.74), (2, 0.75)):
        save_result(made("quick", ratio, seed=seed), folder)
    board = boards.leaderboard("toy", [folder])
    (first, *_) = board.places
    assert first.model == "quick"
    assert first.value == pytest.approx(0.73)
    assert boards.cells(first)[4] == "0.700 to 0.750 (3)"


def test_a_later_folder_counts(folder: Path, tmp_path_factory: pytest.TempPathFactory) -> None:
    mine = tmp_path_factory.mktemp("mine")
    save_result(made("quick", 0.95), mine)
    assert [place.model for place in boards.leaderboard("toy", [folder, mine]).places] == ["slow", "quick"]


def test_other_protocols_are_refused(folder: Path) -> None:
    save_result(made("odd", 0.5, protocol="xyz"), folder)
    with pytest.raises(InputError, match="do not compare"):
        boards.leaderboard("toy", [folder])


def test_a_board_without_results(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="motioncast evaluate MODEL toy"):
        boards.leaderboard("toy", [tmp_path])


def test_tables_for_papers(folder: Path) -> None:
    board = boards.leaderboard("toy", [folder])
    rows = list(csv.DictReader(io.StringIO(boards.to_csv(board))))
    assert len(rows) == 4
    assert {row["protocol"] for row in rows} == {"abc"}
    latex = boards.to_latex(board)
    assert r"quick & \textbf{100} & \textbf{0.700} \\" in latex
    assert latex.count(r"\\") == 3
    assert "| `quick` | 100 | 0.700 |" in boards.to_markdown(board)
    pytest.importorskip("matplotlib")
    boards.picture(board, folder / "board.svg")
    assert "quick" in (folder / "board.svg").read_text(encoding="utf-8") or (folder / "board.svg").stat().st_size > 5000
