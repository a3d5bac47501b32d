"""Scenes from named points in space, for the formats that know no skeleton: CSV, TRC, C3D."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from motioncast.core.scene import Scene
from motioncast.core.skeletons import grow
from motioncast.errors import SkeletonError
from motioncast.formats import units


def scene_of_points(
    path: str | Path,
    names: Sequence[str],
    people: Sequence[str],
    points: np.ndarray,
    fps: float,
    *,
    up: str | None,
    unit: str | None,
    usual_up: str,
    named: Mapping[str, str] | None,
) -> Scene:
    """A scene in metres with z up; bones join the points that mark neighbouring places of the body.

    Args:
        path: The file that the points come from.
        names: Names of the points.
        people: One id a person.
        points: ``(time, people, points, 3)`` in the axes and unit of the file; NaN where not observed.
        fps: Frames a second.
        up: Up axis where stated or given; else inferred.
        unit: Unit where stated or given; else inferred.
        usual_up: Up axis that the format usually has.
        named: Landmarks by name of the point, over the recognised ones.

    Raises:
        SkeletonError: If a name comes twice.
        SceneError: If no unit makes a person of the bodies.
    """
    for number, name in enumerate(names):
        if name in names[:number]:
            raise SkeletonError(f'{path}: the point "{name}" comes twice; names must be unique')
    skeleton = grow(names, Path(path).suffix.removeprefix("."), named)
    points = points[:, :, [list(names).index(name) for name in skeleton.names]]
    observed = np.all(np.isfinite(points), -1)
    points = np.where(observed[..., None], points, 0.0)
    world = units.settle(path, points, observed, skeleton, up=up, unit=unit, usual_up=usual_up)
    return Scene(world.points(points), skeleton, fps, observed, tuple(people), source=str(path), remarks=world.remarks)
