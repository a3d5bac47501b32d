"""The benchmarks: which windows, which frames, which joints, which figure."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

from motioncast.benchmarks import open_cmu
from motioncast.benchmarks.conditions import CONDITIONS, worsened
from motioncast.benchmarks.protocol import Protocol
from motioncast.core.skeletons import SKELETONS
from motioncast.datasets import ballplay, cmu, somof
from motioncast.datasets.windows import Windows, cut, every
from motioncast.errors import InputError

Builder = Callable[[Path, Protocol, str], Windows]
"""Builds the windows of a protocol's split from a folder of data."""


def _duet(data: Path, protocol: Protocol, split: str) -> Windows:
    skeleton = SKELETONS[protocol.skeleton]
    couples = open_cmu.couple_scenes(data, split, protocol.fps, skeleton)
    return cut(couples, protocol.history, protocol.horizon, protocol.stride)


def _single(data: Path, protocol: Protocol, split: str) -> Windows:
    skeleton = SKELETONS[protocol.skeleton]
    singles = open_cmu.single_scenes(data, split, protocol.fps, skeleton)
    return cut(singles, protocol.history, protocol.horizon, protocol.stride)


def _solo(data: Path, protocol: Protocol, split: str) -> Windows:
    # 5 frames at 25 a second are 12 captured ones at 60: "now" falls on a captured frame, and the history is free of
    # what comes later
    skeleton = SKELETONS[protocol.skeleton]
    singles = open_cmu.single_scenes(data, split, protocol.fps, skeleton)
    return cut(singles, protocol.history, protocol.horizon, protocol.stride, first=(1 - protocol.history) % 5)


def _crowd(data: Path, protocol: Protocol, split: str) -> Windows:
    skeleton = SKELETONS[protocol.skeleton]
    singles = open_cmu.single_scenes(data, split, protocol.fps, skeleton)
    couples = open_cmu.couple_scenes(data, split, protocol.fps, skeleton)
    return open_cmu.crowd(singles, couples, protocol.history, protocol.horizon)


def _only_test(protocol: Protocol, split: str) -> None:
    if split != "test":
        raise InputError(f"{protocol.name} has test takes only; choose on cmu-duet, cmu-crowd or cmu-single")


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


def _cmu(name: str, windows: str) -> Protocol:
    return Protocol(name, "mrt15", 15.0, 15, 45, (3, 6, 15, 30, 45), (15, 30, 45), "mpjpe", windows)


def _somof(name: str, windows: str) -> Protocol:
    moments = (2, 4, 8, 10, 14)
    return Protocol(name, "somof13", 15.0, 16, 14, moments, moments, "vim", windows)


_SECOND = (2, 4, 8, 10, 14, 25)
"""80, 160, 320, 400, 560 and 1000 ms at 25 frames a second, as single people are scored everywhere."""

_SOLO = "takes of single people, every 5 frames"

_CLEAN: list[tuple[Protocol, Builder]] = [
    (_cmu("cmu-duet", "the couple's takes, every 5 frames"), _duet),
    (_cmu("cmu-crowd", "400 composed scenes of three, every second one with the couple"), _crowd),
    (_cmu("cmu-single", _SOLO), _single),
    (Protocol("cmu-solo", "mrt15", 25.0, 25, 25, _SECOND, _SECOND, "mpjpe", _SOLO), _solo),
    (Protocol("cmu-solo-4s", "mrt15", 25.0, 25, 100, (25, 50, 75, 100), (25, 50, 75, 100), "mpjpe", _SOLO), _solo),
    (_somof("somof", "SoMoF's windows of 3DPW, from your own copy"), _somof_3dpw),
    (_somof("somof-ballplay", "all clips of the ball players, every 5 frames"), _ballplay),
    (_somof("somof-strangers", "CMU's subjects 32 and 91, every 5 frames"), _strangers),
]

TRACKED = ("cmu-duet", "cmu-crowd", "cmu-solo")
"""Benchmarks that are also run as a tracker would see them."""


def _all() -> dict[str, tuple[Protocol, Builder]]:
    found = {protocol.name: (protocol, builder) for protocol, builder in _CLEAN}
    for name in TRACKED:
        protocol, builder = found[name]
        for condition in CONDITIONS:
            worse = replace(protocol, name=f"{name}-{condition}", condition=condition)
            found[worse.name] = (worse, builder)
    return found


BENCHMARKS: dict[str, tuple[Protocol, Builder]] = _all()
"""Benchmarks by name: the protocol, and what builds its windows from a folder of data."""


def windows_of(name: str, data: Path, split: str = "test") -> tuple[Protocol, Windows]:
    """A benchmark's protocol and its windows.

    Raises:
        InputError: If there is no such benchmark, or the folder lacks its data.
    """
    if name not in BENCHMARKS:
        raise InputError(f'there is no benchmark "{name}"; use one of {", ".join(BENCHMARKS)}')
    protocol, builder = BENCHMARKS[name]
    windows = builder(data, protocol, split)
    if protocol.condition in CONDITIONS:
        windows = worsened(windows, protocol.condition, protocol.seed)
    return protocol, windows
