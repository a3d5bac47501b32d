"""AMASS: optical motion capture of many laboratories as SMPL-H or SMPL-X parameters, z up, metres.

The user's own copy holds ``SUBSET/SUBJECT/TAKE_poses.npz`` (SMPL+H: ``poses`` (frames, 156), ``trans``, ``betas`` (16),
``gender``, ``mocap_framerate``) or ``TAKE_stageii.npz`` (SMPL-X: ``poses`` (frames, 165), ``mocap_frame_rate``), and
beside them the user's body models in a folder ``body_models`` (``bodies.smpl.find``). Scenes have the 22 joints of the
body: few laboratories captured fingers.

The two releases disagree on the frame rate of some 5,000 takes (nghorbani/amass, thread 49); the file's own is taken.
Names and shapes are those of the public readme; no file was at hand to check them against.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np

from motioncast.bodies import smpl
from motioncast.core.scene import Scene
from motioncast.core.skeletons import SMPL22
from motioncast.datasets.catalogue import DataSet, below, metric
from motioncast.errors import FormatError
from motioncast.formats.pickles import read_members

KINDS = {156: "smplh", 165: "smplx", 72: "smpl"}
"""Kind of body model by the width of ``poses``."""

SPLITS: dict[str, tuple[str, ...]] = {
    "train": ("CMU", "MPI_Limits", "PosePrior", "TotalCapture", "Eyes_Japan_Dataset", "KIT", "EKUT", "TCD_handMocap",
              "TCDHands", "ACCAD"),
    "validation": ("HumanEva", "MPI_HDM05", "HDM05", "SFU", "MPI_mosh", "MoSh"),
    "test": ("BioMotionLab_NTroje", "BMLrub"),
}  # fmt: skip
"""Subsets of each split in single-person forecasting (HisRep, siMLPe), under their old and new names."""

_NAMES = ("poses", "trans", "betas", "gender", "mocap_framerate", "mocap_frame_rate")


def takes(folder: str | Path, split: str | None = None) -> list[Path]:
    """The files of a split of single-person forecasting, or of all subsets."""
    found = below(Path(folder), "*_poses.npz", "*_stageii.npz")
    if split is None:
        return found
    return [path for path in found if any(part in SPLITS[split] for part in path.parent.parts)]


def read(path: str | Path) -> Iterator[Scene]:
    """The scene of one file, one person, with rotations.

    Raises:
        InputError: If there is no such file, or no body model of its kind and gender.
        FormatError: If it is damaged or of another layout.
    """
    path = Path(path)
    data = read_members(path, _NAMES)
    rate = number(data.get("mocap_framerate", data.get("mocap_frame_rate")))
    poses, translation = _numbers(path, data, "poses", 2), _numbers(path, data, "trans", 2)
    if rate is None or poses.shape[1] not in KINDS or translation.shape != (len(poses), 3):
        raise FormatError(
            path,
            f"has poses of shape {poses.shape}, trans of shape {translation.shape} and "
            f"{'a' if rate is not None else 'no'} frame rate; expected a take of AMASS",
        )
    body = _model(smpl.models_beside(path), KINDS[poses.shape[1]], text(data.get("gender", "neutral")))
    betas = _numbers(path, data, "betas", 1)
    take = " ".join((*path.parts[-3:-1], path.stem.removesuffix("_poses").removesuffix("_stageii")))
    yield metric(smpl.scene(body, betas, poses[:, : len(SMPL22) * 3], translation, rate, f"AMASS {take}"))


def text(value: Any) -> str:
    """A text that an npz file holds as text, as bytes, or as an array of either.

    Example:
        >>> text(np.array("male")), text(np.array(b"female"))
        ('male', 'female')
    """
    values = np.asarray(value)
    value = values.item() if values.size == 1 else ""
    return value.decode("latin-1") if isinstance(value, bytes) else str(value)


def number(value: Any) -> float | None:
    """A number that an npz file holds as such or as an array of one; None where it is neither.

    Example:
        >>> number(np.array(120.0)), number("fast")
        (120.0, None)
    """
    values = np.asarray(value)
    return float(values.item()) if values.dtype.kind in "fiu" and values.size == 1 else None


def _numbers(path: Path, data: dict[str, Any], name: str, axes: int) -> np.ndarray:
    values = np.asarray(data.get(name))
    if values.dtype.kind != "f" or values.ndim != axes or not np.isfinite(values).all():
        raise FormatError(path, f'has no finite numbers "{name}" of {axes} axes; expected a take of AMASS')
    return values


@lru_cache(maxsize=3)
def _model(folder: Path, kind: str, gender: str) -> smpl.SmplModel:
    return smpl.load(smpl.find(folder, kind, gender))


DATASET = DataSet(
    "amass",
    "AMASS, optical motion capture of 24 laboratories as SMPL-H or SMPL-X parameters; 22 joints",
    "non-commercial research only; the body models have a licence of their own",
    "11,000 takes of 300 people, 40 hours, about 25 GB",
    "amass.is.tue.mpg.de; body models from mano.is.tue.mpg.de (SMPL+H) or smpl-x.is.tue.mpg.de",
    ("*_poses.npz or *_stageii.npz", "body_models/**/*.npz"),
    takes,
    read,
)
