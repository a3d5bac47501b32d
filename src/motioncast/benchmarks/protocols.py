"""The benchmarks: which windows, which frames, which joints, which figure."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np

from motioncast.benchmarks import open_cmu
from motioncast.core.skeletons import SKELETONS
from motioncast.datasets import ballplay, cmu, somof
from motioncast.datasets.windows import Windows, cut, every
from motioncast.errors import InputError


@dataclass(frozen=True, slots=True)
class Protocol:
    """What makes two figures comparable.

    Attributes:
        name: Name of the benchmark.
        skeleton: Name of the joint set.
        fps: Frames a second.
        history: Frames of history.
        horizon: Frames of future.
        moments: Forecast frames that are scored, from 1.
        summary: Those of the moments whose mean is divided by that of standing still.
        metric: ``mpjpe`` (mm, at a moment) or ``vim`` (cm, at a moment).
        stride: Frames between windows of a take.
        windows: Which windows, in words.
    """

    name: str
    skeleton: str
    fps: float
    history: int
    horizon: int
    moments: tuple[int, ...]
    summary: tuple[int, ...]
    metric: str
    windows: str
    stride: int = 5

    def hash(self, windows: Windows) -> str:
        """A short hash of the protocol and of its windows (positions at 0.1 mm)."""
        digest = hashlib.sha256(json.dumps(asdict(self), sort_keys=True).encode())
        digest.update(np.round(windows.positions * 1e4).astype("<i4").tobytes())
        digest.update(windows.observed.tobytes())
        return digest.hexdigest()[:16]


def _cmu(name: str, windows: str) -> Protocol:
    return Protocol(name, "mrt15", 15.0, 15, 45, (3, 6, 15, 30, 45), (15, 30, 45), "mpjpe", windows)


def _somof(name: str, windows: str, stride: int = 5) -> Protocol:
    moments = (2, 4, 8, 10, 14)  # printed as 100 240 500 640 900 ms; truly 133 267 533 667 933
    return Protocol(name, "somof13", 15.0, 16, 14, moments, moments, "vim", windows, stride)


def _duet(data: Path, protocol: Protocol, split: str) -> Windows:
    skeleton = SKELETONS[protocol.skeleton]
    couples = open_cmu.couple_scenes(data, split, protocol.fps, skeleton)
    return cut(couples, protocol.history, protocol.horizon, protocol.stride)


def _solo(data: Path, protocol: Protocol, split: str) -> Windows:
    skeleton = SKELETONS[protocol.skeleton]
    singles = open_cmu.single_scenes(data, split, protocol.fps, skeleton)
    return cut(singles, protocol.history, protocol.horizon, protocol.stride)


def _crowd(data: Path, protocol: Protocol, split: str) -> Windows:
    skeleton = SKELETONS[protocol.skeleton]
    singles = open_cmu.single_scenes(data, split, protocol.fps, skeleton)
    couples = open_cmu.couple_scenes(data, split, protocol.fps, skeleton)
    return open_cmu.crowd(singles, couples, protocol.history, protocol.horizon)


def _only_test(protocol: Protocol, split: str) -> None:
    if split != "test":
        raise InputError(f"{protocol.name} has test takes only; choose on cmu-duet, cmu-crowd or cmu-solo")


def _ballplay(data: Path, protocol: Protocol, split: str) -> Windows:
    _only_test(protocol, split)
    skeleton = SKELETONS[protocol.skeleton]
    scenes = [every(scene, protocol.fps, skeleton) for scene in ballplay.read(data)]
    return cut(scenes, protocol.history, protocol.horizon, protocol.stride)


def _strangers(data: Path, protocol: Protocol, split: str) -> Windows:
    _only_test(protocol, split)
    skeleton = SKELETONS[protocol.skeleton]
    takes = [take for take in cmu.takes(data) if take.subject in (32, 91)]
    scenes = [every(scene, protocol.fps, skeleton) for scene in cmu.read(takes)]
    return cut(scenes, protocol.history, protocol.horizon, protocol.stride)


def _somof_3dpw(data: Path, protocol: Protocol, split: str) -> Windows:
    return somof.read(data, split)


BENCHMARKS: dict[str, tuple[Protocol, Callable[[Path, Protocol, str], Windows]]] = {
    "cmu-duet": (_cmu("cmu-duet", "the couple's takes, every 5 frames"), _duet),
    "cmu-crowd": (_cmu("cmu-crowd", "400 composed scenes of three, every second one with the couple"), _crowd),
    "cmu-solo": (_cmu("cmu-solo", "takes of single people, every 5 frames"), _solo),
    "somof": (_somof("somof", "SoMoF's windows of 3DPW, from your own copy"), _somof_3dpw),
    "somof-ballplay": (_somof("somof-ballplay", "all clips of the ball players, every 5 frames"), _ballplay),
    "somof-strangers": (_somof("somof-strangers", "CMU's subjects 32 and 91, every 5 frames"), _strangers),
}
"""Benchmarks by name: the protocol, and what builds its windows from a folder of data."""


def windows_of(name: str, data: Path, split: str = "test") -> tuple[Protocol, Windows]:
    """A benchmark's protocol and its windows.

    Raises:
        InputError: If there is no such benchmark, or the folder lacks its data.
    """
    if name not in BENCHMARKS:
        raise InputError(f'there is no benchmark "{name}"; use one of {", ".join(BENCHMARKS)}')
    protocol, builder = BENCHMARKS[name]
    return protocol, builder(data, protocol, split)


def manifest(windows: Windows) -> str:
    """A table of windows: takes, start of the first one, and a checksum of the positions at 0.1 mm.

    Whoever builds the windows from his own copy of the data can tell that they are the same.
    """
    lines = ["window,takes,start,sha256"]
    for index, (take, start) in enumerate(zip(windows.takes, windows.starts, strict=True)):
        tenths_mm = np.round(windows.positions[index] * 1e4).astype("<i4")
        lines.append(f"{index},{take},{start},{hashlib.sha256(tenths_mm.tobytes()).hexdigest()[:16]}")
    return "\n".join(lines) + "\n"
