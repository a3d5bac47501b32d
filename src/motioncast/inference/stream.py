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
        self.people: list[str] = []
        self.first_s: float | None = None
        self.now = -1
        shape = (memory, 0, len(skeleton))
        self.positions, self.observed = np.zeros((*shape, 3), np.float32), np.zeros(shape, bool)

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
        row = self._row(time_s)
        for person, joints in frame.items():
            pose = np.asarray(joints, np.float32)
            if pose.shape != (len(self.skeleton), 3):
                raise SceneError(f'"{person}" came as {pose.shape}; expected ({len(self.skeleton)} joints, 3)')
            if row is None:
                continue
            column = self._column(person)
            seen = np.all(np.isfinite(pose), -1)
            self.positions[row, column] = np.where(seen[:, None], pose, 0)
            self.observed[row, column] = seen
        self._forget()
        if not self.observed[-1].any():
            return None
        start = max(0, self.memory - self.now - 1)
        positions, observed = self.positions[start:].copy(), self.observed[start:].copy()
        answer = self.answer(Scene(positions, self.skeleton, self.fps, observed, tuple(self.people), source="stream"))
        if row is not None:
            return answer
        return replace(answer, warnings=(*answer.warnings, f"the frame of {time_s} s came too late and was left out"))

    def _row(self, time_s: float | None) -> int | None:
        """The remembered row of a frame; newer frames move the memory on, too old ones have none."""
        if time_s is None:
            number = self.now + 1
        elif not np.isfinite(time_s):
            raise SceneError(f"the time stamp is {time_s}; expected seconds")
        else:
            if self.first_s is None:
                self.first_s = time_s - max(self.now, 0) / self.fps
            number = round((time_s - self.first_s) * self.fps)
        ahead = number - self.now
        if ahead > 0:
            kept = max(0, self.memory - ahead)
            for array in (self.positions, self.observed):
                array[:kept] = array[self.memory - kept :].copy()
                array[kept:] = 0
            self.now = number
        row = self.memory - 1 - (self.now - number)
        return row if row >= 0 else None

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
