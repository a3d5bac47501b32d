"""Up axis and unit of length: stated by the file, given by the user, or inferred from the body's size and pose.

Few motion files say in which unit they count and which way is up. A body does: an adult's thigh is some 0.42 m
long, and the head is above the feet. What was inferred is said aloud in a remark of the scene.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from motioncast.core.scene import Scene
from motioncast.core.skeleton import Skeleton
from motioncast.errors import InputError, SceneError

UNITS_M: dict[str, float] = {"m": 1.0, "cm": 0.01, "mm": 0.001, "cmu": 0.0254 / 0.45, "inch": 0.0254}
"""Metres per unit. ``cmu`` is the unit of CMU's Acclaim files and of the BVH files made from them."""

_SPELLINGS = {"metre": "m", "meter": "m", "centimetre": "cm", "centimeter": "cm", "millimetre": "mm",
              "millimeter": "mm", "in": "inch", "inche": "inch"}  # fmt: skip

_ADULT_M: dict[tuple[str, str], float] = {
    **{
        (f"{side}_{start}", f"{side}_{end}"): length
        for side in ("left", "right")
        for start, end, length in (
            ("hip", "knee", 0.42), ("knee", "ankle", 0.41), ("shoulder", "elbow", 0.29), ("elbow", "wrist", 0.25),
        )
    },
    ("pelvis", "neck"): 0.52,
    ("pelvis", "neck_base"): 0.47,
    ("left_shoulder", "right_shoulder"): 0.35,
}  # fmt: skip
"""Typical lengths between landmarks of a person of 1.70 m."""

ADULT_STATURE_M = 1.70
INFERRED_STATURE_M = (0.9, 2.3)
"""A unit is inferred where it makes the body this tall; the ranges of the units do not overlap for adults."""
POSSIBLE_STATURE_M = (0.4, 3.0)
"""No body outside is taken for a person's, whatever the file or the user says."""
FARTHEST_M = 10_000.0
"""Positions farther from the origin lose millimetres in float32 and are taken for damage."""
FARTHEST_UNITS = 1e15
"""No unit makes a person's place of a coordinate beyond; its square would overflow."""

# rows: the new x, y, z in terms of the old axes; each is a proper rotation
_TURNS: dict[str, np.ndarray] = {
    "z": np.eye(3),
    "y": np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]]),
    "x": np.array([[0.0, 1, 0], [0, 0, 1], [1, 0, 0]]),
    "-y": np.array([[1.0, 0, 0], [0, 0, 1], [0, -1, 0]]),
    "-z": np.array([[1.0, 0, 0], [0, -1, 0], [0, 0, -1]]),
    "-x": np.array([[0.0, 0, 1], [0, 1, 0], [-1, 0, 0]]),
}


@dataclass(frozen=True, slots=True)
class World:
    """How a file's coordinates become metres with z up.

    Attributes:
        turn: Rotation from the file's axes, ``(3, 3)``.
        scale: Metres per unit of the file.
        remarks: What was inferred, one sentence each.
    """

    turn: np.ndarray
    scale: float
    remarks: tuple[str, ...] = ()

    def points(self, points: np.ndarray) -> np.ndarray:
        """Points or offsets ``(..., 3)`` in metres, z up."""
        return points @ self.turn.T * self.scale

    def rotations(self, quaternions: np.ndarray) -> np.ndarray:
        """The same local rotations seen from the new axes, ``(..., 4)``."""
        return np.concatenate([quaternions[..., :1], quaternions[..., 1:] @ self.turn.T], -1)


