from __future__ import annotations

from pathlib import Path

import pytest

from motioncast.errors import FormatError, InputError, OutputError
from motioncast.formats.moments_tsv import Moment, read_moments, write_moments

HEADER = "take\tperson\tsecond\textent_m\tsource\tnote\n"


def test_moments_come_back_in_order(tmp_path: Path) -> None:
    moments = [Moment("walk", "Ann", 2.5, 0.9), Moment("walk", "Ann", 1.25, 1.1, "rejected", "a step")]
    write_moments(tmp_path / "moments.tsv", moments)
    assert read_moments(tmp_path / "moments.tsv") == sorted(moments)


def test_tabs_and_line_ends_of_a_note_cannot_break_the_table(tmp_path: Path) -> None:
    write_moments(tmp_path / "moments.tsv", [Moment("a", "b", 1, 1, "manual", 'says "so"\tand\nthat\r')])
    assert read_moments(tmp_path / "moments.tsv") == [Moment("a", "b", 1, 1, "manual", 'says "so" and that')]


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("", ":1: is no table of moments"),
        ("take,person\n", ":1: is no table of moments"),
        (HEADER + "a\tb\t1\t1\tauto\n", ":2: has 5 cells; expected 6"),
        (HEADER + "a\tb\t1\t1\tauto\t\na\tb\tsoon\t1\tauto\t\n", ':3: second is "soon"'),
        (HEADER + "a\tb\tnan\t1\tauto\t\n", ':2: second is "nan"'),
        (HEADER + "a\tb\t-1\t1\tauto\t\n", ':2: second is "-1"'),
        (HEADER + "a\tb\t1\tinf\tauto\t\n", ':2: extent_m is "inf"'),
        (HEADER + "a\tb\t1\t1\tguess\t\n", ':2: the source is "guess"; expected one of auto'),
    ],
)
def test_what_is_wrong_is_said_with_its_line(tmp_path: Path, text: str, told: str) -> None:
    path = tmp_path / "moments.tsv"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(FormatError, match=told):
        read_moments(path)


def test_a_missing_table_and_a_missing_folder_are_told(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="there is no file"):
        read_moments(tmp_path / "nowhere.tsv")
    with pytest.raises(OutputError, match="there is no folder"):
        write_moments(tmp_path / "nowhere" / "moments.tsv", [])
