"""SMPL, SMPL-H and SMPL-X: joints and surface from shape and pose, with the user's own model file.

Loper et al., ACM TOG 34 (2015) 248; Romero et al., ACM TOG 36 (2017) 245; Pavlakos et al., CVPR 2019. The models may
not be shipped: they come from smpl.is.tue.mpg.de, mano.is.tue.mpg.de and smpl-x.is.tue.mpg.de, each with its licence.

A shaped body is ``template + shapes . betas``; its joints are ``regressor . body``; a pose turns each joint within its
parent (axis times angle) and carries the skin along by linear blending, after the pose's corrections (Loper et al.,
equations 2 to 12). SMPL-X's expressions are left at rest.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from motioncast.core.kinematics import forward, world_rotations
from motioncast.core.rotation import conjugate, from_axis_angle, from_matrix, multiply, to_matrix
from motioncast.core.scene import Scene
from motioncast.core.skeleton import Skeleton
from motioncast.core.skeletons import SMPL22, SMPL24, recognise
from motioncast.errors import FormatError, InputError
from motioncast.formats.pickles import read_members
from motioncast.formats.units import axis_turn

_FINGERS = tuple(
    f"{side}_{finger}{joint}"
    for side in ("left", "right")
    for finger in ("index", "middle", "pinky", "ring", "thumb")
    for joint in (1, 2, 3)
)

NAMES: dict[str, tuple[str, ...]] = {
    "smpl": SMPL24.names,
    "smplh": (*SMPL22.names, *_FINGERS),
    "smplx": (*SMPL22.names, "jaw", "left_eye_smplhf", "right_eye_smplhf", *_FINGERS),
}
"""Joint names of each kind of model, in its order; a kind is told by their number: 24, 52, 55."""

KINDS = {len(names): kind for kind, names in NAMES.items()}

_LANDMARKS = {
    "left_middle1": "left_hand", "right_middle1": "right_hand",
    "left_eye_smplhf": "left_eye", "right_eye_smplhf": "right_eye",
}  # fmt: skip

ARRAYS = ("v_template", "shapedirs", "posedirs", "J_regressor", "weights", "kintree_table")

FRAMES_AT_ONCE = 32
"""Frames whose skin is blended at once: 40 MB for SMPL-X."""


@dataclass(frozen=True, slots=True, eq=False)
class SmplModel:
    """A body model, float32, metres, y up, in its rest pose.

    Attributes:
        kind: ``smpl``, ``smplh`` or ``smplx``.
        template: The body of mean shape, ``(vertices, 3)``.
        shapes: What one unit of each shape number moves, ``(vertices, 3, shapes)``.
        corrections: What each entry of a pose's rotation matrices moves, ``(vertices, 3, 9 (joints - 1))``.
        regressor: Joints from vertices, ``(joints, vertices)``.
        weights: Share of each joint in each vertex, ``(vertices, joints)``.
        parents: Parent of each joint, -1 for the pelvis.
    """

    kind: str
    template: np.ndarray
    shapes: np.ndarray
    corrections: np.ndarray
    regressor: np.ndarray
    weights: np.ndarray
    parents: tuple[int, ...]

    @property
    def names(self) -> tuple[str, ...]:
        """Joint names in the model's order."""
        return NAMES[self.kind]

    def skeleton(self, joints: int) -> Skeleton:
        """The skeleton of the first so many joints: 22 of any model are the same body without hands."""
        known = {22: SMPL22, 24: SMPL24 if self.kind == "smpl" else None}.get(joints)
        if known is not None:
            return known
        names = self.names[:joints]
        named = {name: place for name, place in _LANDMARKS.items() if name in names}
        return recognise(names, self.parents[:joints], f"{self.kind}{joints}", named)

    def shaped(self, betas: np.ndarray) -> np.ndarray:
        """The body of a shape, ``(vertices, 3)``.

        Raises:
            InputError: If more shape numbers come than the model has.
        """
        if betas.ndim != 1 or len(betas) > self.shapes.shape[-1]:
            raise InputError(
                f"shape numbers of shape {betas.shape} came, and this {self.kind} model takes at most "
                f"{self.shapes.shape[-1]}; use the release of the model that the data were made with"
            )
        return self.template + self.shapes[..., : len(betas)] @ betas.astype(np.float32)


