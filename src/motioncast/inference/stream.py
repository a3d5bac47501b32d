"""A live forecast: a tracker pushes frames, each push answers what comes next."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace

import numpy as np

from motioncast.core.forecast import Forecast
from motioncast.core.scene import Scene
from motioncast.core.skeleton import Skeleton
from motioncast.errors import SceneError

SAME = 1e-4
"""Moments closer than this, in frames, are one: clocks count in floating point."""

APART = 1.99
"""Frames this far apart, in frames, have lost one between them."""


class Stream:
    """The last moments of a tracker's people, and the forecast from them.

    Frames keep their own times; each forecast reads them at the tracker's rate, counted back from the newest one,
    so a clock that jitters costs nothing. A frame that never comes is a gap, one that comes late fills its place if
    that is still remembered, people who are not seen for the whole memory are forgotten. Frames that stand on the
    grid anyway give the numbers of a batch forecast of them. A push never waits.

    Args:
        answer: Forecasts a scene whose history may be short.
        skeleton: Joints of the tracker.
        fps: Frames a second of the tracker.
        memory: Frames that are remembered.
    """

    def __init__(self, answer: Callable[[Scene], Forecast], skeleton: Skeleton, fps: float, memory: int) -> None:
        self.answer, self.skeleton, self.fps, self.memory = answer, skeleton, fps, memory
        self._start_afresh()

    def push(self, frame: Mapping[str, np.ndarray], time_s: float | None = None) -> Forecast | None:
        """Take a frame and forecast from the newest one.

        Args:
            frame: Person id -> joints ``(joints, 3)`` in metres; NaN where a joint is not seen.
            time_s: Time stamp. Default: one frame after the newest.

        Returns:
            The forecast, or None while nobody is seen in the newest frame.

        Raises:
            SceneError: If a person has another number of joints, or the time stamp is not a number.
        """
        poses = {person: np.asarray(joints, np.float32) for person, joints in frame.items()}
        for person, pose in poses.items():
            if pose.shape != (len(self.skeleton), 3):
                raise SceneError(f'"{person}" came as {pose.shape}; expected ({len(self.skeleton)} joints, 3)')
        moment = self._moment(time_s)
        warnings: list[str] = []
        if moment <= self.now - self.memory:
            self.too_late += 1
            if self.too_late > 1:  # one straggler is late; a second one means that the clock was set back
                warnings.append(f"the clock went back to {time_s} s; the stream starts afresh")
                self._start_afresh()
                moment = self._moment(time_s)
            else:
                warnings.append(f"the frame of {time_s} s came too late and was left out")
        if moment > self.now - self.memory:
            self.too_late = 0
            self._store(moment, poses)
        positions, observed = at_moments(self.times, self.positions, self.observed, self._grid())
        if not observed[-1].any():
            return None
        answer = self.answer(Scene(positions, self.skeleton, self.fps, observed, tuple(self.people), source="stream"))
        return replace(answer, warnings=(*answer.warnings, *warnings)) if warnings else answer

    def _start_afresh(self) -> None:
        self.people: list[str] = []
        self.first_s: float | None = None
        self.now, self.too_late = -1.0, 0
        shape = (0, 0, len(self.skeleton))
        self.times = np.zeros(0)
        self.positions, self.observed = np.zeros((*shape, 3), np.float32), np.zeros(shape, bool)

    def _moment(self, time_s: float | None) -> float:
        """Time of a frame in frames of the tracker; the first one is 0."""
        if time_s is None:
            return self.now + 1
        if not np.isfinite(time_s):
            raise SceneError(f"the time stamp is {time_s}; expected seconds")
        if self.first_s is None:
            self.first_s = time_s - (self.now + 1) / self.fps
        return round((time_s - self.first_s) * self.fps, 6)

    def _grid(self) -> np.ndarray:
        """Moments that a forecast reads, the newest frame last."""
        return self.now - np.arange(min(self.memory, int(self.now + SAME) + 1))[::-1]

    def _store(self, moment: float, poses: Mapping[str, np.ndarray]) -> None:
        """Remember a frame; a newer one moves the memory on."""
        self.now = max(self.now, moment)
        kept = self.times > self.now - self.memory - 1  # one more, to read between it and the next
        self.times, self.positions, self.observed = self.times[kept], self.positions[kept], self.observed[kept]
        row = int(np.searchsorted(self.times, moment - SAME))
        if row == len(self.times) or self.times[row] > moment + SAME:
            self.times = np.insert(self.times, row, moment)
            self.positions, self.observed = (np.insert(array, row, 0, 0) for array in (self.positions, self.observed))
        for person, pose in poses.items():
            column = self._column(person)
            seen = np.all(np.isfinite(pose), -1)
            self.positions[row, column] = np.where(seen[:, None], pose, 0)
            self.observed[row, column] = seen
        self._forget()

    def _column(self, person: str) -> int:
        if person not in self.people:
            self.people.append(person)
            self.positions = np.pad(self.positions, ((0, 0), (0, 1), (0, 0), (0, 0)))
            self.observed = np.pad(self.observed, ((0, 0), (0, 1), (0, 0)))
        return self.people.index(person)

    def _forget(self) -> None:
        recent = self.observed[self.times > self.now - self.memory + SAME]
        remembered = np.flatnonzero(recent.any((0, 2)))
        if len(remembered) < len(self.people):
            self.people = [self.people[column] for column in remembered]
            self.positions, self.observed = self.positions[:, remembered], self.observed[:, remembered]


def at_moments(
    times: np.ndarray, positions: np.ndarray, observed: np.ndarray, moments: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Frames of any times, read at the moments of a grid.

    A joint lies on the straight line between the frames before and after in which its person was seen, if they are
    less than two frames apart; else it is where the nearest of them shows it, if that is within half a frame.

    Args:
        times: Times of the frames in frames of the grid, ``(n,)``, rising.
        positions: ``(n, people, joints, 3)``.
        observed: ``(n, people, joints)`` bool.
        moments: ``(time,)``, rising.

    Returns:
        Positions and mask, ``(time, people, joints, 3)`` and ``(time, people, joints)``.

    Example:
        >>> places = np.array([0.0, 1.0, 4.0], np.float32).reshape(3, 1, 1, 1) * np.ones(3, np.float32)
        >>> read, seen = at_moments(np.array([0.0, 1.5, 4.0]), places, np.ones((3, 1, 1), bool), np.arange(5) * 1.0)
        >>> seen[:, 0, 0].tolist(), round(float(read[1, 0, 0, 0]), 3)
        ([True, True, True, False, True], 0.667)
    """
    frames, rows = len(times), np.arange(len(times))[:, None]
    present = observed.any(-1)
    before = np.maximum.accumulate(np.where(present, rows, -1))
    after = np.minimum.accumulate(np.where(present, rows, frames)[::-1])[::-1]
    # a row of nobody before the first frame, and one after the last
    before = np.pad(before, ((1, 0), (0, 0)), constant_values=-1)
    after = np.pad(after, ((0, 1), (0, 0)), constant_values=frames)
    before = before[np.searchsorted(times, moments + SAME, "right")]
    after = after[np.searchsorted(times, moments - SAME)]
    clock = np.concatenate([times, [np.inf, -np.inf]])  # frames: never after, -1: never before
    since, until = (np.maximum(gap, 0) for gap in (moments[:, None] - clock[before], clock[after] - moments[:, None]))
    nearest = np.where(since <= until, before, after).clip(0, frames - 1)
    near = np.minimum(since, until) <= 0.5
    before, after = before.clip(0, frames - 1), after.clip(0, frames - 1)
    people = np.arange(observed.shape[1])
    close = since + until < APART
    both = close[..., None] & observed[before, people] & observed[after, people]
    share = np.where(close, since, 0) / np.where(close, np.maximum(since + until, SAME), 1)
    share = share[..., None, None].astype(np.float32)
    start = positions[before, people]
    between = start + (positions[after, people] - start) * share
    seen = both | (near[..., None] & observed[nearest, people])
    return np.where(both[..., None], between, positions[nearest, people]), seen
