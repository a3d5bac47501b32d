"""Scene and forecast files of our own: plain NumPy arrays and one JSON text named ``meta``.

    motioncast.scene/1      positions, observed; rotations and offsets where known; of object N, from 0 on,
                            object_N_position and object_N_rotation, and object_N_size or object_N_points and _faces
    motioncast.forecast/1   samples, weights, carried, guessed, radius_LEVEL; the history (and the truth, where it
                            came) as a scene whose arrays have the prefix ``history_`` (``truth_``)
    motioncast.goals/1      poses, weights, heat_HAND, heat_origin, heat_across, carried, guessed; the history likewise

Metres, seconds, z up. ``numpy.load`` reads them without this package; nothing in them can run code.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from motioncast.core.card import ModelCard
from motioncast.core.forecast import Forecast
from motioncast.core.goal_poses import GoalPoses
from motioncast.core.scene import Scene
from motioncast.core.scene_object import SceneObject
from motioncast.core.skeleton import Skeleton
from motioncast.core.skeletons import recognise
from motioncast.errors import FormatError, InputError
from motioncast.formats.files import atomic_write, read_npz

suffixes = (".npz",)

SCENE_SCHEMA = "motioncast.scene/1"
FORECAST_SCHEMA = "motioncast.forecast/1"
GOALS_SCHEMA = "motioncast.goals/1"


def sniff(head: bytes) -> bool:
    """Whether a file that begins so may be an npz file: a zip."""
    return head.startswith(b"PK\x03\x04")


def read(
    path: str | Path,
    *,
    up: str | None = None,
    unit: str | None = None,
    fps: float | None = None,
    named: Mapping[str, str] | None = None,
) -> Scene:
    """A scene file; of a file of a forecast or of goals, its history.

    Args:
        path: The file.
        up: Must be z or None: scene files are z up.
        unit: Must be m or None: scene files are in metres.
        fps: Frame rate to believe instead of the file's.
        named: Landmarks by joint name, over those of the file.

    Raises:
        FormatError: If the file is damaged or has another layout.
        InputError: If another up axis or unit is asked for.
    """
    if up not in (None, "z") or unit not in (None, "m"):
        raise InputError(f"{path} is a scene file, which is in metres with z up; leave --up and --unit out")
    arrays, meta = _open(path, (SCENE_SCHEMA, FORECAST_SCHEMA, GOALS_SCHEMA))
    if meta["schema"] != SCENE_SCHEMA:
        return _scene(path, arrays, _entry(path, meta, "history", dict), "history_", fps, named)
    return _scene(path, arrays, meta, "", fps, named)


def write(scene: Scene, path: str | Path) -> tuple[Path, ...]:
    """Writes a scene file.

    Raises:
        OutputError: If it cannot be written.
    """
    arrays, meta = _packed(scene, "")
    _save(path, arrays, {"schema": SCENE_SCHEMA, **meta})
    return (Path(path),)


def write_forecast(forecast: Forecast, path: str | Path, truth: Scene | None = None) -> tuple[Path, ...]:
    """Writes a forecast file, with what really happened where that is known.

    Args:
        forecast: The forecast.
        path: The file.
        truth: The frames after the history, on the same skeleton.

    Raises:
        OutputError: If it cannot be written.
    """
    arrays, history = _packed(forecast.history, "history_")
    arrays |= {
        "samples": forecast.samples, "weights": forecast.weights,
        "carried": forecast.carried, "guessed": forecast.guessed,
        **{f"radius_{level}": np.asarray(radius, np.float32) for level, radius in forecast.radius_m.items()},
    }  # fmt: skip
    meta: dict[str, Any] = {
        "schema": FORECAST_SCHEMA, "people": list(forecast.people), "seed": forecast.seed,
        "warnings": list(forecast.warnings), "card": json.loads(forecast.card.to_json()), "history": history,
    }  # fmt: skip
    if truth is not None:
        later, meta["truth"] = _packed(truth, "truth_")
        arrays |= later
    _save(path, arrays, meta)
    return (Path(path),)


def read_forecast(path: str | Path) -> Forecast:
    """The forecast of a forecast file.

    Raises:
        FormatError: If the file is damaged or has another layout.
    """
    arrays, meta = _open(path, (FORECAST_SCHEMA,))
    levels = [name.removeprefix("radius_") for name in arrays if name.startswith("radius_")]
    history = _scene(path, arrays, _entry(path, meta, "history", dict), "history_")
    samples = _array(path, arrays, "samples", (None, None, None, None, 3), "f")
    count, frames, people, joints, _ = samples.shape
    try:
        return Forecast(
            samples,
            history,
            tuple(_strings(path, meta, "people")),
            ModelCard.from_json(json.dumps(_entry(path, meta, "card", dict))),
            _array(path, arrays, "weights", (count,), "f"),
            {level: _array(path, arrays, f"radius_{level}", (frames, joints), "f") for level in levels},
            _array(path, arrays, "carried", (joints,), "b"),
            _array(path, arrays, "guessed", (people,), "b"),
            _entry(path, meta, "seed", int),
            tuple(_strings(path, meta, "warnings")),
        )
    except FormatError:
        raise
    except InputError as error:
        raise FormatError(path, str(error)) from None


def read_truth(path: str | Path) -> Scene | None:
    """What really happened, as a forecast file holds it; None where it does not.

    Raises:
        FormatError: If the file is damaged or has another layout.
    """
    arrays, meta = _open(path, (FORECAST_SCHEMA,))
    return _scene(path, arrays, _entry(path, meta, "truth", dict), "truth_") if "truth" in meta else None


def write_goals(goals: GoalPoses, path: str | Path) -> tuple[Path, ...]:
    """Writes a file of goal poses.

    Raises:
        OutputError: If it cannot be written.
    """
    arrays, history = _packed(goals.history, "history_")
    arrays |= {
        "poses": goals.poses, "weights": np.asarray(goals.weights, np.float32),
        "heat_origin": np.asarray(goals.heat_origin, np.float32),
        "heat_across": np.asarray(goals.heat_across, np.float32),
        "carried": goals.carried, "guessed": goals.guessed,
        **{f"heat_{hand}": np.asarray(heat, np.float32) for hand, heat in goals.heat.items()},
    }  # fmt: skip
    meta: dict[str, Any] = {
        "schema": GOALS_SCHEMA, "people": list(goals.people), "seed": goals.seed, "warnings": list(goals.warnings),
        "hands": list(goals.heat), "heat_side_m": goals.heat_side_m, "card": json.loads(goals.card.to_json()),
        "history": history,
    }  # fmt: skip
    _save(path, arrays, meta)
    return (Path(path),)


def read_goals(path: str | Path) -> GoalPoses:
    """The goal poses of a file of goals.

    Raises:
        FormatError: If the file is damaged or has another layout.
    """
    arrays, meta = _open(path, (GOALS_SCHEMA,))
    history = _scene(path, arrays, _entry(path, meta, "history", dict), "history_")
    poses = _array(path, arrays, "poses", (None, None, None, 3), "f")
    goals, people, joints, _ = poses.shape
    hands = _strings(path, meta, "hands")
    try:
        return GoalPoses(
            poses,
            history,
            tuple(_strings(path, meta, "people")),
            ModelCard.from_json(json.dumps(_entry(path, meta, "card", dict))),
            _array(path, arrays, "weights", (goals, people), "f"),
            {hand: _array(path, arrays, f"heat_{hand}", (people, None, None, None), "f") for hand in hands},
            _array(path, arrays, "heat_origin", (people, 3), "f"),
            _array(path, arrays, "heat_across", (people, 2), "f"),
            _array(path, arrays, "carried", (joints,), "b"),
            _array(path, arrays, "guessed", (people,), "b"),
            _entry(path, meta, "heat_side_m", float),
            _entry(path, meta, "seed", int),
            tuple(_strings(path, meta, "warnings")),
        )
    except FormatError:
        raise
    except InputError as error:
        raise FormatError(path, str(error)) from None


# --- scenes as arrays and JSON ------------------------------------------------------------------------------


def _packed(scene: Scene, prefix: str) -> tuple[dict[str, np.ndarray], dict[str, Any]]:
    arrays = {f"{prefix}positions": scene.positions, f"{prefix}observed": scene.observed}
    if scene.rotations is not None and scene.offsets is not None:
        arrays[f"{prefix}rotations"] = np.asarray(scene.rotations, np.float32)
        arrays[f"{prefix}offsets"] = np.asarray(scene.offsets, np.float32)
    for number, thing in enumerate(scene.objects):
        parts = {"position": thing.position, "rotation": thing.rotation, "points": thing.points, "faces": thing.faces}
        if thing.points is None:
            parts["size"] = thing.size
        arrays |= {f"{prefix}object_{number}_{part}": array for part, array in parts.items() if array is not None}
    skeleton = scene.skeleton
    meta = {
        "fps": scene.fps, "people": list(scene.people), "source": scene.source, "remarks": list(scene.remarks),
        "skeleton": {
            "names": list(skeleton.names), "parents": list(skeleton.parents),
            "landmarks": list(skeleton.landmarks), "label": skeleton.label,
        },
    }  # fmt: skip
    if scene.objects:
        meta["objects"] = [
            {"name": thing.name, "category": thing.category, "shape": thing.shape, "role": thing.role}
            for thing in scene.objects
        ]
    if scene.floor_m is not None:
        meta["floor_m"] = float(scene.floor_m)
    return arrays, meta


def _objects(
    path: str | Path, arrays: Mapping[str, np.ndarray], meta: Mapping[str, Any], prefix: str
) -> Iterator[SceneObject]:
    for number, about in enumerate(_entry(path, meta, "objects", list) if "objects" in meta else ()):
        if not isinstance(about, dict):
            raise FormatError(path, f'object {number} of "meta" is {about!r:.40}; expected a dict')
        kept = f"{prefix}object_{number}_"
        parts: dict[str, np.ndarray] = {}
        for part, shape, kind in (
            ("position", (3,), "f"), ("rotation", (4,), "f"), ("size", (3,), "f"), ("points", (None, 3), "f"),
            ("faces", (None, 3), "i"),
        ):  # fmt: skip
            array = arrays.get(f"{kept}{part}")
            if array is not None:
                moving = part in ("position", "rotation") and array.ndim == 2
                parts[part] = _array(path, arrays, f"{kept}{part}", (None, *shape) if moving else shape, kind)
        texts = [_entry(path, about, entry, str) for entry in ("name", "category", "shape", "role")]
        yield SceneObject(*texts[:3], role=texts[3], **parts)


def _scene(
    path: str | Path,
    arrays: Mapping[str, np.ndarray],
    meta: Mapping[str, Any],
    prefix: str,
    fps: float | None = None,
    named: Mapping[str, str] | None = None,
) -> Scene:
    tree = _entry(path, meta, "skeleton", dict)
    names, landmarks = _strings(path, tree, "names"), _strings(path, tree, "landmarks")
    parents = _entry(path, tree, "parents", list)
    if not all(type(parent) is int for parent in parents):
        raise FormatError(path, 'the entry "parents" must hold whole numbers')
    positions = _array(path, arrays, f"{prefix}positions", (None, None, len(names), 3), "f")
    frames, people = positions.shape[:2]
    turned = f"{prefix}rotations" in arrays
    try:
        skeleton = Skeleton(tuple(names), tuple(parents), tuple(landmarks), _entry(path, tree, "label", str))
        if named:
            taken = set(named.values())  # the user's word wins over the file's
            known = {name: "" if place in taken else place for name, place in zip(names, landmarks, strict=True)}
            skeleton = recognise(names, parents, skeleton.label, {**known, **named})
        return Scene(
            positions,
            skeleton,
            _entry(path, meta, "fps", float) if fps is None else fps,
            _array(path, arrays, f"{prefix}observed", (frames, people, len(names)), "b"),
            tuple(_strings(path, meta, "people")),
            _array(path, arrays, f"{prefix}rotations", (frames, people, len(names), 4), "f") if turned else None,
            _array(path, arrays, f"{prefix}offsets", (people, len(names), 3), "f") if turned else None,
            _entry(path, meta, "source", str),
            tuple(_strings(path, meta, "remarks")),
            tuple(_objects(path, arrays, meta, prefix)),
            _entry(path, meta, "floor_m", float) if "floor_m" in meta else None,
        )
    except FormatError:
        raise
    except InputError as error:
        raise FormatError(path, str(error)) from None


# --- strict access ------------------------------------------------------------------------------------------


def _open(path: str | Path, schemas: tuple[str, ...]) -> tuple[dict[str, np.ndarray], dict[str, Any]]:
    arrays = read_npz(path)
    text = arrays.get("meta")
    if text is None or text.dtype.kind != "U" or text.size != 1:
        raise FormatError(path, f'has no text "meta"; expected a file of the schema {" or ".join(schemas)}')
    try:
        meta = json.loads(str(text.reshape(())))
    except (ValueError, RecursionError) as error:
        raise FormatError(path, f'the entry "meta" is not JSON ({error}); the file is damaged') from None
    if not isinstance(meta, dict) or meta.get("schema") not in schemas:
        found = meta.get("schema") if isinstance(meta, dict) else None
        raise FormatError(path, f'has the schema "{found}"; expected {" or ".join(schemas)}')
    return arrays, meta


def _save(path: str | Path, arrays: Mapping[str, np.ndarray], meta: Mapping[str, Any]) -> None:
    with atomic_write(path) as temporary, temporary.open("wb") as file:
        np.savez_compressed(file, meta=np.array(json.dumps(meta, ensure_ascii=False)), **arrays)  # pyright: ignore[reportArgumentType]


def _entry(path: str | Path, meta: Mapping[str, Any], name: str, kind: type) -> Any:
    value = meta.get(name)
    if kind is float and type(value) is int and abs(value) < 1 << 53:
        return float(value)
    if type(value) is not kind:
        raise FormatError(path, f'the entry "{name}" of "meta" is {value!r:.40}; expected a {kind.__name__}')
    return value


def _strings(path: str | Path, meta: Mapping[str, Any], name: str) -> list[str]:
    values = _entry(path, meta, name, list)
    if not all(isinstance(value, str) for value in values):
        raise FormatError(path, f'the entry "{name}" of "meta" must hold texts only')
    return values


def _array(
    path: str | Path, arrays: Mapping[str, np.ndarray], name: str, shape: tuple[int | None, ...], kind: str
) -> np.ndarray:
    array = arrays.get(name)
    fits = (
        array is not None
        and array.dtype.kind == kind
        and array.ndim == len(shape)
        and all(wanted in (None, size) for wanted, size in zip(shape, array.shape, strict=True))
    )
    if array is None or not fits:
        found = "missing" if array is None else f"{array.dtype} of shape {array.shape}"
        wanted = ", ".join("any" if size is None else str(size) for size in shape)
        raise FormatError(path, f'the array "{name}" is {found}; expected kind {kind} of shape ({wanted})')
    if kind == "f" and not np.isfinite(array).all():
        raise FormatError(path, f'the array "{name}" holds numbers that are not finite; mark them as not observed')
    return array