def load(path: str | Path) -> SmplModel:
    """A model from the user's npz file.

    Raises:
        InputError: If there is no such file, or it is an old pickle, which is answered with how to convert it.
        FormatError: If it is damaged, lacks an array or is no model of a whole body.
    """
    path = Path(path)
    if path.suffix == ".pkl" and path.is_file():
        raise InputError(
            f"{path} is a pickle, which could run code; make an npz of it once, where you trust it: "
            f'python -c "import pathlib, pickle, numpy; m = pickle.loads(pathlib.Path({str(path)!r}).read_bytes(), '
            f"encoding={'latin1'!r}); "
            f"numpy.savez({str(path.with_suffix('.npz'))!r}, **{{k: numpy.asarray(m[k].todense() if "
            f'hasattr(m[k], {"todense"!r}) else m[k]) for k in {ARRAYS}}})"'
        )
    arrays = read_members(path, ARRAYS)
    missing = [name for name in ARRAYS if name not in arrays]
    if missing:
        raise FormatError(path, f"lacks {', '.join(missing)}; expected the npz of an SMPL, SMPL-H or SMPL-X model")
    for name in ARRAYS:
        if not isinstance(arrays[name], np.ndarray) or arrays[name].dtype.kind not in "fiu" or not arrays[name].ndim:
            raise FormatError(path, f"has no numbers in {name}; expected an array of them")
    template, shapes, corrections, regressor, weights = (
        np.ascontiguousarray(arrays[name], np.float32) for name in ARRAYS[:-1]
    )
    vertices, joints = len(template), len(regressor)
    kind = KINDS.get(joints)
    if kind is None:
        raise FormatError(path, f"has {joints} joints; expected 24 (SMPL), 52 (SMPL-H) or 55 (SMPL-X)")
    for name, array, wanted in (
        ("v_template", template, (vertices, 3)),
        ("shapedirs", shapes, (vertices, 3, shapes.shape[-1])),
        ("posedirs", corrections, (vertices, 3, 9 * (joints - 1))),
        ("J_regressor", regressor, (joints, vertices)),
        ("weights", weights, (vertices, joints)),
        ("kintree_table", arrays["kintree_table"], (2, joints)),
    ):
        if array.shape != wanted:
            raise FormatError(path, f"{name} has the shape {array.shape}; expected {wanted}")
    parents = tuple(int(parent) for parent in arrays["kintree_table"][0])  # the pelvis has 2 ** 32 - 1 there
    if not all(0 <= parent < joint for joint, parent in enumerate(parents) if joint):
        raise FormatError(path, "kintree_table names a parent that does not come before its child")
    if kind == "smplx":  # its last directions are expressions: 100 of 400, in the first release 10 of 20
        shapes = shapes[..., : 300 if shapes.shape[-1] >= 300 else 10]
    return SmplModel(kind, template, shapes, corrections, regressor, weights, (-1, *parents[1:]))


def find(folder: str | Path, kind: str, gender: str) -> Path:
    """The user's model file of a kind and a gender, as the releases lay them out.

    Raises:
        InputError: If there is none, naming where it was looked for.
    """
    folder, upper = Path(folder), gender.upper()
    places = [
        *(folder / kind / gender / "model.npz", folder / kind / f"{kind.upper()}_{upper}.npz"),
        folder / f"{kind.upper()}_{upper}.npz",
    ]
    for place in places:
        if place.is_file():
            return place
        if place.with_suffix(".pkl").is_file():
            return place.with_suffix(".pkl")  # ``load`` says how to convert it
    raise InputError(
        f"there is no {gender} model of the kind {kind}; expected {' or '.join(map(str, places))}, "
        "which its owners give out"
    )


def models_beside(path: str | Path) -> Path:
    """The folder ``body_models`` of the data set that a file belongs to: the nearest above it.

    Raises:
        InputError: If there is none.
    """
    for parent in Path(path).resolve().parents:
        if (parent / "body_models").is_dir():
            return parent / "body_models"
    raise InputError(
        f"{path} holds body parameters, which need a body model; put yours into a folder body_models in the "
        "data set's folder"
    )


def joints(model: SmplModel, betas: np.ndarray, poses: np.ndarray, translation: np.ndarray | None = None) -> np.ndarray:
    """Positions of the joints, ``(time, joints, 3)`` float32, in metres, in the axes of the pose.

    Args:
        model: The body model.
        betas: Shape of the person, ``(shapes,)``; the model's further shape numbers are zero.
        poses: Axis times angle of each joint within its parent, ``(time, joints * 3)`` or ``(time, joints, 3)``, of
            the first joints or of all.
        translation: Where the person is, ``(time, 3)``: added to the pelvis of the shaped body.

    Raises:
        InputError: If shapes do not fit the model.
    """
    turns, rest = _turns(model, poses), _rest(model, betas)
    return _places(model, turns, rest, translation).astype(np.float32)


