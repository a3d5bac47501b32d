"""Plain values out of pickles that nobody vouches for: arrays, numbers, texts and containers, nothing that runs.

A pickle is a program; reading one in the usual way lets its author do what he likes. Here only the
few functions that numpy uses to pickle arrays are known, each in a stand-in of our own that makes nothing larger than
the file it came from. Every other name a pickle asks for is refused, and so is every instruction that data do not need.
Pickles of Python 2 are read with their texts as Latin-1, as numpy's arrays in them need.
"""

from __future__ import annotations

import io
import math
import pickle
import re
import struct
import zipfile
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, ClassVar

import numpy as np

from motioncast.errors import FormatError
from motioncast.formats.files import MAX_NPZ_BYTES, _read_member, read_bytes

MAX_PICKLE_BYTES = 1 << 29
"""Largest pickle that is read: 512 MiB."""

MAX_STEPS = 2_000_000
"""Most instructions of one pickle: each makes one object at most, and arrays take one for all their numbers."""

HOW_TO_CONVERT = "open it where you trust it and save its numbers by numpy.savez"


def read_pickle(path: str | Path) -> Any:
    """What a pickle holds, if that is nothing but arrays, numbers, texts and containers of them.

    Raises:
        InputError: If there is no such file or it cannot be read.
        FormatError: If it is damaged, larger than ``MAX_PICKLE_BYTES``, or asks for anything else.
    """
    content = read_bytes(path, MAX_PICKLE_BYTES + 1)
    if len(content) > MAX_PICKLE_BYTES:
        raise FormatError(path, f"is larger than {MAX_PICKLE_BYTES >> 20} MiB, the most that is read of a pickle")
    return _loaded(content, path)


def read_members(path: str | Path, names: Sequence[str] | None = None) -> dict[str, Any]:
    """The named arrays of an npz file, those that are there; pickled ones as the plain values that they hold.

    Only what is asked for is read, so that files may hold other things (code, too) beside it.

    Args:
        path: The file.
        names: Names of arrays. Default: all.

    Raises:
        InputError: If there is no such file or it cannot be read.
        FormatError: If it is not an npz file, is damaged, too large, or a named array is a pickle that asks for more
            than plain values.
    """
    if not read_bytes(path, 4).startswith(b"PK"):
        raise FormatError(path, "is not an npz file (a zip of arrays); expected what numpy.savez writes")
    try:
        with zipfile.ZipFile(path) as archive:
            members = {member.filename.removesuffix(".npy"): member for member in archive.infolist()}
            wanted = {name: member for name, member in members.items() if names is None or name in names}
            total = sum(member.file_size for member in wanted.values())
            if total > MAX_NPZ_BYTES:
                raise FormatError(path, f"unpacks to {total >> 20} MiB; at most {MAX_NPZ_BYTES >> 20} MiB are read")
            return {name: _member(archive, member, Path(path)) for name, member in wanted.items()}
    except FormatError:
        raise
    except Exception as error:  # zipfile and numpy raise a dozen kinds on damaged bytes; all mean one thing
        reason = " ".join(str(error).split())[:80]
        raise FormatError(path, f"is damaged ({reason}); expected an npz file as numpy.savez writes it") from None


def _member(archive: zipfile.ZipFile, member: zipfile.ZipInfo, path: Path) -> Any:
    with archive.open(member) as file:
        version = np.lib.format.read_magic(file)
        reader = np.lib.format.read_array_header_1_0 if version == (1, 0) else np.lib.format.read_array_header_2_0
        shape, _, dtype = reader(file)
        if not dtype.hasobject:
            return _read_member(archive, member, path)
        values = _loaded(file.read(), f"{path}/{member.filename}")
    if not isinstance(values, np.ndarray) or values.shape != tuple(shape):
        raise FormatError(path, f'the array "{member.filename}" is not what its header says; get the file again')
    return values.item() if values.shape == () else values


def _loaded(content: bytes, path: str | Path) -> Any:
    try:
        return _PlainUnpickler(content, path).load()
    except FormatError:
        raise
    except Exception as error:  # a damaged pickle can fail anywhere in the machine
        reason = f"{type(error).__name__}: {error}".replace("\n", " ")[:80]
        raise FormatError(path, f"is a damaged pickle or none at all ({reason}); get the file again") from None


def _counted(step: Callable[[Any], None]) -> Callable[[Any], None]:
    def counted(machine: _PlainUnpickler) -> None:
        machine.steps += 1
        if machine.steps > MAX_STEPS:
            raise FormatError(machine.path, f"is a pickle of more than {MAX_STEPS:,} objects; {HOW_TO_CONVERT}")
        step(machine)

    return counted


def _bytearray(machine: Any) -> None:
    """Takes the bytes before it makes room for them, unlike the step that it replaces."""
    (size,) = struct.unpack("<Q", machine.read(8))
    data = machine.read(min(size, MAX_PICKLE_BYTES))
    if len(data) != size:
        raise EOFError("bytes are missing")
    machine.append(bytearray(data))


