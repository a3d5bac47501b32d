"""Scenes of several people in one npy file, as MRT's tools write them and later papers pass them around.

``(scenes, people, frames, 45)``: 15 joints in the order of ``MRT15``, y up. Nothing in such a file names its unit or
its frame rate; each data set of this layout states them, and the limbs' lengths are checked (``catalogue.metric``).
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np

from motioncast.core.scene import Scene
from motioncast.core.skeleton import Skeleton
from motioncast.core.skeletons import MRT15
from motioncast.datasets.catalogue import metric
from motioncast.datasets.windows import Windows
from motioncast.errors import FormatError, InputError
from motioncast.formats.files import read_bytes


def stored(path: str | Path) -> np.ndarray:
    """The numbers of a file where they lie on the disk, ``(scenes, people, frames, 45)`` in its own unit and axes.

    Raises:
        InputError: If there is no such file.
        FormatError: If it is no npy file of this layout, is cut short, or is a pickle.
    """
    read_bytes(path, 1)
    try:
        values = np.lib.format.open_memmap(path, mode="r")  # what is pickled cannot be mapped and is refused
    except Exception as error:  # numpy raises several kinds on damaged or pickled files
        reason = " ".join(str(error).split())[:80]
        raise FormatError(path, f"is no whole npy file of numbers ({reason}); get the file again") from None
    joints = len(MRT15)
    if values.dtype.kind != "f" or values.ndim != 4 or values.shape[-1] != joints * 3 or 0 in values.shape:
        raise FormatError(
            path,
            f"holds {values.dtype} of shape {values.shape}; expected floats (scenes, people, frames, {joints * 3})",
        )
    return values


def upright(values: np.ndarray, unit_m: float) -> np.ndarray:
    """Metres with z up from a file's numbers with y up: ``(..., frames, people, joints, 3)``, people after frames.

    Example:
        >>> upright(np.arange(45.0).reshape(1, 1, 45), 1.0)[0, 0, 1]
        array([ 3., -5.,  4.])
    """
    x, y, z = np.moveaxis(values.reshape(*values.shape[:-1], -1, 3), -1, 0)
    return (np.stack([x, -z, y], -1) * unit_m).swapaxes(-4, -3)


def scenes(
    path: str | Path, unit_m: float, fps: float, skeleton: Skeleton = MRT15, remark: str = ""
) -> Iterator[Scene]:
    """The scenes of a file, one after another.

    Args:
        path: The file.
        unit_m: Metres per unit of the file.
        fps: Frames a second.
        skeleton: Which joints.
        remark: What was inferred.

    Raises:
        InputError: If there is no such file, or its limbs are no people's.
        FormatError: If it is of another layout or damaged.
    """
    values = stored(path)
    digits = len(str(len(values) - 1))
    for number, scene in enumerate(values):
        source = f"{Path(path).stem} {number:0{digits}d}"
        positions = upright(np.asarray(scene), unit_m)
        if not np.isfinite(positions).all():
            raise FormatError(path, f"scene {number} holds numbers that are not finite; get the file again")
        yield metric(Scene(positions, skeleton, fps, source=source, remarks=(remark,) if remark else ()))


def windows(path: str | Path, unit_m: float, step: int, history: int) -> Windows:
    """The scenes of a file as windows: every ``step``-th frame of each, so many of them history.

    Raises:
        InputError: If there is no such file, its scenes are too short, or its limbs are no people's.
        FormatError: If it is of another layout or damaged.
    """
    values = stored(path)[:, :, ::step]
    if values.shape[2] <= history:
        raise InputError(f"{path} has scenes of {values.shape[2]} frames; expected more than {history}")
    count, people, frames, _ = values.shape
    positions = np.empty((count, frames, people, len(MRT15), 3), np.float32)
    for number, scene in enumerate(values):  # one after another: the file is as large as the answer
        positions[number] = upright(scene, unit_m)
    if not np.isfinite(positions).all():
        raise FormatError(path, "holds numbers that are not finite; get the file again")
    for number in range(0, len(positions), max(1, len(positions) // 20)):  # the unit is one for the whole file
        metric(Scene(positions[number], MRT15, 1.0, source=f"{Path(path).stem} {number}"))
    takes = tuple(f"{Path(path).stem} {number}" for number in range(len(positions)))
    return Windows(positions, np.ones(positions.shape[:-1], bool), takes, ((0,),) * len(positions), history)