def vertices(
    model: SmplModel,
    betas: np.ndarray,
    poses: np.ndarray,
    translation: np.ndarray | None = None,
    only: Sequence[int] | None = None,
) -> np.ndarray:
    """Positions of the skin, ``(time, vertices, 3)`` float32, by linear blend skinning.

    Args:
        model: The body model.
        betas: As for ``joints``.
        poses: As for ``joints``; joints that are left out are not turned.
        translation: As for ``joints``.
        only: Indices of the vertices that are wanted. Default: all.

    Raises:
        InputError: If shapes do not fit the model.
    """
    turns, rest = _turns(model, poses), _rest(model, betas)
    still = np.tile((1.0, 0, 0, 0), (len(turns), len(rest) - turns.shape[1], 1))
    turns = np.concatenate([turns, still], 1)
    places = _places(model, turns, rest, translation)
    rows = np.arange(len(model.template)) if only is None else np.asarray(only)
    body, corrections, weights = model.shaped(betas)[rows], model.corrections[rows], model.weights[rows]
    skin = np.empty((len(turns), len(rows), 3), np.float32)
    for frames in _blocks(len(turns)):
        matrices = to_matrix(turns[frames, 1:]).astype(np.float32)
        bends = (matrices - np.eye(3, dtype=np.float32)).reshape(len(matrices), -1)
        corrected = body + (bends @ corrections.reshape(-1, bends.shape[1]).T).reshape(-1, *body.shape)
        world = to_matrix(world_rotations(turns[frames], model.parents))
        shift = places[frames] - (world @ rest[..., None])[..., 0]
        moves = np.concatenate([world, shift[..., None]], -1).astype(np.float32)  # (frames, joints, 3, 4)
        blended = (weights @ moves.reshape(len(moves), len(rest), 12)).reshape(-1, len(rows), 3, 4)
        skin[frames] = (blended[..., :3] @ corrected[..., None])[..., 0] + blended[..., 3]
    return skin


def scene(
    model: SmplModel,
    betas: np.ndarray,
    poses: np.ndarray,
    translation: np.ndarray,
    fps: float,
    take: str,
    up: str = "z",
) -> Scene:
    """One person as a scene with rotations, z up.

    Args:
        model: The body model.
        betas: As for ``joints``.
        poses: As for ``joints``; the skeleton has as many joints as come here.
        translation: ``(time, 3)``.
        fps: Frames a second.
        take: Id of the person and source of the scene.
        up: Axis that points up in the world of the pose.
    """
    turns, rest = _turns(model, poses), _rest(model, betas)
    world = axis_turn(up)
    places = _places(model, turns, rest, translation) @ world.T
    # The rest body has y up. Turned to z up it keeps its posed place when each joint's turn is seen from the new axes.
    stand = from_matrix(axis_turn("y"))
    local = multiply(multiply(stand, turns), conjugate(stand))
    local[:, 0] = multiply(from_matrix(world), multiply(turns[:, 0], conjugate(stand)))
    count = turns.shape[1]
    offsets = _offsets(model, rest[:count]) @ axis_turn("y").T
    return Scene(
        places[:, None],
        model.skeleton(count),
        fps,
        people=(take,),
        rotations=local[:, None].astype(np.float32),
        offsets=offsets[None].astype(np.float32),
        source=take,
    )


def with_template(model: SmplModel, template: np.ndarray) -> SmplModel:
    """The model with a person's own body, ``(vertices, 3)``, in place of the mean one.

    Raises:
        InputError: If it has another number of vertices.
    """
    if template.shape != model.template.shape:
        raise InputError(f"a body of shape {template.shape} came for a model of {model.template.shape}; use its own")
    return replace(model, template=template.astype(np.float32))


def _turns(model: SmplModel, poses: np.ndarray) -> np.ndarray:
    vectors = np.asarray(poses, np.float64).reshape(len(poses), -1, 3)
    if not 1 <= vectors.shape[1] <= len(model.parents):
        raise InputError(
            f"poses of {vectors.shape[1]} joints came for a model of the kind {model.kind}, which has "
            f"{len(model.parents)}; use the kind of model that the data were made with"
        )
    return from_axis_angle(vectors)


def _rest(model: SmplModel, betas: np.ndarray) -> np.ndarray:
    return (model.regressor @ model.shaped(np.asarray(betas))).astype(np.float64)


def _offsets(model: SmplModel, rest: np.ndarray) -> np.ndarray:
    offsets = rest - rest[list(model.parents[: len(rest)])]
    offsets[0] = 0
    return offsets


def _places(model: SmplModel, turns: np.ndarray, rest: np.ndarray, translation: np.ndarray | None) -> np.ndarray:
    count = turns.shape[1]
    root = rest[0] + (np.zeros((len(turns), 3)) if translation is None else translation)
    offsets = _offsets(model, rest[:count])
    return forward(turns[:, None], root[:, None], offsets[None], model.parents[:count])[:, 0]


def _blocks(frames: int) -> Iterator[slice]:
    for start in range(0, frames, FRAMES_AT_ONCE):
        yield slice(start, start + FRAMES_AT_ONCE)