class _PlainUnpickler(pickle._Unpickler):
    """The machine of the standard library in Python, whose memory grows with what is stored.

    (The one in C lets a pickle of ten bytes claim a table of any size.) Instructions that make instances, reach out
    of the file or allocate by a number in it are taken out.
    """

    dispatch: ClassVar[dict[int, Callable[[Any], None]]] = {
        code: _counted(step)
        for code, step in pickle._Unpickler.dispatch.items()
        if bytes([code])
        not in (
            pickle.INST, pickle.OBJ, pickle.NEWOBJ, pickle.NEWOBJ_EX, pickle.PERSID, pickle.BINPERSID, pickle.EXT1,
            pickle.EXT2, pickle.EXT4, pickle.NEXT_BUFFER, pickle.READONLY_BUFFER,
        )
    } | {pickle.BYTEARRAY8[0]: _counted(_bytearray)}  # fmt: skip

    def __init__(self, content: bytes, path: str | Path) -> None:
        super().__init__(io.BytesIO(content), encoding="latin1")
        self.path = path
        self.steps = 0

    def find_class(self, module: str, name: str) -> Any:  # the base class would import whatever is named
        if module in ("numpy.core.multiarray", "numpy._core.multiarray", "numpy"):
            module = "numpy"
        if module in ("numpy.core.numeric", "numpy._core.numeric"):
            module = "numpy.numeric"
        if (module, name) in _KNOWN:
            return _KNOWN[module, name]
        raise FormatError(
            self.path, f'asks for "{module}.{name}", which could run code; {HOW_TO_CONVERT}'.replace("\n", " ")
        )


class _StandIn:
    """A function that a pickle may call; it has no attributes that a pickle could set."""

    __slots__ = ("_function",)

    def __init__(self, function: Callable[..., Any]) -> None:
        object.__setattr__(self, "_function", function)

    def __call__(self, *arguments: Any) -> Any:
        return self._function(*arguments)

    def __setattr__(self, name: str, value: object) -> None:
        raise AttributeError(name)


class _Type:
    """The dtype of a pickled array: a letter and a size, the byte order comes with the state."""

    __slots__ = ("dtype",)

    def __init__(self, code: str) -> None:
        if not re.fullmatch(r"[<>|=]?(O8?|O4|[biufcSU?]\d{0,9})", code):
            raise ValueError(f"dtype {code[:20]}")
        self.dtype = np.dtype("O" if "O" in code else code)

    def __setstate__(self, state: tuple[Any, ...]) -> None:
        if state[1] not in ("<", ">", "|", "=") or any(part is not None for part in state[2:5]):
            raise ValueError("a dtype with fields")
        if state[1] in "<>":
            self.dtype = self.dtype.newbyteorder(state[1])


class _Array(np.ndarray):
    """An array that takes its state only where the bytes that came with it fill its shape."""

    def __setstate__(self, state: tuple[Any, ...]) -> None:  # pyright: ignore[reportIncompatibleMethodOverride]
        version, shape, kind, fortran, data = state
        _check_size(shape, kind, data)
        super().__setstate__((version, shape, kind.dtype, fortran, data))


def _check_size(shape: tuple[int, ...], kind: _Type, data: Any) -> None:
    if not all(type(size) is int and size >= 0 for size in shape) or len(shape) > 16:
        raise ValueError("the shape of an array")
    if kind.dtype.hasobject != isinstance(data, list):
        raise ValueError("the elements of an array")
    if len(data) != math.prod(shape) * (1 if kind.dtype.hasobject else kind.dtype.itemsize):
        raise ValueError(f"an array of shape {shape} with {len(data)} bytes")


def _bytes(data: bytes | str) -> bytes:
    return data.encode("latin1") if isinstance(data, str) else data


def _scalar(kind: _Type, data: bytes | str) -> Any:
    _check_size((), kind, data)
    return np.frombuffer(_bytes(data), kind.dtype)[0]


def _from_buffer(data: bytes, kind: _Type, shape: tuple[int, ...], order: str) -> np.ndarray:
    _check_size(shape, kind, data)
    return np.frombuffer(data, kind.dtype).reshape(shape, order="F" if order == "F" else "C")


def _encode(text: str, encoding: str) -> bytes:
    if encoding not in ("latin1", "latin-1"):
        raise ValueError(f"the encoding {encoding[:20]}")
    return text.encode("latin1")


_KNOWN: dict[tuple[str, str], _StandIn] = {
    ("numpy", "_reconstruct"): _StandIn(lambda *_: np.ndarray.__new__(_Array, (0,), np.int8)),
    ("numpy", "ndarray"): _StandIn(lambda *_: None),  # only ever an argument of the one above
    ("numpy", "dtype"): _StandIn(lambda code, *_: _Type(code)),
    ("numpy", "scalar"): _StandIn(_scalar),
    ("numpy.numeric", "_frombuffer"): _StandIn(_from_buffer),
    ("_codecs", "encode"): _StandIn(_encode),
    # Python 3 writes no bytes so in pickles for Python 2; with a number this would make room for as many
    ("__builtin__", "bytes"): _StandIn(lambda: b""),
    ("collections", "OrderedDict"): _StandIn(lambda pairs=(): dict(pairs)),
}
