"""Sampled goal poses made whole: an energy of bones, angles and heat is lowered (Eq. 3.2).

Diller, Funkhouser, Dai, "Forecasting Characteristic 3D Poses of Human Actions" (CVPR 2022), Sec. 3.5. The published
energy looks heat up by whole voxels, which has no slope; here it is interpolated. Sizes |r| are smooth at 1 cm. All
hypotheses are lowered at once by L-BFGS with gradients written by hand.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from motioncast.core.skeleton import Skeleton
from motioncast.core.voxels import SIDE_M

HANDS, BONES, ANGLES, CLOSENESS, HEAT = 0.2, 1.0, 0.4, 0.1, 0.1
"""Weights of the terms of Eq. 3.2 (w_e, w_b, w_a, w_c, w_h)."""

TRUNK_ANGLES = 5.0
"""Weight of the angles of spine, neck and head among the angles, as in the release; those of limbs count once."""

SMOOTH = 0.01
"""Where sizes begin to be round, in metres, and in cosines."""

MEMORY, ITERATIONS, HALVINGS = 20, 50, 12

FIRST_STEP_M = 0.01

ARMIJO = 1e-4
"""Share of the promised fall that a step must bring."""

Energy = Callable[[np.ndarray], tuple[np.ndarray, np.ndarray]]
"""Poses ``(n, joints, 3)`` -> energies ``(n,)`` and their gradients."""


@dataclass(frozen=True, slots=True, eq=False)
class PoseEnergy:
    """Eq. 3.2 for n poses at once.

    Attributes:
        skeleton: Which joint hangs from which.
        last: The last pose seen, ``(n, joints, 3)`` metres: its bones, its angles and its joints are aimed at.
        hands: The joints that were sampled first.
        sampled: Where they were sampled, ``(n, hands, 3)``.
        heat: Of each joint from 0 to 1, ``(n, joints, cells, cells, cells)``.
        angles: Weight of the angles.
        closeness: Weight of the distance from the last pose.
    """

    skeleton: Skeleton
    last: np.ndarray
    hands: tuple[int, int]
    sampled: np.ndarray
    heat: np.ndarray
    angles: float = ANGLES
    closeness: float = CLOSENESS

    def __call__(self, pose: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Energies ``(n,)`` and gradients ``(n, joints, 3)`` of poses ``(n, joints, 3)``."""
        energy, gradient = np.zeros(len(pose)), np.zeros_like(pose)
        for term in (self._hands, self._bones, self._angles, self._closeness, self._heat):
            energy += term(pose, gradient)
        gradient[:, 0] = 0  # the hip is the middle by definition
        return energy, gradient

    def _hands(self, pose: np.ndarray, gradient: np.ndarray) -> np.ndarray:
        hands = list(self.hands)
        apart = pose[:, hands] - self.sampled
        distance = np.sqrt(np.square(apart).sum((1, 2)) + SMOOTH**2)
        gradient[:, hands] += HANDS * apart / distance[:, None, None]
        return HANDS * distance

    def _bones(self, pose: np.ndarray, gradient: np.ndarray) -> np.ndarray:
        bones = _parts(self.skeleton).bones
        bone, length = _lengths(bones @ pose)
        _, wanted = _lengths(bones @ self.last)
        size, slope = _size(length - wanted)
        gradient += bones.T @ (BONES * (slope / length)[..., None] * bone)
        return BONES * size.sum(1)

    def _angles(self, pose: np.ndarray, gradient: np.ndarray) -> np.ndarray:
        _, up, down, shares = _parts(self.skeleton)
        (one, one_m), (other, other_m) = _lengths(up @ pose), _lengths(down @ pose)
        one, other = one / one_m[..., None], other / other_m[..., None]
        cosine = (one * other).sum(-1)
        size, slope = _size(cosine - _cosines(up @ self.last, down @ self.last))
        slope, along = (self.angles * shares * slope)[..., None], cosine[..., None]
        gradient += up.T @ (slope * (other - along * one) / one_m[..., None])
        gradient += down.T @ (slope * (one - along * other) / other_m[..., None])
        return self.angles * (shares * size).sum(1)

    def _closeness(self, pose: np.ndarray, gradient: np.ndarray) -> np.ndarray:
        size, slope = _size(pose - self.last)
        gradient += self.closeness * slope
        return self.closeness * size.sum((1, 2))

    def _heat(self, pose: np.ndarray, gradient: np.ndarray) -> np.ndarray:
        value, slope = interpolated(self.heat, pose)
        gradient -= HEAT * slope
        return HEAT * (1 - value).sum(1)


