"""Whole files or none; nothing that is read can run code or fill the memory."""

from __future__ import annotations

import errno
import io
import zipfile
from contextlib import suppress

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from motioncast.errors import FormatError, InputError, MotioncastError, OutputError
from motioncast.formats import files
from motioncast.formats.files import atomic_write, person_paths, read_npz, read_text


def test_a_failed_write_leaves_the_old_file_and_nothing_else(tmp_path):
    target = tmp_path / "note.txt"
    target.write_text("old", encoding="utf-8")

    def fail(error):
        with atomic_write(target) as temporary:
            temporary.write_text("half", encoding="utf-8")
            raise error

    with pytest.raises(OutputError, match="the disk is full"):
        fail(OSError(errno.ENOSPC, "No space left on device"))
    with pytest.raises(KeyboardInterrupt):
        fail(KeyboardInterrupt())
    assert [entry.name for entry in tmp_path.iterdir()] == ["note.txt"]
    assert target.read_text(encoding="utf-8") == "old"


def test_where_nothing_can_be_written(tmp_path):
    for target, message in ((tmp_path, "is a folder"), (tmp_path / "no" / "a.txt", "no folder")):
        with pytest.raises(OutputError, match=message), atomic_write(target):
            pass
    with pytest.raises(OutputError, match="cannot write"), atomic_write(tmp_path / ("x" * 300)) as temporary:
        temporary.write_text("x", encoding="utf-8")


def test_text_has_one_kind_of_line_end(tmp_path):
    path = tmp_path / "a.txt"
    path.write_bytes(b"\xef\xbb\xbfa\r\nb\rc\n")
    assert read_text(path) == "a\nb\nc\n"
    path.write_bytes(b"fine\nb\xff")
    with pytest.raises(FormatError, match=r"a.txt:2: byte 0xff"):
        read_text(path)
    with pytest.raises(FormatError, match="larger than"):
        read_text(path, 3)
    with pytest.raises(InputError, match="there is no file"):
        read_text(tmp_path / "b.txt")
    with pytest.raises(InputError, match="is a folder"):
        read_text(tmp_path)


def test_arrays_come_back_in_either_order(tmp_path):
    arrays = {"a": np.arange(6.0).reshape(2, 3), "b": np.asfortranarray(np.arange(6).reshape(2, 3)), "t": np.array("ü")}
    np.savez(tmp_path / "a.npz", **arrays)
    for name, array in read_npz(tmp_path / "a.npz").items():
        np.testing.assert_array_equal(array, arrays[name])


class Bomb:
    def __reduce__(self):
        return exec, ("raise SystemExit('code ran')",)


def test_a_pickle_is_refused(tmp_path):
    np.savez(tmp_path / "a.npz", evil=np.array([Bomb()], object))
    with pytest.raises(FormatError, match="is a pickle"):
        read_npz(tmp_path / "a.npz")


def test_a_lying_header_allocates_nothing(tmp_path):
    header = io.BytesIO()
    np.lib.format.write_array_header_1_0(header, {"descr": "<f8", "fortran_order": False, "shape": (1 << 50,)})
    with zipfile.ZipFile(tmp_path / "a.npz", "w") as archive:
        archive.writestr("a.npy", header.getvalue() + b"\0" * 64)
    with pytest.raises(FormatError, match="belies"):
        read_npz(tmp_path / "a.npz")


def test_a_zip_bomb_is_refused(tmp_path, monkeypatch):
    np.savez_compressed(tmp_path / "a.npz", a=np.zeros(100_000))
    monkeypatch.setattr(files, "MAX_NPZ_BYTES", 1000)
    with pytest.raises(FormatError, match="unpacks to"):
        read_npz(tmp_path / "a.npz")


@given(st.integers(0, 10_000), st.binary(min_size=1, max_size=4), st.booleans())
def test_damage_is_always_a_sentence(tmp_path_factory, place, junk, cut):
    path = tmp_path_factory.mktemp("npz") / "a.npz"
    np.savez(path, a=np.arange(50.0), meta=np.array("text"))
    content = path.read_bytes()
    place %= len(content)
    path.write_bytes(content[:place] if cut else content[:place] + junk + content[place + len(junk) :])
    with suppress(MotioncastError):
        read_npz(path)


def test_ids_stay_in_the_folder(tmp_path):
    targets = person_paths(tmp_path / "out.bvh", ["../up", "a b", "A b", "/"])
    assert {target.parent for target in targets} == {tmp_path}
    assert len({target.name.lower() for target in targets}) == 4
