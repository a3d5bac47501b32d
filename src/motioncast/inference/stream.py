"""A live forecast: a tracker pushes frames, each push answers what comes next."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace

import numpy as np

from motioncast.core.forecast import Forecast
from motioncast.core.scene import Scene
from motioncast.core.skeleton import Skeleton
from motioncast.errors import SceneError


class Stream:
    """The last moments of a tracker's people, and the forecast from them.

    Frames stand on a grid of the tracker's rate. A frame that never comes is a gap, one that comes late fills its
    place if that is still remembered, people who are not seen for the whole memory are forgotten. The numbers are
    those of a batch forecast of the same frames. A push never waits.

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
        number = self._number(time_s)
        warnings: list[str] = []
        if number <= self.now - self.memory:
            self.too_late += 1
            if self.too_late > 1:  # one straggler is late; a second one means that the clock was set back
                warnings.append(f"the clock went back to {time_s} s; the stream starts afresh")
                self._start_afresh()
                number = self._number(time_s)
            else:
                warnings.append(f"the frame of {time_s} s came too late and was left out")
        if number > self.now - self.memory:
            self.too_late = 0
            self._store(number, poses)
        if not self.observed[-1].any():
            return None
        start = max(0, self.memory - self.now - 1)
        positions, observed = self.positions[start:].copy(), self.observed[start:].copy()
        answer = self.answer(Scene(positions, self.skeleton, self.fps, observed, tuple(self.people), source="stream"))
        return replace(answer, warnings=(*answer.warnings, *warnings)) if warnings else answer

    def _start_afresh(self) -> None:
        self.people: list[str] = []
        self.first_s: float | None = None
        self.now, self.too_late = -1, 0
        shape = (self.memory, 0, len(self.skeleton))
        self.positions, self.observed = np.zeros((*shape, 3), np.float32), np.zeros(shape, bool)

    def _number(self, time_s: float | None) -> int:
        """Number of a frame on the grid; the first one is 0."""
        if time_s is None:
            return self.now + 1
        if not np.isfinite(time_s):
            raise SceneError(f"the time stamp is {time_s}; expected seconds")
        if self.first_s is None:
            self.first_s = time_s - (self.now + 1) / self.fps
        return round((time_s - self.first_s) * self.fps)

    def _store(self, number: int, poses: Mapping[str, np.ndarray]) -> None:
        """Remember a frame; a newer one moves the memory on."""
        ahead = number - self.now
        if ahead > 0:
            kept = max(0, self.memory - ahead)
            for array in (self.positions, self.observed):
                array[:kept] = array[self.memory - kept :].copy()
                array[kept:] = 0
            self.now = number
        row = self.memory - 1 - (self.now - number)
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
        remembered = np.flatnonzero(self.observed.any((0, 2)))
        if len(remembered) < len(self.people):
            self.people = [self.people[column] for column in remembered]
            self.positions, self.observed = self.positions[:, remembered], self.observed[:, remembered]