def interpolated(heat: np.ndarray, points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Heat at points, between the middles of voxels, and its slope; flat outside of the cube.

    Args:
        heat: ``(n, joints, cells, cells, cells)``.
        points: ``(n, joints, 3)`` metres, hip-centred.

    Returns:
        ``(n, joints)``, and ``(n, joints, 3)`` a metre.

    Example:
        >>> heat = np.zeros((1, 1, 16, 16, 16)); heat[..., 8, 8, 8] = 1
        >>> [part.round(3).tolist() for part in interpolated(heat, np.array([[[0.0625, 0.0625, 0.03125]]]))]
        [[[0.75]], [[[-6.0, -6.0, 8.0]]]]
    """
    cells = heat.shape[-1]
    place = (points / SIDE_M + 0.5) * cells - 0.5
    inside = (place >= 0) & (place <= cells - 1)
    place = place.clip(0, cells - 1)
    low = np.minimum(place.astype(int), cells - 2)
    share = place - low
    flat = heat.reshape(*heat.shape[:2], -1)
    first = (low * [cells * cells, cells, 1]).sum(-1)
    corners = np.add.outer(np.add.outer([0, cells * cells], [0, cells]), [0, 1]).ravel()
    cube = np.take_along_axis(flat, first[..., None] + corners, 2).reshape(*first.shape, 2, 2, 2)
    x, y, z = np.moveaxis(share, -1, 0)
    along_z = cube[..., 0] * (1 - z)[..., None, None] + cube[..., 1] * z[..., None, None]
    along_y = along_z[..., 0] * (1 - y)[..., None] + along_z[..., 1] * y[..., None]
    value = along_y[..., 0] * (1 - x) + along_y[..., 1] * x
    step_z = cube[..., 1] - cube[..., 0]
    step_z = step_z[..., 0] * (1 - y)[..., None] + step_z[..., 1] * y[..., None]
    step_y = along_z[..., 1] - along_z[..., 0]
    slope = np.stack(
        [
            along_y[..., 1] - along_y[..., 0],
            step_y[..., 0] * (1 - x) + step_y[..., 1] * x,
            step_z[..., 0] * (1 - x) + step_z[..., 1] * x,
        ], -1,
    )  # fmt: skip
    return value, slope * inside * (cells / SIDE_M)


def lowered(energy: Energy, pose: np.ndarray, iterations: int = ITERATIONS) -> np.ndarray:
    """Poses ``(n, joints, 3)`` after so many steps of L-BFGS, each pose with a step length of its own."""
    shape, count = pose.shape, len(pose)
    now = pose.reshape(count, -1)

    def at(flat: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        value, slope = energy(flat.reshape(shape))
        return value, slope.reshape(count, -1)

    value, slope = at(now)
    moves: list[tuple[np.ndarray, np.ndarray, np.ndarray]] = []
    fresh = np.ones(count, bool)  # poses without a memory of moves: their first step is 1 cm
    for _ in range(iterations):
        ahead = -_two_loops(slope, moves)
        falls = (ahead * slope).sum(1)
        length = np.where(fresh, FIRST_STEP_M / np.maximum(np.abs(slope).max(1), 1e-9), 1.0)
        new, new_value, new_slope = now, value, slope
        done = np.zeros(count, bool)
        for _ in range(HALVINGS):
            tried = now + length[:, None] * ahead
            tried_value, tried_slope = at(tried)
            good = ~done & (tried_value <= value + ARMIJO * length * falls)
            keep = good[:, None]
            new, new_slope = np.where(keep, tried, new), np.where(keep, tried_slope, new_slope)
            new_value = np.where(good, tried_value, new_value)
            done |= good
            if done.all():
                break
            length = np.where(done, length, length / 2)
        step, bend = new - now, new_slope - slope
        curve = (step * bend).sum(1)
        tells = done & (curve > 1e-8 * np.linalg.norm(step, axis=1) * np.linalg.norm(bend, axis=1))
        inverse = np.where(tells, 1 / np.where(tells, curve, 1), 0)
        # who found no step forgets its moves: with them it would look the same way again
        moves = [*((one, other, known * done) for one, other, known in moves), (step, bend, inverse)][-MEMORY:]
        fresh = ~done
        now, value, slope = new, new_value, new_slope
    return now.reshape(shape)


def _two_loops(slope: np.ndarray, moves: list[tuple[np.ndarray, np.ndarray, np.ndarray]]) -> np.ndarray:
    """The slope times the inverse curvature that past moves tell of (Nocedal's recursion), ``(n, numbers)``."""
    answer, shares = slope, []
    for step, bend, inverse in reversed(moves):
        share = inverse * (step * answer).sum(1)
        answer = answer - share[:, None] * bend
        shares.append(share)
    if moves:
        step, bend, inverse = moves[-1]
        norm = np.square(bend).sum(1)
        scale = np.where(inverse > 0, 1 / np.maximum(inverse * norm, 1e-12), 1.0)
        answer = answer * scale[:, None]
    for (step, bend, inverse), share in zip(moves, reversed(shares), strict=True):
        answer = answer + (share - inverse * (bend * answer).sum(1))[:, None] * step
    return answer


def _size(values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """|values|, smooth at zero, and its slope."""
    root = np.sqrt(values * values + SMOOTH**2)
    return root - SMOOTH, values / root


def _lengths(vectors: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Vectors and their lengths, round at zero: where two joints fall together the slope stays finite."""
    return vectors, np.sqrt(np.square(vectors).sum(-1) + SMOOTH**2)


def _cosines(one: np.ndarray, other: np.ndarray) -> np.ndarray:
    """Of the angles between vectors ``(..., 3)``."""
    (one, one_m), (other, other_m) = _lengths(one), _lengths(other)
    return (one * other).sum(-1) / (one_m * other_m)


class _Parts(NamedTuple):
    """What bones and angles are made of, as differences of joints.

    Attributes:
        bones: Times a pose: from each parent to its child, ``(bones, joints)``.
        up: From the joint of each angle to its parent, ``(angles, joints)``.
        down: From there to its first child.
        shares: Weights of the angles.
    """

    bones: np.ndarray
    up: np.ndarray
    down: np.ndarray
    shares: np.ndarray


@lru_cache(maxsize=4)
def _parts(skeleton: Skeleton) -> _Parts:
    unit = np.eye(len(skeleton))
    bends = [
        (parent, joint, skeleton.parents.index(joint)) for joint, parent in skeleton.bones if joint in skeleton.parents
    ]
    trunk = [not skeleton.landmarks[joint].startswith(("left_", "right_")) for _, joint, _ in bends]
    return _Parts(
        np.array([unit[joint] - unit[parent] for joint, parent in skeleton.bones]),
        np.array([unit[parent] - unit[joint] for parent, joint, _ in bends]),
        np.array([unit[child] - unit[joint] for _, joint, child in bends]),
        np.where(trunk, TRUNK_ANGLES, 1.0),
    )
