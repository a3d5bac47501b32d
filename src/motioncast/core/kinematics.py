"""From joint rotations to positions and back, in BVH's convention: a joint's rotation turns its children.

``forward`` is the easy way. ``fit_rotations`` is the way back, which a model's answer needs before it can
become a BVH or GLB file:

- Bones keep their length: rest offsets are those of the history, or its median bones laid out in a T pose.
- A joint with several children that move as one is turned to fit them best (Kabsch 1976); one with a single
  child swings to aim at it. The *twist* about that bone cannot be seen in positions: it is carried over from
  the history, or else is that of the shortest swing from the rest pose, kept free of flips.
- Where children of one joint move on their own (chest: neck and both collars), each gets a *pivot*: a joint
  of zero length at the parent, as the usual BVH of CMU's data has them. Pivots are named ``CHILD_pivot``.
- What is then left (a bone that stretches, such as pelvis to neck in a skeleton without a spine) stays in the
  positions: such a joint *slides*, ``local_places`` gives its path in its parent's frame, and files give it
  position channels. So a fitted scene lies within ``SLIDE_M`` of the positions that it was made of.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from motioncast.core import rotation
from motioncast.core.rest import handles, rest_body, steadiness
from motioncast.core.scene import Scene
from motioncast.core.skeleton import Skeleton

SLIDE_M = 0.004
"""A joint that the turns of its parents bring no closer than this to its place slides there instead."""

UNTWIST_S = 1.0
"""Time constant with which twist that a swing round a circle has left behind is let go."""


def world_rotations(rotations: np.ndarray, parents: Sequence[int]) -> np.ndarray:
    """Rotation of each joint in the world, ``(..., joints, 4)``, from local ones of the same shape."""
    world = np.array(rotations)
    for joint, parent in enumerate(parents):
        if parent >= 0:
            world[..., joint, :] = rotation.multiply(world[..., parent, :], rotations[..., joint, :])
    return world


def forward(
    rotations: np.ndarray, root_positions: np.ndarray, offsets: np.ndarray, parents: Sequence[int]
) -> np.ndarray:
    """World positions of the joints, ``(time, people, joints, 3)``.

    Args:
        rotations: Local rotations, ``(time, people, joints, 4)``.
        root_positions: Where joint 0 is, ``(time, people, 3)``; other roots hang on it by their offset.
        offsets: Each joint's place in the frame of its parent, ``(people, joints, 3)``, or
            ``(time, people, joints, 3)`` where joints slide.
        parents: Parent of each joint, -1 for roots.

    Example:
        >>> quarter = rotation.from_axis_angle(np.array([0, 0, np.pi / 2]))
        >>> turns = np.stack([quarter, rotation.IDENTITY])[None, None]
        >>> offsets = np.array([[[0.0, 0, 0], [1, 0, 0]]])
        >>> forward(turns, np.zeros((1, 1, 3)), offsets, [-1, 0])[0, 0, 1].round(6) + 0.0
        array([0., 1., 0.])
    """
    world = world_rotations(rotations, parents)
    positions = np.empty((*rotations.shape[:-1], 3))
    for joint, parent in enumerate(parents):
        if joint == 0:
            positions[..., 0, :] = root_positions
            continue
        bone = offsets[..., joint, :]
        turned = rotation.rotate(world[..., parent, :], bone) if parent >= 0 else bone
        positions[..., joint, :] = positions[..., max(parent, 0), :] + turned
    return positions


def local_places(scene: Scene) -> np.ndarray:
    """Each joint's place in the frame of its parent, ``(time, people, joints, 3)``; of a root: in the world.

    For a joint that does not slide that is its rest offset; ``forward`` of them gives the scene's positions.
    Where a joint is not observed it keeps its last place. The scene has rotations.
    """
    assert scene.rotations is not None
    assert scene.offsets is not None
    parents = scene.skeleton.parents
    places = np.empty((*scene.positions.shape[:3], 3))
    positions = scene.positions.astype(np.float64)
    world = world_rotations(scene.rotations.astype(np.float64), parents)
    for joint, parent in enumerate(parents):
        seen = scene.observed[:, :, joint]
        if parent < 0:
            places[:, :, joint] = _filled(positions[:, :, joint], seen)
            continue
        seen = seen & scene.observed[:, :, parent]
        bone = positions[:, :, joint] - positions[:, :, parent]
        local = rotation.rotate(rotation.conjugate(world[:, :, parent]), bone)
        rest = np.broadcast_to(scene.offsets[:, joint], local.shape)
        places[:, :, joint] = _filled(np.where(np.any(seen, 0)[..., None], local, rest), seen)
    return places


def sliding(scene: Scene, places: np.ndarray, tolerance_m: float = 1e-4) -> np.ndarray:
    """Which joints leave their rest offset, ``(joints,)`` bool; roots move anyway and do not count."""
    assert scene.offsets is not None
    moved = np.linalg.norm(places - scene.offsets, axis=-1).max((0, 1), initial=0)
    return (moved > tolerance_m) & (np.array(scene.skeleton.parents) >= 0)


def fit_rotations(scene: Scene, history: Scene | None = None) -> Scene:
    """The same motion with local rotations and rest offsets.

    Args:
        scene: Positions to follow.
        history: What went before, of (at least) the same people and ending one frame earlier; its rotations
            go on without a step. Without it the scene's own positions tell lengths and pivots.

    Returns:
        A scene with rotations and offsets whose positions are those of ``forward`` with ``local_places``,
        within ``SLIDE_M`` of the given ones. Its skeleton is the history's where that has rotations, else
        the scene's with pivots added; joints of the scene keep their names.
    """
    if history is None:
        skeleton, offsets = rest_body(scene)
        return _fit(_onto(scene, skeleton), offsets, None)
    history = history.select(scene.people)
    if history.rotations is None or history.offsets is None:
        history = fit_rotations(history)
    assert history.rotations is not None
    assert history.offsets is not None
    scene = _onto(scene, history.skeleton)
    last = history[-1:]
    whole = replace(
        scene,
        positions=np.concatenate([last.positions, scene.positions]),
        observed=np.concatenate([last.observed, scene.observed]),
    )
    return _fit(whole, history.offsets.astype(np.float64), history.rotations[-1].astype(np.float64))[1:]


def _onto(scene: Scene, skeleton: Skeleton) -> Scene:
    """The scene on a skeleton that adds pivots, which stand where their parents are."""
    source = [
        scene.skeleton.names.index(name if name in scene.skeleton.names else skeleton.names[parent])
        for name, parent in zip(skeleton.names, skeleton.parents, strict=True)
    ]
    return replace(
        scene,
        positions=scene.positions[:, :, source],
        observed=scene.observed[:, :, source],
        skeleton=skeleton,
        rotations=None,
        offsets=None,
    )


def _fit(scene: Scene, offsets: np.ndarray, start: np.ndarray | None) -> Scene:
    """Rotations of a scene on its final skeleton; ``start`` holds those of its first frame, where known."""
    skeleton, target, seen = scene.skeleton, scene.positions.astype(np.float64), scene.observed
    weights = steadiness(scene)
    local = np.tile(rotation.IDENTITY, (*target.shape[:3], 1))
    world, positions = local.copy(), target.copy()
    for joint, parent in enumerate(skeleton.parents):
        positions[:, :, joint], base = _place(
            target[:, :, joint], seen[:, :, joint], positions, world, offsets[:, joint], parent
        )
        ends = handles(skeleton, offsets, joint)
        first = None if start is None else start[:, joint]
        if ends:
            bones = target[:, :, ends] - positions[:, :, joint, None]
            bones = rotation.rotate(rotation.conjugate(base)[:, :, None], bones) * weights[ends, None]
            rest = offsets[:, ends] * weights[ends, None]
            turn = _turned(bones, rest, np.all(seen[:, :, ends], 2), scene.fps, first)
        else:
            turn = np.broadcast_to(rotation.IDENTITY if first is None else first, base.shape)
        local[:, :, joint] = _continuous(turn, first)
        world[:, :, joint] = rotation.multiply(base, local[:, :, joint])
    return replace(
        scene,
        positions=positions.astype(np.float32),
        rotations=local.astype(np.float32),
        offsets=offsets.astype(np.float32),
    )


def _place(
    target: np.ndarray,
    seen: np.ndarray,
    positions: np.ndarray,
    world: np.ndarray,
    offset: np.ndarray,
    parent: int,
) -> tuple[np.ndarray, np.ndarray]:
    """Where a joint comes to lie, and the rotation in the world of what it hangs on."""
    if parent < 0:
        return _filled(target, seen), np.tile(rotation.IDENTITY, (*target.shape[:2], 1))
    base = world[:, :, parent]
    rigid = positions[:, :, parent] + rotation.rotate(base, offset)
    if not (np.linalg.norm(rigid - target, axis=-1) > SLIDE_M)[seen].any():
        return rigid, base
    local = rotation.rotate(rotation.conjugate(base), target - positions[:, :, parent])
    local = _filled(np.where(np.any(seen, 0)[..., None], local, offset), seen)
    return positions[:, :, parent] + rotation.rotate(base, local), base


def _turned(bones: np.ndarray, rest: np.ndarray, seen: np.ndarray, fps: float, start: np.ndarray | None) -> np.ndarray:
    """Rotations ``(time, people, 4)`` that turn rest bones ``(people, ends, 3)`` into each frame's."""
    known = seen if start is None else np.concatenate([np.ones_like(seen[:1]), seen[1:]])
    if rest.shape[1] > 1 and _spans_plane(rest).all() and _spans_plane(bones)[seen].all():
        turn = rotation.kabsch(np.broadcast_to(rest, bones.shape), bones)
        if start is not None:  # what the fit misses in the history's last frame it goes on missing: no step
            missed = rotation.multiply(rotation.conjugate(turn[0]), start)
            turn = rotation.multiply(turn, np.where(seen[0, :, None], missed, rotation.IDENTITY))
            turn[0] = start
        return _filled(turn, known)
    # all ends lie on one line: it can be aimed, the twist about it cannot be seen
    line = np.linalg.svd(rest)[2][:, 0]
    sign = np.where((rest * line[:, None]).sum(-1) < 0, -1.0, 1.0)[..., None]
    return _filled(_aimed((bones * sign).sum(-2), (rest * sign).sum(-2), seen, fps, start), known)


