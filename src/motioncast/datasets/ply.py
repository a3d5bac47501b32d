"""The vertices of a PLY mesh, as body data sets store people's bodies: text or little-endian, x y z first or not."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from motioncast.errors import FormatError
from motioncast.formats.files import read_bytes

_TYPES = {
    "char": "i1", "uchar": "u1", "short": "<i2", "ushort": "<u2", "int": "<i4", "uint": "<u4", "float": "<f4",
    "double": "<f8", "int8": "i1", "uint8": "u1", "int16": "<i2", "uint16": "<u2", "int32": "<i4", "uint32": "<u4",
    "float32": "<f4", "float64": "<f8",
}  # fmt: skip

MAX_BYTES = 1 << 28


def read_vertices(path: str | Path) -> np.ndarray:
    """Positions of the vertices, ``(vertices, 3)`` float32, in the file's unit.

    Raises:
        InputError: If there is no such file or it cannot be read.
        FormatError: If it is no PLY file, is damaged, larger than ``MAX_BYTES``, or its vertices do not come first.
    """
    content = read_bytes(path, MAX_BYTES + 1)
    head, end, body = content.partition(b"end_header\n")
    lines = [line.split() for line in head.decode("latin-1").split("\n")]
    kind = next((line[1] for line in lines if len(line) > 1 and line[0] == "format"), "")
    elements = [number for number, line in enumerate(lines) if line[:1] == ["element"]]
    if not content.startswith(b"ply") or not end or len(content) > MAX_BYTES or not elements:
        raise FormatError(path, "is no PLY mesh of at most 256 MiB; get the file again")
    last = elements[1] if len(elements) > 1 else len(lines)
    properties = [line for line in lines[elements[0] + 1 : last] if line[:1] == ["property"]]
    try:
        _, name, number = lines[elements[0]]
        columns = np.dtype([(line[2], _TYPES[line[1]]) for line in properties])
        count = int(number)
        if name != "vertex" or not 0 < count <= len(body):
            raise ValueError("its vertices do not come first")
        if kind == "binary_little_endian":
            rows = np.frombuffer(body, columns, count)
        elif kind == "ascii":
            table = np.array([line.split()[: len(properties)] for line in body.split(b"\n")[:count]], np.float64)
            rows = {axis: table[:, list(columns.names or ()).index(axis)] for axis in "xyz"}
        else:
            raise ValueError(f'the kind "{kind}" is not read')
        vertices = np.stack([np.asarray(rows[axis], np.float32) for axis in "xyz"], -1)
    except (ValueError, KeyError, IndexError) as error:
        raise FormatError(path, f"is not a whole PLY mesh ({str(error)[:60]}); get the file again") from None
    if len(vertices) != count or not np.isfinite(vertices).all():
        raise FormatError(path, f"holds {len(vertices)} finite vertices; its header names {count}")
    return vertices
