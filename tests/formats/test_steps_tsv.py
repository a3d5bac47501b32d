"""Tables of steps."""

from __future__ import annotations

import pytest

from motioncast.errors import FormatError, InputError
from motioncast.formats.steps_tsv import Span, read_steps


def table(tmp_path, text):
    path = tmp_path / "steps.tsv"
    path.write_text(text, encoding="utf-8")
    return path


def test_columns_may_be_left_out_and_stand_in_any_order(tmp_path):
    path = table(tmp_path, "action\tend\tfirst\nwash\t9\t4\ntake it\t4\t0\n")
    assert read_steps(path) == [Span(0, 4, "take it"), Span(4, 9, "wash")]
    path = table(tmp_path, "first\tend\taction\tperson\tcharacteristic\n0\t4\ttake\t1\t3\n4\t9\twash\t\t\n")
    assert read_steps(path) == [Span(0, 4, "take", 1, 3), Span(4, 9, "wash")]


@pytest.mark.parametrize("line", ["4\t4\twash", "a\t4\twash", "0\t4\t", "0\t4", "-1\t4\twash"])
def test_a_damaged_line_is_named(tmp_path, line):
    with pytest.raises(FormatError, match=":2:"):
        read_steps(table(tmp_path, f"first\tend\taction\n{line}\n"))


def test_a_frame_outside_its_step_no_steps_no_columns_no_file(tmp_path):
    with pytest.raises(FormatError, match="characteristic frame between"):
        read_steps(table(tmp_path, "first\tend\taction\tcharacteristic\n0\t4\twash\t4\n"))
    with pytest.raises(InputError, match="holds no step"):
        read_steps(table(tmp_path, "first\tend\taction\n"))
    with pytest.raises(FormatError, match="columns"):
        read_steps(table(tmp_path, "first,end,action\n"))
    with pytest.raises(InputError, match="no file"):
        read_steps(tmp_path / "none.tsv")