def unit_in_m(unit: str) -> float:
    """Metres per unit, from a name such as ``cm`` or a number of metres.

    Raises:
        InputError: If it is neither.

    Example:
        >>> unit_in_m("cm"), unit_in_m("Inches"), unit_in_m("0.1")
        (0.01, 0.0254, 0.1)
    """
    name = unit.strip().lower()
    name = name if name in UNITS_M or name in _SPELLINGS else name.removesuffix("s")
    name = _SPELLINGS.get(name, name)
    if name in UNITS_M:
        return UNITS_M[name]
    try:
        value = float(name)
    except ValueError:
        value = 0.0
    if not 1e-9 < value < 1e9:
        raise InputError(f'the unit "{unit}" is unknown; use one of {", ".join(UNITS_M)} or a number of metres')
    return value


def axis_turn(up: str) -> np.ndarray:
    """The rotation ``(3, 3)`` that makes z of the axis that points up: x, y, z or one of them with a minus.

    Raises:
        InputError: If it is none of these.
    """
    key = up.strip().lower().removeprefix("+")
    if key not in _TURNS:
        raise InputError(f'the up axis "{up}" is unknown; use one of {", ".join(_TURNS)}')
    return _TURNS[key]


def stature(positions: np.ndarray, observed: np.ndarray, skeleton: Skeleton) -> float:
    """Size of the bodies in the unit of the positions, as the stature of an adult of their bone lengths.

    The pose does not matter where limbs are recognised; else the largest extent of the body serves. The median
    over people, frames (a few hundred of them) and bones; 0 where nothing can be measured.

    Args:
        positions: ``(time, people, joints, 3)``.
        observed: ``(time, people, joints)``.
        skeleton: Their skeleton.
    """
    step = max(1, len(positions) // 300)
    positions, observed = positions[::step], observed[::step]
    ratios = []
    for (start, end), length in _ADULT_M.items():
        a, b = skeleton.find(start), skeleton.find(end)
        if a is not None and b is not None:
            seen = observed[:, :, a] & observed[:, :, b]
            if seen.any():
                lengths = np.linalg.norm(positions[:, :, a][seen] - positions[:, :, b][seen], axis=-1)
                ratios.append(float(np.median(lengths)) / length)
    if ratios:
        return ADULT_STATURE_M * float(np.median(ratios))
    seen = observed.any(-1)
    if not seen.any():
        return 0.0
    highest = np.where(observed[..., None], positions, -np.inf).max(2)[seen]
    lowest = np.where(observed[..., None], positions, np.inf).min(2)[seen]
    return float(np.median((highest - lowest).max(-1)))


def upright(positions: np.ndarray, observed: np.ndarray, skeleton: Skeleton) -> np.ndarray:
    """Mean direction from feet to head as a share of its length along x, y, z, ``(3,)``; zero if unknown."""
    step = max(1, len(positions) // 300)
    head = _middle(positions[::step], observed[::step], skeleton, _HIGH)
    foot = _middle(positions[::step], observed[::step], skeleton, _LOW)
    if head is None or foot is None:
        return np.zeros(3)
    body = head - foot
    length = np.linalg.norm(body, axis=-1, keepdims=True)
    known = np.isfinite(length) & (length > 0)
    shares = np.where(known, body / np.where(known, length, 1), 0)[known[..., 0]]
    return shares.mean(0) if len(shares) else np.zeros(3)


_HIGH = (("head",), ("upper_neck",), ("neck",), ("neck_base",), ("nose",), ("left_shoulder", "right_shoulder"))
_LOW = (("left_ankle", "right_ankle"), ("left_foot", "right_foot"), ("left_heel", "right_heel"),
        ("left_knee", "right_knee"), ("pelvis",), ("left_hip", "right_hip"))  # fmt: skip


def _middle(
    positions: np.ndarray, observed: np.ndarray, skeleton: Skeleton, choices: tuple[tuple[str, ...], ...]
) -> np.ndarray | None:
    """Middle of the first places that the skeleton has; NaN where one is not observed."""
    for places in choices:
        joints = [joint for joint in map(skeleton.find, places) if joint is not None]
        if len(joints) == len(places):
            seen = np.all(observed[:, :, joints], 2)
            return np.where(seen[..., None], positions[:, :, joints].mean(2), np.nan)
    return None


def settle(
    path: str | Path,
    positions: np.ndarray,
    observed: np.ndarray,
    skeleton: Skeleton,
    *,
    up: str | None,
    unit: str | None,
    usual_up: str,
    rest: np.ndarray | None = None,
) -> World:
    """The way from a file's coordinates into metres with z up.

    Args:
        path: The file, for messages.
        positions: ``(time, people, joints, 3)`` in the file's axes and unit.
        observed: ``(time, people, joints)``.
        skeleton: Their skeleton.
        up: Up axis where the file states it or the user gives it; else it is inferred.
        unit: Unit where the file states it or the user gives it; else it is inferred.
        usual_up: Up axis that the format usually has, for bodies whose pose does not tell.
        rest: ``(joints, 3)`` the rest pose, where the file has one: it helps where people lie.

    Raises:
        InputError: If ``up`` or ``unit`` is unknown.
        SceneError: If no unit makes a person of the body, or the given one does not.
    """
    largest = max(float(np.abs(points).max(initial=0)) for points in (positions, () if rest is None else rest))
    if not largest < FARTHEST_UNITS:
        raise SceneError(f"{path}: a coordinate is {largest:.3g}, which is no place in any unit; mend the file")
    size = stature(positions, observed, skeleton)
    guesses = []
    if unit is None:
        unit = _unit_of(path, size)
        guesses.append(f"unit {unit} (stature about {size * UNITS_M[unit]:.2f} m)")
    scale = unit_in_m(unit)
    if size > 0 and not POSSIBLE_STATURE_M[0] <= size * scale <= POSSIBLE_STATURE_M[1]:
        raise SceneError(
            f'{path}: in the unit "{unit}" the body would be {size * scale:.3g} m tall; expected '
            f"{POSSIBLE_STATURE_M[0]} to {POSSIBLE_STATURE_M[1]} m; give the right one by --unit ({', '.join(UNITS_M)})"
        )
    if up is None:
        up = _up_of(positions, observed, skeleton, rest, usual_up)
        guesses.append(f"up axis {up}")
    farthest = float(np.abs(positions).max(initial=0)) * scale
    if not farthest <= FARTHEST_M:
        raise SceneError(
            f"{path}: a coordinate is {farthest:.3g} m from the origin; expected at most {FARTHEST_M:.0f} m; "
            "mend the file or give the right --unit"
        )
    remark = f"{Path(path).name}: {' and '.join(guesses)} inferred from the body; override with --unit and --up"
    return World(axis_turn(up), scale, (remark,) if guesses else ())


def _unit_of(path: str | Path, size: float) -> str:
    low, high = INFERRED_STATURE_M
    for name, scale in UNITS_M.items():
        if low <= size * scale <= high:
            return name
    raise SceneError(
        f"{path}: the body is {size:.3g} units tall, which is no person's stature in any of {', '.join(UNITS_M)}; "
        "give the unit by --unit"
    )


def _up_of(positions: np.ndarray, observed: np.ndarray, skeleton: Skeleton, rest: np.ndarray | None, usual: str) -> str:
    evidence = [upright(positions, observed, skeleton)]
    if rest is not None:
        evidence.append(upright(rest[None, None], np.ones((1, 1, len(rest)), bool), skeleton))
    for share in evidence:  # x is never up in practice: a body along x lies, or its rest pose is a local one
        y, z = abs(share[1]), abs(share[2])
        if max(y, z) > 0.5 and max(y, z) > 1.5 * min(y, z):
            axis = 1 if y > z else 2
            return ("" if share[axis] > 0 else "-") + "xyz"[axis]
    return usual


def check_size(scene: Scene) -> Scene:
    """The scene itself, if its numbers can be those of people in metres.

    Raises:
        SceneError: If the bodies have an impossible size or stand absurdly far away.
    """
    settle(scene.source or "the scene", scene.positions, scene.observed, scene.skeleton, up="z", unit="m", usual_up="z")
    return scene
