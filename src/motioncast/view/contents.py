"""What a page is about: its description, and its numbers packed.

Numbers travel as 16-bit integers: positions in millimetres, so that rounding costs at most 0.5 mm a coordinate.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from motioncast.bodies.openbody import Bent, bend, load_body
from motioncast.core.forecast import Forecast
from motioncast.core.goal_poses import GoalPoses
from motioncast.core.scene import Scene
from motioncast.core.skeleton import Skeleton
from motioncast.errors import SkeletonError
from motioncast.view.curves import Curves, drawn_curves
from motioncast.view.furniture import add_objects
from motioncast.view.packing import Block, pack

HISTORY_S = 4.0
"""At most so much of the history is shown."""

MOST_FPS = 31.0
"""Frames beyond this rate are left out; the page interpolates."""

MOST_FRAMES = 900
"""A longer forecast is shown with fewer frames a second."""

SIDES = ("left", "right")

HOT = 0.03
"""Voxels whose heat is below this share of the hottest one are not drawn."""

Track = tuple[np.ndarray, np.ndarray, int]
"""Positions and mask of history and one future, and the first frame of them that is kept."""


def contents(
    forecast: Forecast, truth: Scene | None, title: str | None, curves: Curves
) -> tuple[dict[str, Any], bytes]:
    """The description of a page and its packed numbers; the arguments are those of ``page_html``."""
    history, skeleton = forecast.history, forecast.skeleton
    stride = max(1, -(-forecast.samples.shape[1] // MOST_FRAMES), int(np.ceil(forecast.fps / MOST_FPS)))
    fps = forecast.fps / stride
    now = min(-(-history.frames // stride), max(round(HISTORY_S * fps), 1))
    past = slice(history.frames - 1 - (now - 1) * stride, None, stride)
    ahead = slice(stride - 1, None, stride)

    def future(positions: np.ndarray, people: Sequence[str], first: int, observed: np.ndarray | None = None) -> Track:
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
            first,
        )

    order = np.argsort(-forecast.weights, kind="stable")  # the most probable future leads
    tracks = {"main": future(forecast.samples[order[0]], forecast.people, 0)}
    for number, index in enumerate(order[1:]):
        tracks[f"sample/{number}"] = future(forecast.samples[index], forecast.people, now - 1)
    if truth is not None and truth.frames >= stride:
        cut = truth[: forecast.samples.shape[1]]
        tracks["truth"] = future(cut.positions, cut.people, now - 1, cut.observed)

    spots = np.concatenate([track[seen] for track, seen, _ in tracks.values()])
    middle = np.round((spots.min(0)[:2] + spots.max(0)[:2]) / 2) if len(spots) else np.zeros(2)
    origin = np.append(middle, history.floor_m or 0)  # the page's floor is at 0
    spots = np.concatenate([spots, *(np.atleast_2d(thing.position) for thing in history.objects)])
    scale = max(1e-3, float(np.abs(spots - origin).max(initial=0)) / 32767)
    block = Block()
    for name, (positions, seen, first) in tracks.items():
        block.add(f"{name}/positions", np.where(seen[..., None], positions - origin, 0)[first:], scale)
        block.add(f"{name}/observed", seen[first:], 1)
    for level, radius in forecast.radius_m.items():
        grown = np.concatenate([np.zeros((1, radius.shape[1])), radius[ahead]])
        block.add(f"radius/{level}", grown, max(1e-3, float(grown.max()) / 32767))
    bones = _add_bodies(block, tracks, skeleton, origin, scale)
    if forecast.goals is not None:
        _add_heat(block, forecast.goals, origin, scale)

    drawn, heading = drawn_curves(forecast, truth, curves, ahead)
    places = [skeleton.find(name) for name in ("left_hip", "right_hip")]
    feet = [skeleton.find(f"{side}_{place}") for side in SIDES for place in ("ankle", "foot", "toe")]
    ends = [skeleton.find(f"{side}_{place}") for side in SIDES for place in ("wrist", "ankle")]
    ends.append(skeleton.find("head"))
    guessed = {person for person, guess in zip(forecast.people, forecast.guessed, strict=True) if guess}
    card = forecast.card
    about = {
        "schema": "motioncast.page/2",
        "title": title or history.source or "A forecast",
        "fps": fps,
        "now": now,
        "frames": len(tracks["main"][0]),
        "origin": origin.tolist(),
        "weights": forecast.weights[order].round(4).tolist(),
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
        "objects": add_objects(block, history.objects, past, origin, scale),
        "goals": forecast.goals is not None,
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


def _add_heat(block: Block, goals: GoalPoses, origin: np.ndarray, scale: float) -> None:
    """Adds where hands may come to be: points, how hot they are beside the hottest, and whose: 0 right, 1 left."""
    points, shares, hands = [np.zeros((0, 3))], [np.zeros(0)], [np.zeros(0)]
    for number, hand in enumerate(("right_wrist", "left_wrist")):
        person, place, heat = goals.heat_points(hand)
        hottest = np.zeros(len(goals.people))
        np.maximum.at(hottest, person, heat)
        share = heat / np.maximum(hottest[person], 1e-12)
        hot = share >= HOT
        points.append(place[hot] - origin)
        shares.append(share[hot])
        hands.append(np.full(int(hot.sum()), number))
    block.add("heat/positions", np.concatenate(points), scale)
    block.add("heat/weights", np.concatenate(shares), 1e-3)
    block.add("heat/hands", np.concatenate(hands), 1)


def _add_bodies(block: Block, tracks: Mapping[str, Track], skeleton: Skeleton, origin: np.ndarray, scale: float) -> int:
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
        _, seen, first = tracks[name]
        there = np.asarray(seen.all(-1))[first:, :, None, None]
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
