"""Videos of the user's own: poses of a detector and a table of steps, to what a model of steps reads."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from motioncast.core.action_sequence import ActionSequence
from motioncast.core.camera import Camera, look_at
from motioncast.core.scene import Scene
from motioncast.core.skeletons import UPPER9
from motioncast.core.upper_body import most_articulated
from motioncast.errors import FormatError, InputError, SceneError
from motioncast.formats.files import read_text
from motioncast.formats.steps_tsv import Span

VIEWED_FROM_M = 3.5
"""How far ahead of people the virtual camera of a scene stands."""


def steps_of(
    name: str, pixels: np.ndarray, spans: Sequence[Span], camera: Camera, objects: Sequence[str] = ()
) -> ActionSequence:
    """A video as steps.

    People act side by side: the n-th step of each is one step.

    Args:
        name: Name of the video.
        pixels: Poses, ``(frames, people, 9, 2)``; NaN where not seen.
        spans: Its steps.
        camera: Its camera.
        objects: Names of the things that are there.

    Raises:
        SceneError: If a step lies outside the video, people have unequal numbers of steps, or a pose is not seen.
    """
    people = pixels.shape[1]
    rows: list[list[Span]] = [[span for span in spans if span.person == person] for person in range(people)]
    if len({len(row) for row in rows}) != 1 or sum(map(len, rows)) != len(spans):
        told = ", ".join(str(len(row)) for row in rows)
        raise SceneError(
            f"{name}: {len(spans)} steps came, {told} of the {people} people followed; expected as many of each"
        )
    labels = tuple(sorted({span.action for span in spans}))
    actions = np.array([[labels.index(span.action) for span in row] for row in rows]).T
    poses = [[pixels[_frame(name, pixels, span), span.person] for span in row] for row in rows]
    things = tuple(dict.fromkeys(objects))
    return ActionSequence(
        name, labels, actions, np.array(poses).swapaxes(0, 1), camera, things, np.ones(len(things), bool)
    )


def _frame(name: str, pixels: np.ndarray, span: Span) -> int:
    """The frame of the pose of a step."""
    if span.end > len(pixels):
        raise SceneError(f"{name}: a step ends at frame {span.end} of {len(pixels)}; expected an end within the video")
    if span.characteristic is not None:
        return span.characteristic
    return most_articulated(pixels[:, span.person], span.first, span.end)


def steps_of_scene(
    scene: Scene, spans: Sequence[Span], objects: Sequence[str] = (), camera: Camera | None = None
) -> ActionSequence:
    """A scene as a camera sees it; nothing of its 3D is handed on.

    Args:
        scene: The motion.
        spans: Its steps.
        objects: Names of the things that are there.
        camera: The camera. Default: one 3.5 m ahead of where people stand and face at first, at the height of heads.

    Raises:
        SkeletonError: If the skeleton lacks a joint of the upper body.
        SceneError: As of :func:`steps_of`.
    """
    body = scene.on(UPPER9)
    positions = np.where(body.observed[..., None], body.positions, np.nan).astype(np.float64)
    camera = virtual_camera(positions) if camera is None else camera
    pixels = camera.project(positions)
    return steps_of(scene.source or "scene", pixels, spans, camera, objects)


def virtual_camera(positions: np.ndarray) -> Camera:
    """A camera ahead of people ``(frames, people, 9, 3)``.

    Raises:
        SceneError: If nobody's shoulders and hip are ever seen.
    """
    whole = np.all(np.isfinite(positions), axis=(1, 2, 3))
    if not whole.any():
        raise SceneError("the upper bodies are never seen whole, so nobody knows where a camera belongs; give --camera")
    first = positions[int(whole.argmax())]
    right, left = (first[:, UPPER9.index(f"{side}_shoulder")].mean(0) for side in ("right", "left"))
    across = (left - right) / max(float(np.linalg.norm(left - right)), 1e-6)
    ahead = np.array([across[1], -across[0], 0.0])
    middle = first[:, UPPER9.index("neck")].mean(0) - [0, 0, 0.25]
    return look_at(middle + VIEWED_FROM_M * ahead + [0, 0, 0.3], middle)


def read_camera(path: str | Path) -> Camera:
    """A camera from JSON: ``focal_px``, ``centre_px``, ``size_px``; ``position`` and ``rotation`` (wxyz) where known.

    A camera whose place is not known stands at the origin, upright, and looks along +y.

    Raises:
        InputError: If there is no such file, or a number is absurd.
        FormatError: If the file is damaged.
    """
    path = Path(path)
    if not path.is_file():
        raise InputError(f"there is no file {path}; give JSON with focal_px, centre_px and size_px of the camera")
    upright = look_at(np.zeros(3), np.array([0.0, 1.0, 0.0]))
    try:
        told = json.loads(read_text(path))
        numbers = [np.array(told[name], np.float64) for name in ("focal_px", "centre_px", "size_px")]
        place = np.array(told.get("position", upright.position), np.float64)
        turned = np.array(told.get("rotation", upright.rotation), np.float64)
    except (ValueError, KeyError, TypeError, AttributeError, RecursionError):
        raise FormatError(path, "this is no camera; expected JSON with focal_px, centre_px and size_px") from None
    focal, centre, size = numbers
    if focal.shape != ():
        raise FormatError(path, "focal_px is not one number; give the focal length in pixels")
    return Camera(float(focal), centre, size, place, turned)
