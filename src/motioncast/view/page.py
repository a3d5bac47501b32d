"""One self-contained, interactive page of a forecast: no request but the file itself.

The program of the page (``page.js``, ``page.css``, ``page.html``) is built from ``frontend/``. Numbers travel
as 16-bit integers (positions in millimetres, so that rounding costs at most 0.5 mm a coordinate), as steps
from frame to frame, deflated.
"""

from __future__ import annotations

import base64
import hashlib
import html
import json
import re
import zlib
from collections.abc import Mapping, Sequence
from importlib.resources import files
from pathlib import Path
from typing import Any

import numpy as np

from motioncast.bodies.openbody import Bent, bend, load_body
from motioncast.core.forecast import Forecast
from motioncast.core.scene import Scene
from motioncast.core.skeleton import Skeleton
from motioncast.errors import SceneError, SkeletonError
from motioncast.formats.files import atomic_write

HISTORY_S = 4.0
"""At most so much of the history is shown."""

MOST_FPS = 31.0
"""Frames beyond this rate are left out; the page interpolates."""

SIDES = ("left", "right")

Curves = Mapping[str, tuple[np.ndarray, np.ndarray]]
"""Name -> times in seconds after now, mean joint errors in metres."""


def write_page(
    forecast: Forecast, path: str | Path, truth: Scene | None = None, title: str | None = None,
    curves: Curves | None = None,
) -> None:  # fmt: skip
    """Write the page of a forecast; the arguments are those of ``page_html``.

    Raises:
        SceneError: If the truth has other joints or another frame rate than the forecast.
        OutputError: If the file cannot be written.
    """
    text = page_html(forecast, truth, title, curves)
    with atomic_write(path) as temporary:
        temporary.write_text(text, encoding="utf-8", newline="\n")


def page_html(
    forecast: Forecast, truth: Scene | None = None, title: str | None = None, curves: Curves | None = None
) -> str:
    """The page of a forecast as HTML text.

    Args:
        forecast: What is shown.
        truth: What really happened: frame 0 is the first frame after the last seen one. It may be shorter
            than the forecast and lack people.
        title: Heading. Default: the source of the history.
        curves: Errors of other forecasts, drawn beside the model's own; an entry of the model's name
            replaces the error that the page would compute (mean over people and joints that the model knows).

    Raises:
        SceneError: If the truth has other joints or another frame rate than the forecast.
    """
    if truth is not None:
        _check(forecast, truth)
    about, numbers = _contents(forecast, truth, title, curves or {})
    source = files("motioncast.view")
    style = source.joinpath("page.css").read_text(encoding="utf-8")
    script = source.joinpath("page.js").read_text(encoding="utf-8")
    policy = (
        f"default-src 'none'; script-src '{_hash(script)}'; style-src '{_hash(style)}'; img-src data:; "
        "base-uri 'none'; form-action 'none'"
    )
    parts = {
        "policy": policy,
        "title": html.escape(about["title"]),
        "style": style,
        "about": json_block(about),
        "numbers": base64.b64encode(numbers).decode("ascii"),
        "script": script,
    }
    template = source.joinpath("page.html").read_text(encoding="utf-8")
    return re.sub(r"\{\{(\w+)\}\}", lambda match: parts[match[1]], template)


def json_block(value: Any) -> str:
    r"""JSON that is safe inside a script element, whatever text it holds.

    Example:
        >>> json_block({"name": "</script>"})
        '{"name":"\\u003c/script\\u003e"}'
    """
    text = json.dumps(value, separators=(",", ":"), allow_nan=False)
    return text.replace("<", "\\u003c").replace(">", "\\u003e").replace("&", "\\u0026")


def pack(arrays: Sequence[np.ndarray]) -> bytes:
    """int16 arrays as one deflated block: zigzag steps along the first axis, low bytes before high bytes."""
    steps = [np.diff(array, axis=0, prepend=np.zeros_like(array[:1])).ravel() for array in arrays]
    step = np.concatenate(steps).astype(np.int16)
    zigzag = ((step << 1) ^ (step >> 15)).view(np.uint16)
    low, high = (zigzag & 255).astype(np.uint8), (zigzag >> 8).astype(np.uint8)
    return zlib.compress(low.tobytes() + high.tobytes(), 9)


def _hash(text: str) -> str:
    return "sha256-" + base64.b64encode(hashlib.sha256(text.encode("utf-8")).digest()).decode("ascii")


def _check(forecast: Forecast, truth: Scene) -> None:
    if truth.skeleton.names != forecast.skeleton.names:
        raise SceneError(
            f'the truth is on the skeleton "{truth.skeleton.label}" and the forecast on '
            f'"{forecast.skeleton.label}"; give the truth on the skeleton of the history'
        )
    if not np.isclose(truth.fps, forecast.fps):
        raise SceneError(
            f"the truth has {truth.fps:g} frames a second, the forecast {forecast.fps:g}; resample it first"
        )