def _spans_plane(bones: np.ndarray) -> np.ndarray:
    """Whether bones ``(..., n, 3)``, n > 1, lie far enough off one line to tell the twist about it."""
    spread = np.linalg.svd(bones, compute_uv=False)
    return spread[..., 1] > 0.1 * spread[..., 0]


def _aimed(
    direction: np.ndarray, axis: np.ndarray, seen: np.ndarray, fps: float, start: np.ndarray | None
) -> np.ndarray:
    """Swings ``(time, people, 4)`` of a rest axis to each frame's direction, with a twist that never flips.

    The shortest swing from rest spins fast where the direction passes close to the opposite of the rest axis;
    carrying each frame's rotation on (parallel transport) never does, but turns away for good when the bone
    goes round a circle. So twist is transported, and what differs from the shortest swing fades slowly.
    """
    still = np.linalg.norm(direction, axis=-1) < 1e-6
    direction = _filled(direction, seen & ~still)
    # a person never seen, or a bone of no length, keeps the rest pose
    direction = np.where(np.linalg.norm(direction, axis=-1, keepdims=True) < 1e-6, axis, direction)
    if start is not None:
        direction[0] = rotation.rotate(start, axis)
    shortest = rotation.between(axis, direction)
    if start is not None:
        shortest = rotation.multiply(shortest, rotation.multiply(rotation.conjugate(shortest[0]), start))
    carried = rotation.multiply(rotation.between(direction[:-1], direction[1:]), shortest[:-1])
    apart = rotation.multiply(carried, rotation.conjugate(shortest[1:]))
    unit = direction / np.maximum(np.linalg.norm(direction, axis=-1, keepdims=True), 1e-12)
    steps = 2 * np.arctan2((apart[..., 1:] * unit[1:]).sum(-1), apart[..., 0])
    fade = np.exp(-1 / (fps * UNTWIST_S))
    twist = np.zeros(direction.shape[:2])
    for time, step in enumerate(steps):
        turned = twist[time] + step
        twist[time + 1] = fade * (turned - 2 * np.pi * np.round(turned / (2 * np.pi)))
    return rotation.multiply(rotation.from_axis_angle(unit * twist[..., None]), shortest)


def _filled(values: np.ndarray, seen: np.ndarray) -> np.ndarray:
    """Values ``(time, people, n)``; unseen frames repeat the last seen one, or else the first."""
    if seen.all():
        return values
    frames = np.where(seen, np.arange(len(seen))[:, None], -1)
    last = np.maximum.accumulate(frames, 0)
    last = np.where(last < 0, seen.argmax(0), last)
    return np.take_along_axis(values, last[..., None], 0)


def _continuous(quaternions: np.ndarray, start: np.ndarray | None) -> np.ndarray:
    """The same rotations, each with the sign that lies closer to the frame before it."""
    first = quaternions[:1] if start is None else start[None]
    before = np.concatenate([first, quaternions[:-1]])
    signs = np.where((before * quaternions).sum(-1, keepdims=True) < 0, -1.0, 1.0)
    return quaternions * np.cumprod(signs, 0)
