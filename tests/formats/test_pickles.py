from __future__ import annotations

import os
import pickle
import struct
from collections import OrderedDict
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from motioncast.errors import FormatError, InputError
from motioncast.formats import pickles
from motioncast.formats.pickles import read_members, read_pickle


def plain() -> dict[str, Any]:
    rng = np.random.default_rng(0)
    return {
        "sequence": "downtown_arguing_00",
        "numbers": [1, 2.5, None, True, (3, b"raw")],
        "floats": rng.normal(size=(4, 3)).astype(np.float32),
        "fortran": np.asfortranarray(rng.normal(size=(2, 3))),
        "big": np.arange(5, dtype=">i4"),
        "texts": np.array(["m", "f"]),
        "mixed": np.array([np.zeros(2), "m", None], dtype=object),
        "one": np.float64(0.5),
        "empty": np.zeros((0, 3)),
        "ordered": OrderedDict(a=1),
    }


@pytest.mark.parametrize("protocol", range(pickle.HIGHEST_PROTOCOL + 1))
def test_plain_values_come_back(protocol: int, tmp_path: Path) -> None:
    path = tmp_path / "data.pkl"
    path.write_bytes(pickle.dumps(plain(), protocol))
    found, expected = read_pickle(path), plain()
    assert list(found) == list(expected)
    for name in ("floats", "fortran", "big", "texts", "empty"):
        np.testing.assert_array_equal(found[name], expected[name])
        assert found[name].dtype.newbyteorder("=") == expected[name].dtype.newbyteorder("=")
    np.testing.assert_array_equal(found["mixed"][0], np.zeros(2))
    assert found["mixed"][1:].tolist() == ["m", None]
    assert (found["numbers"], found["one"], found["ordered"]) == (expected["numbers"], 0.5, {"a": 1})


def test_arrays_of_python_2(tmp_path: Path) -> None:
    values = np.random.default_rng(1).normal(size=(5, 3))  # its bytes are no UTF-8
    array = (
        b"cnumpy.core.multiarray\n_reconstruct\ncnumpy\nndarray\nK\x00\x85U\x01b\x87R(K\x01K\x05K\x03\x86"
        b"cnumpy\ndtype\nU\x02f8K\x00K\x01\x87R(K\x03U\x01<NNNJ\xff\xff\xff\xffJ\xff\xff\xff\xffK\x00tb\x89T"
        + struct.pack("<i", values.nbytes)
        + values.tobytes()
        + b"tb"
    )
    path = tmp_path / "old.pkl"
    path.write_bytes(b"\x80\x02}q\x00(U\x05posesq\x01]q\x02" + array + b"aU\x01gU\x01mu.")
    found = read_pickle(path)
    np.testing.assert_array_equal(found["poses"][0], values)
    assert found["g"] == "m"


class Bomb:
    def __init__(self, where: Path) -> None:
        self.where = where

    def __reduce__(self) -> tuple[Any, ...]:
        return os.mkdir, (str(self.where),)


@pytest.mark.parametrize("protocol", range(pickle.HIGHEST_PROTOCOL + 1))
def test_a_bomb_does_not_run(protocol: int, tmp_path: Path) -> None:
    path, hole = tmp_path / "bomb.pkl", tmp_path / "hole"
    path.write_bytes(pickle.dumps({"poses": [np.zeros(3), Bomb(hole)]}, protocol))
    with pytest.raises(FormatError, match="could run code"):
        read_pickle(path)
    assert not hole.exists()
    pickle.loads(path.read_bytes())  # it is one
    assert hole.exists()