def _contents(
    forecast: Forecast, truth: Scene | None, title: str | None, curves: Curves
) -> tuple[dict[str, Any], bytes]:
    """The description of the page and its packed numbers."""
    history, skeleton = forecast.history, forecast.skeleton
    stride = max(1, int(np.ceil(forecast.fps / MOST_FPS)))
    fps = forecast.fps / stride
    now = min(-(-history.frames // stride), max(round(HISTORY_S * fps), 1))
    past = slice(history.frames - 1 - (now - 1) * stride, None, stride)
    ahead = slice(stride - 1, None, stride)

    def future(positions: np.ndarray, people: Sequence[str], observed: np.ndarray | None = None):  # noqa: ANN202
        """Positions and mask on the history's people, joined to its shown frames."""
        placed = np.zeros((len(positions), *history.positions.shape[1:]), np.float32)
        seen = np.zeros(placed.shape[:3], bool)
        for column, person in enumerate(people):
            if person in history.people:
                placed[:, history.people.index(person)] = positions[:, column]
                seen[:, history.people.index(person)] = True if observed is None else observed[:, column]
        return (
            np.concatenate([history.positions[past], placed[ahead]]),
            np.concatenate([history.observed[past], seen[ahead]]),
        )

    order = np.argsort(-forecast.weights, kind="stable")
    main, main_seen = future(forecast.samples[order[0]], forecast.people)
    others = [future(forecast.samples[index], forecast.people) for index in order[1:]]
    tracks = {"main": (main, main_seen, 0)}
    if truth is not None and truth.frames >= stride:
        cut = truth[: forecast.samples.shape[1]]
        tracks["truth"] = (*future(cut.positions, cut.people, cut.observed), now - 1)

    spots = np.concatenate([track[seen] for track, seen, *_ in (*tracks.values(), *others)])
    origin = np.round(np.append((spots.min(0)[:2] + spots.max(0)[:2]) / 2, 0)) if len(spots) else np.zeros(3)
    scale = max(1e-3, float(np.abs(spots - origin).max(initial=0)) / 32767)
    block = _Block()
    for name, (positions, seen, first) in tracks.items():
        block.add(f"{name}/positions", np.where(seen[..., None], positions - origin, 0)[first:], scale)
        block.add(f"{name}/observed", seen[first:], 1)
    for index, (positions, seen) in enumerate(others):
        block.add(f"sample/{index}", np.where(seen[..., None], positions - origin, 0)[now - 1 :], scale)
        if index == 0:
            block.add("sample/observed", seen[now - 1 :], 1)
    for level, radius in forecast.radius_m.items():
        grown = np.concatenate([np.zeros((1, radius.shape[1])), radius[ahead]])
        block.add(f"radius/{level}", grown, max(1e-3, float(grown.max()) / 32767))
    bones = _add_bodies(block, tracks, skeleton, origin, scale)

    drawn, heading = _curves(forecast, truth, curves, ahead)
    places = [skeleton.find(name) for name in ("left_hip", "right_hip")]
    feet = [skeleton.find(f"{side}_{place}") for side in SIDES for place in ("ankle", "foot", "toe")]
    ends = [skeleton.find(f"{side}_{place}") for side in SIDES for place in ("wrist", "ankle")]
    ends.append(skeleton.find("head"))
    guessed = {person for person, guess in zip(forecast.people, forecast.guessed, strict=True) if guess}
    card = forecast.card
    about = {
        "schema": "motioncast.page/1",
        "title": title or history.source or "A forecast",
        "fps": fps,
        "now": now,
        "frames": len(main),
        "origin": origin.tolist(),
        "samples": len(forecast.samples),
        "truth": len(tracks["truth"][0]) - now + 1 if "truth" in tracks else 0,
        "skeleton": {
            "label": skeleton.label,
            "names": skeleton.names,
            "bones": skeleton.bones,
            "hips": places if None not in places else [0],
            "feet": [joint for joint in feet if joint is not None],
            "ends": [joint for joint in ends if joint is not None],
        },
        "people": [
            {"id": person, "guessed": person in guessed} for person in history.people
        ],
        "levels": list(forecast.radius_m),
        "curves": drawn,
        "curvesTitle": heading,
        "warnings": forecast.warnings,
        "card": {
            "name": card.name, "system": card.system, "parameters": card.parameters, "data": card.data,
            "licence": card.licence,
        },
        "bones": bones,
        "arrays": block.entries,
    }  # fmt: skip
    return about, pack(block.arrays)


class _Block:
    """Arrays on their way into the page, as 16-bit integers of a unit each."""

    def __init__(self) -> None:
        self.arrays: list[np.ndarray] = []
        self.entries: list[dict[str, Any]] = []

    def add(self, name: str, values: np.ndarray, scale: float) -> None:
        self.arrays.append(np.round(np.asarray(values, np.float64) / scale).astype(np.int16))
        self.entries.append({"name": name, "shape": list(values.shape), "scale": scale})


def _add_bodies(
    block: _Block, tracks: Mapping[str, tuple[np.ndarray, np.ndarray, int]], skeleton: Skeleton,
    origin: np.ndarray, scale: float,
) -> int:  # fmt: skip
    """Adds mesh and poses; the number of bones, 0 where the skeleton cannot carry a body."""
    try:
        poses = {name: bend(_filled(*track[:2]), skeleton) for name, track in tracks.items()}
    except SkeletonError:
        return 0
    body = load_body()
    block.add("body/vertices", body.vertices, 1e-4)
    block.add("body/faces", body.faces, 1)
    block.add("body/indices", body.indices, 1)
    block.add("body/weights", body.weights, 1 / 255)
    block.add("body/heads", body.heads, 1e-4)
    block.add("body/axes", body.axes, 1 / 32767)
    block.add("body/scales", np.clip(poses["main"].scales, 0, 10), 1e-3)
    for name, bent in poses.items():
        first = tracks[name][2]
        there = np.asarray(tracks[name][1].all(-1))[first:, :, None, None]
        rotations = np.where(there, _smooth_signs(bent)[first:], [1, 0, 0, 0])
        block.add(f"{name}/rotations", rotations, 1 / 4096)
        block.add(f"{name}/heads", np.where(there, bent.heads[first:] - origin, 0), scale)
    return len(body.bones)


def _smooth_signs(bent: Bent) -> np.ndarray:
    """Rotations whose signs do not jump (a quaternion and its negative turn alike): small steps pack well."""
    turned = (bent.rotations[1:] * bent.rotations[:-1]).sum(-1, keepdims=True) < 0
    signs = np.cumprod(np.where(np.concatenate([np.zeros_like(turned[:1]), turned]), -1, 1), axis=0)
    return bent.rotations * signs


def _filled(positions: np.ndarray, seen: np.ndarray) -> np.ndarray:
    """Positions with every gap filled from the nearest frame in which the joint was seen."""
    times = np.arange(len(seen))
    filled = positions.copy()
    for person, joint in zip(*np.nonzero(~seen.all(0)), strict=True):
        known = np.flatnonzero(seen[:, person, joint])
        if len(known):
            nearest = known[np.abs(times[:, None] - known).argmin(1)]
            filled[:, person, joint] = positions[nearest, person, joint]
    return filled


def _curves(forecast: Forecast, truth: Scene | None, others: Curves, ahead: slice) -> tuple[list[dict[str, Any]], str]:
    """What is drawn beside the scene: errors where the truth is known, else the error radii."""

    def curve(name: str, kind: str, times: np.ndarray, errors: np.ndarray) -> dict[str, Any]:
        known = np.isfinite(errors)
        return {
            "name": name, "kind": kind,
            "times": np.round(np.asarray(times)[known], 4).tolist(),
            "errors": np.round(np.asarray(errors)[known], 4).tolist(),
        }  # fmt: skip

    name = forecast.card.name
    drawn = []
    if name in others or truth is not None:
        times, errors = others[name] if name in others else joint_errors(forecast, truth)  # pyright: ignore[reportArgumentType]
        drawn.append(curve(name, "model", np.asarray(times)[ahead], np.asarray(errors)[ahead]))
    drawn += [
        curve(other, "baseline", np.asarray(times), np.asarray(errors))
        for other, (times, errors) in others.items()
        if other != name
    ]
    if drawn:
        return [entry for entry in drawn if entry["times"]], "Mean joint error"
    radii = [
        curve(
            f"{100 * float(level):.0f} % of joints within",
            "radius",
            forecast.times_s[ahead],
            radius.mean(1)[ahead],
        )
        for level, radius in forecast.radius_m.items()
    ]
    return radii, "Expected joint error"


def joint_errors(forecast: Forecast, truth: Scene) -> tuple[np.ndarray, np.ndarray]:
    """Times in seconds and the mean error in metres of the most probable sample at each.

    The mean runs over people and joints that the truth shows, joints that were only carried along left out;
    it is NaN where there are none.
    """
    frames = min(truth.frames, forecast.samples.shape[1])
    people = [person for person in forecast.people if person in truth.people]
    if not people:
        return forecast.times_s[:0], forecast.times_s[:0]
    rows = [forecast.people.index(person) for person in people]
    shown = truth[:frames].select(people)
    away = np.linalg.norm(forecast.best[:frames, rows] - shown.positions, axis=-1)
    counted = shown.observed & ~forecast.carried
    count = counted.sum((1, 2))
    total = np.where(counted, away, 0).sum((1, 2))
    return forecast.times_s[:frames], np.where(count > 0, total / np.maximum(count, 1), np.nan)
