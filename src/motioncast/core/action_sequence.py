"""A video as steps: in each, what people do and in which pose they were seen."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from motioncast.core.camera import Camera
from motioncast.core.skeletons import UPPER9
from motioncast.errors import SceneError


@dataclass(frozen=True, slots=True, eq=False)
class ActionSequence:
    """What people do before one camera, step by step; the last step is the last one known.

    Attributes:
        name: Name of the video.
        labels: Every action that may be named.
        actions: What each person does, ``(steps, people)``, indices of ``labels``.
        pixels: In which pose, ``(steps, people, 9, 2)``, joints of ``core.skeletons.UPPER9``; NaN where not seen.
        camera: The camera.
        things: Every thing that may be there.
        objects: Which of them are, ``(things,)`` bool.
        positions: The truth, ``(steps, people, 9, 3)`` metres, world, where it is known: to measure, never to train.

    Raises:
        SceneError: If shapes disagree, there is no step, or an action has no label.
    """

    name: str
    labels: tuple[str, ...]
    actions: np.ndarray
    pixels: np.ndarray
    camera: Camera
    things: tuple[str, ...] = ()
    objects: np.ndarray = None  # pyright: ignore[reportAssignmentType]  # filled on construction
    positions: np.ndarray | None = None

    def __post_init__(self) -> None:
        if self.objects is None:
            object.__setattr__(self, "objects", np.zeros(len(self.things), bool))
        people = (*self.actions.shape, len(UPPER9))
        for name, value, wanted in (
            ("pixels", self.pixels, (*people, 2)),
            ("objects", self.objects, (len(self.things),)),
            ("positions", self.positions, (*people, 3)),
        ):
            if value is not None and value.shape != wanted:
                raise SceneError(f"{self.name}: the {name} have shape {value.shape}; expected {wanted}")
        if self.actions.ndim != 2 or not len(self.actions):
            raise SceneError(f"{self.name}: the actions have shape {self.actions.shape}; expected (steps, people)")
        if self.actions.min() < 0 or self.actions.max() >= len(self.labels):
            raise SceneError(f"{self.name}: an action is none of the {len(self.labels)} labels; expected their indices")

    def __len__(self) -> int:
        return len(self.actions)
