"""Reading files that nobody vouches for, and writing files that are whole or not there at all."""

from __future__ import annotations

import errno
import os
import re
import secrets
import zipfile
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path

import numpy as np

from motioncast.errors import FormatError, InputError, OutputError

MAX_TEXT_BYTES = 1 << 29
"""Largest text file that is read: 512 MiB, hours of motion."""

MAX_NPZ_BYTES = 1 << 30
"""Most bytes that the arrays of one npz file may hold, unpacked: 1 GiB."""

MAX_NPZ_MEMBERS = 1000
"""Most arrays in one npz file."""


@contextmanager
def atomic_write(path: str | Path) -> Iterator[Path]:
    """A temporary path beside ``path``, which takes its place when the block ends well.

    Whatever goes wrong, neither a half-written nor a temporary file stays, and a file that was there before
    is untouched. The temporary name keeps the suffix.

    Raises:
        OutputError: If the folder is missing or not writable, the disk is full, or ``path`` is a folder.

    Example:
        >>> import tempfile
        >>> with tempfile.TemporaryDirectory() as folder:
        ...     with atomic_write(Path(folder) / "note.txt") as temporary:
        ...         _ = temporary.write_text("whole", encoding="utf-8")
        ...     [entry.name for entry in Path(folder).iterdir()]
        ['note.txt']
    """
    path = Path(path)
    if os.path.isdir(path):  # unlike Path.is_dir, false for names that no file can have
        raise OutputError(f"cannot write {path}: it is a folder; give the name of a file")
    if not os.path.isdir(path.parent):
        raise OutputError(f"cannot write {path}: there is no folder {path.parent}; make it first")
    temporary = path.with_name(f".{path.stem[:40]}.{secrets.token_hex(4)}{path.suffix}")
    try:
        yield temporary
        os.replace(temporary, path)
    except OSError as error:
        advice = "free some space or write elsewhere" if error.errno == errno.ENOSPC else "write elsewhere"
        raise OutputError(f"cannot write {path}: {_reason(error)}; {advice}") from None
    finally:
        _remove(temporary)


def _remove(temporary: Path) -> None:
    with suppress(OSError):  # a folder that cannot be written has no temporary file either
        temporary.unlink(missing_ok=True)


def _reason(error: OSError) -> str:
    return "the disk is full" if error.errno == errno.ENOSPC else (error.strerror or str(error)).lower()


def person_paths(path: str | Path, people: Sequence[str]) -> tuple[Path, ...]:
    """Where each person goes in a format of one person a file: ``path``, or with ids in the names if they are several.

    Example:
        >>> [target.name for target in person_paths("out.bvh", ["Ann", "../Bob"])]
        ['out_Ann.bvh', 'out_Bob.bvh']
    """
    path = Path(path)
    if len(people) == 1:
        return (path,)
    targets: list[Path] = []
    for number, person in enumerate(people, 1):
        safe = re.sub(r"[^\w-]+", "_", person).strip("_") or f"person_{number}"
        target = path.with_name(f"{path.stem}_{safe}{path.suffix}")
        taken = {other.name.lower() for other in targets}  # some file systems do not tell a from A
        clash = target.name.lower() in taken
        targets.append(path.with_name(f"{path.stem}_{safe}_{number}{path.suffix}") if clash else target)
    return tuple(targets)


def read_bytes(path: str | Path, limit: int | None = None) -> bytes:
    """The first ``limit`` bytes of a file, or all of them.

    Raises:
        InputError: If there is no such file or it cannot be read.
    """
    path = Path(path)
    if os.path.isdir(path):
        raise InputError(f"{path} is a folder; give a file")
    try:
        with path.open("rb") as file:
            return file.read(-1 if limit is None else limit)
    except FileNotFoundError:
        raise InputError(f"there is no file {path}; check the name") from None
    except OSError as error:
        raise InputError(f"cannot read {path}: {_reason(error)}; check the file and its permissions") from None


def read_text(path: str | Path, limit: int = MAX_TEXT_BYTES) -> str:
    r"""The text of a UTF-8 file with line ends as ``\n``, whatever system wrote it.

    Raises:
        InputError: If there is no such file or it cannot be read.
        FormatError: If it is larger than ``limit`` bytes or is not UTF-8 text.
    """
    content = read_bytes(path, limit + 1)
    if len(content) > limit:
        raise FormatError(path, f"is larger than {limit >> 20} MiB, the most that is read; cut it into parts")
    try:
        text = content.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = content.count(b"\n", 0, error.start) + 1
        raise FormatError(
            path, f"byte 0x{content[error.start]:02x} is not UTF-8 text; save the file as UTF-8", line
        ) from None
    return text.replace("\r\n", "\n").replace("\r", "\n")


def read_npz(path: str | Path) -> dict[str, np.ndarray]:
    """The arrays of an npz file; code inside (pickles) is never run, sizes are checked before reading.

    Raises:
        InputError: If there is no such file or it cannot be read.
        FormatError: If it is not an npz file, is damaged, too large, or holds anything but plain arrays.
    """
    path = Path(path)
    if not read_bytes(path, 4).startswith(b"PK"):
        raise FormatError(path, "is not an npz file (a zip of arrays); expected what numpy.savez writes")
    try:
        with zipfile.ZipFile(path) as archive:
            members = archive.infolist()
            total = sum(member.file_size for member in members)
            if len(members) > MAX_NPZ_MEMBERS or total > MAX_NPZ_BYTES:
                raise FormatError(
                    path,
                    f"unpacks to {len(members)} arrays of {total >> 20} MiB; at most {MAX_NPZ_MEMBERS} arrays "
                    f"of {MAX_NPZ_BYTES >> 20} MiB are read",
                )
            return {member.filename.removesuffix(".npy"): _read_member(archive, member, path) for member in members}
    except FormatError:
        raise
    except Exception as error:  # zipfile and numpy raise a dozen kinds on damaged bytes; all mean one thing
        reason = " ".join(str(error).split())[:80]  # zipfile's can hold whole arrays
        raise FormatError(path, f"is damaged ({reason}); expected an npz file as numpy.savez writes it") from None


def _read_member(archive: zipfile.ZipFile, member: zipfile.ZipInfo, path: Path) -> np.ndarray:
    """One array, read only after its header was found to agree with the size of the member."""
    header = np.lib.format
    with archive.open(member) as file:
        version = header.read_magic(file)
        if version not in ((1, 0), (2, 0)):
            raise FormatError(path, f'the array "{member.filename}" has an unknown layout; expected npy 1.0 or 2.0')
        read_header = header.read_array_header_1_0 if version == (1, 0) else header.read_array_header_2_0
        shape, fortran, dtype = read_header(file)
        if dtype.hasobject:
            raise FormatError(
                path, f'the array "{member.filename}" is a pickle, which could run code; save plain numbers instead'
            )
        count = 1
        for size in shape:  # Python's integers do not wrap around
            count *= int(size)
        if min(shape, default=0) < 0 or file.tell() + count * dtype.itemsize != member.file_size:
            raise FormatError(
                path, f'the array "{member.filename}" claims shape {shape}, which its size belies; save it again'
            )
        array = np.frombuffer(file.read(), dtype, count)
        return array.reshape(shape, order="F" if fortran else "C").copy()