NASTY = {
    "eval": b"cbuiltins\neval\n(S'1'\ntR.",
    "eval of Python 2": b"c__builtin__\neval\n(S'1'\ntR.",
    "another function of numpy": b"cnumpy\nload\n(S'x'\ntR.",
    "a way round by attributes": b"cnumpy\ndtype.__init__\n.",
    "an instance": b"(S'echo'\nios\nsystem\n.",
    "an object": b"(cnumpy\nndarray\no.",
    "a new object": b"\x80\x02cnumpy\nndarray\n)\x81.",
    "a persistent id": b"P1\n.",
    "an extension": b"\x80\x02\x82\x01.",
    "a huge bytearray": b"\x80\x05\x96\xff\xff\xff\xff\x0f\x00\x00\x00.",
    "a huge text": b"\x80\x04\x8d\xff\xff\xff\xff\x0f\x00\x00\x00.",
    "a huge array": b"cnumpy.core.multiarray\n_reconstruct\n(cnumpy\nndarray\n(I9999999999999\ntS'b'\ntR"
    b"(I1\n(I9999999999999\ntcnumpy\ndtype\n(S'f8'\ntR(I3\nS'<'\nNNNI-1\nI-1\nI0\ntbI00\nS'x'\ntb.",
    "a huge array of objects": b"cnumpy.core.multiarray\n_reconstruct\n(cnumpy\nndarray\n(I0\ntS'b'\ntR"
    b"(I1\n(I2000000000\ntcnumpy\ndtype\n(S'O8'\ntR(I3\nS'|'\nNNNI-1\nI-1\nI63\ntbI00\n(ltb.",
    "a dtype with fields": b"cnumpy\ndtype\n(S'f8'\ntR(I3\nS'|'\nN(S'a'\nt}I8\nI1\nI0\ntb.",
    "a dtype of Python's making": b"cnumpy\ndtype\n(S'datetime64'\ntR.",
    "changing a function": b"cnumpy\ndtype\n(N}S'__call__'\nI1\nstb.",
    "another encoding": b"c_codecs\nencode\n(S'x'\nS'zlib'\ntR.",
    "a string that is called": b"S'x'\n(tR.",
    "nothing": b"",
    "no pickle": b"PK\x03\x04",
}


@pytest.mark.parametrize("content", NASTY.values(), ids=NASTY)
def test_nasty_pickles_are_refused(content: bytes, tmp_path: Path) -> None:
    path = tmp_path / "nasty.pkl"
    path.write_bytes(content)
    with pytest.raises(FormatError) as caught:
        read_pickle(path)
    assert "\n" not in str(caught.value)


def test_a_memo_of_any_size_costs_nothing(tmp_path: Path) -> None:
    path = tmp_path / "memo.pkl"
    path.write_bytes(b"}r\xff\xff\xff\x7f.")  # in C this asks for 32 GB
    assert read_pickle(path) == {}


def test_cut_and_changed_pickles(tmp_path: Path) -> None:
    whole = pickle.dumps(plain(), 2)
    path = tmp_path / "cut.pkl"
    for length in range(0, len(whole) - 1, 37):
        path.write_bytes(whole[:length])
        with pytest.raises(FormatError):
            read_pickle(path)


@given(st.data())
def test_damage_is_an_error_or_plain_values(data: st.DataObject) -> None:
    content = bytearray(pickle.dumps(plain(), 2))
    for _ in range(4):
        content[data.draw(st.integers(0, len(content) - 1))] = data.draw(st.integers(0, 255))
    with suppress(FormatError):
        pickles._loaded(bytes(content), "damaged.pkl")


def test_limits(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "many.pkl"
    path.write_bytes(pickle.dumps([[] for _ in range(100)]))
    monkeypatch.setattr(pickles, "MAX_STEPS", 50)
    with pytest.raises(FormatError, match="50 objects"):
        read_pickle(path)
    monkeypatch.setattr(pickles, "MAX_PICKLE_BYTES", 20)
    with pytest.raises(FormatError, match="larger"):
        read_pickle(path)
    with pytest.raises(InputError, match="no file"):
        read_pickle(tmp_path / "nowhere.pkl")


def test_only_named_members_are_read(tmp_path: Path) -> None:
    path, hole = tmp_path / "data.npz", tmp_path / "hole"
    body = {"params": {"transl": np.ones((2, 3))}, "vtemp": "s1.ply"}
    np.savez(path, poses=np.eye(2), body=np.array(body, object), bomb=np.array([Bomb(hole), 1], object))
    found = read_members(path, ("poses", "body", "absent"))
    assert sorted(found) == ["body", "poses"]
    np.testing.assert_array_equal(found["body"]["params"]["transl"], np.ones((2, 3)))
    with pytest.raises(FormatError, match="could run code"):
        read_members(path)
    assert not hole.exists()


def test_damaged_npz(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "data.npz"
    np.savez(path, poses=np.zeros((100, 3)))
    whole = path.read_bytes()
    path.write_bytes(whole[: len(whole) // 2])
    with pytest.raises(FormatError, match="damaged"):
        read_members(path, ("poses",))
    path.write_bytes(b"no zip")
    with pytest.raises(FormatError, match="not an npz"):
        read_members(path)
    path.write_bytes(whole)
    monkeypatch.setattr(pickles, "MAX_NPZ_BYTES", 100)
    with pytest.raises(FormatError, match="at most"):
        read_members(path)
