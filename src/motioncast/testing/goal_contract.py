"""The contract of a model of goals: what must happen to its poses when the question changes."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np

from motioncast.core.goal_poses import GoalPoses
from motioncast.core.scene import Scene
from motioncast.errors import SceneError
from motioncast.testing.scenes import padded, unseen, walkers

LIMBS = ("knee", "ankle", "elbow", "wrist")

GOALS = 4
"""Goals that a clause asks for where their number does not matter."""


def _ask(model: Any, scene: Scene) -> GoalPoses:
    return model.forecast(scene, samples=GOALS)


def _close(model: Any, one: np.ndarray, other: np.ndarray, what: str) -> None:
    apart = float(np.abs(one.astype(np.float64) - other).max())
    assert apart <= model.card.tolerance_m, f"{what}: {apart * 1000:.3f} mm apart"


def _same(model: Any, one: GoalPoses, other: GoalPoses, what: str) -> None:
    """Goals, weights and heat of the same people are the same."""
    assert one.people == other.people, what
    _close(model, one.poses, other.poses, what)
    np.testing.assert_allclose(one.weights, other.weights, atol=1e-3, err_msg=what)
    for hand, heat in one.heat.items():
        np.testing.assert_allclose(heat, other.heat[hand], atol=1e-3, err_msg=what)


def moving(model: Any) -> None:
    """A scene moved elsewhere has its goals moved likewise."""
    scene, shift = walkers(), np.array([12.0, -7.0, 0.0], np.float32)
    here, there = _ask(model, scene), _ask(model, replace(scene, positions=scene.positions + shift))
    _same(model, replace(there, poses=there.poses - shift, heat_origin=there.heat_origin - shift), here, "moved scene")
    _close(model, there.heat_origin - shift, here.heat_origin, "the heat of a moved scene")


def turning(model: Any) -> None:
    """A scene turned about the vertical has its goals turned likewise, and its heat in cubes that turned."""
    scene, angle = walkers(), 1.1
    matrix = np.array([[np.cos(angle), -np.sin(angle), 0], [np.sin(angle), np.cos(angle), 0], [0, 0, 1]])
    turned = _ask(model, replace(scene, positions=(scene.positions @ matrix.T).astype(np.float32)))
    straight = _ask(model, scene)
    _same(model, turned, replace(straight, poses=straight.poses @ matrix.T), "turned scene")
    _close(model, turned.heat_across, straight.heat_across @ matrix[:2, :2].T, "the heat of a turned scene")


def reordering(model: Any) -> None:
    """People in another order get their goals in that order."""
    scene, order = walkers(), [2, 0, 1]
    shuffled = _ask(model, scene.select([scene.people[person] for person in order]))
    straight = _ask(model, scene)
    _close(model, shuffled.poses, straight.poses[:, order], "re-ordered people")
    np.testing.assert_allclose(shuffled.weights, straight.weights[:, order], atol=1e-3)


def absent_person(model: Any) -> None:
    """A person who was there earlier and has left has no goals, and changes nothing for the others."""
    scene = walkers()
    left = unseen(scene, (slice(scene.frames // 2, None), 2))
    answer = _ask(model, left)
    assert answer.people == scene.people[:2]
    other = scene.positions.copy()
    other[:, 2] += 3.0
    _same(model, answer, _ask(model, replace(left, positions=other)), "an absent person's motion")
    _same(model, answer, _ask(model, scene.select(scene.people[:2])), "an absent person")


def padding(model: Any) -> None:
    """A slot for a person who is never seen changes nothing."""
    scene = walkers()
    _same(model, _ask(model, padded(scene)), _ask(model, scene), "empty slots")


def not_a_number(model: Any) -> None:
    """What is not a number counts as not seen; numbers beyond reason are refused with a sentence, or answered."""
    scene = walkers()
    lost = unseen(scene, (slice(-4, -2), 0, 14), (3, 1), lost=True)
    assert np.isfinite(_ask(model, lost).poses).all()
    try:
        answer = _ask(model, replace(scene, positions=scene.positions * np.float32(1e30)))
    except SceneError:
        return
    assert np.isfinite(answer.poses).all()


def apart_from_others(model: Any) -> None:
    """A scene is answered as if no other had been asked about: nothing is kept from one to the next."""
    scene = walkers()
    alone = _ask(model, scene).poses
    for other in (walkers(people=5, seed=1), walkers(people=1, seed=2)):
        _ask(model, other)
    np.testing.assert_array_equal(_ask(model, scene).poses, alone)


def late_person(model: Any) -> None:
    """A person who has just appeared is answered and flagged, or answered by the model; never refused."""
    scene = walkers()
    answer = _ask(model, unseen(scene, (slice(-2), 1)))
    assert answer.people == scene.people
    assert np.isfinite(answer.poses).all()
    assert answer.warnings or not answer.guessed.any()


def frame_rate(model: Any) -> None:
    """The same motion at another rate has much the same goals."""
    one, other = _ask(model, walkers(frames=60, fps=15)), _ask(model, walkers(frames=237, fps=60))
    middles = [(goals.poses * goals.weights[..., None, None]).sum(0) for goals in (one, other)]
    apart = np.linalg.norm(middles[0] - middles[1], axis=-1)
    assert apart.mean() < 0.1, f"{apart.mean() * 1000:.0f} mm apart on average"


def seed(model: Any) -> None:
    """The same seed gives the same goals, to the last bit."""
    one, other = (model.forecast(walkers(), samples=GOALS, seed=3) for _ in range(2))
    np.testing.assert_array_equal(one.poses, other.poses)
    np.testing.assert_array_equal(one.weights, other.weights)


def question_untouched(model: Any) -> None:
    """The question is not written to."""
    scene = walkers()
    scene.positions.setflags(write=False)
    scene.observed.setflags(write=False)
    before = scene.positions.copy()
    _ask(model, scene)
    np.testing.assert_array_equal(scene.positions, before)


def gaps(model: Any) -> None:
    """Joints that are not seen for a while, or at last, do not make the answer fail."""
    scene = walkers()
    answer = _ask(model, unseen(scene, (slice(-3, None), 0, 14), (slice(-9, -6), 1)))
    assert answer.people == scene.people
    near = np.linalg.norm(answer.best - scene.positions[-1], axis=-1)
    assert near.max() < 2.0, f"a joint is {near.max():.1f} m from where it was"


def nobody(model: Any) -> None:
    """A scene whose last frame is empty is refused with a sentence."""
    try:
        _ask(model, unseen(walkers(), (-1,)))
    except SceneError:
        return
    raise AssertionError("nobody was there, and yet an answer came")


def many_goals(model: Any) -> None:
    """As many goals as asked for, the likeliest first, and shares that sum to 1; so does the heat."""
    for count in (1, 3, 10):
        answer = model.forecast(walkers(people=2), samples=count)
        assert len(answer.poses) == count
        np.testing.assert_allclose(answer.weights.sum(0), 1, atol=1e-5)
        assert (np.diff(answer.weights, axis=0) <= 1e-7).all()
    for heat in answer.heat.values():
        np.testing.assert_allclose(heat.reshape(2, -1).sum(1), 1, atol=1e-4)


def whole_bones(model: Any) -> None:
    """Limbs keep their length within 1 cm."""
    scene = walkers()
    answer = _ask(model, scene)
    for joint, parent in scene.skeleton.bones:
        if scene.skeleton.names[joint].endswith(LIMBS):
            now, then = (
                np.linalg.norm(points[..., joint, :] - points[..., parent, :], axis=-1)
                for points in (scene.positions[-1], answer.poses)
            )
            assert np.abs(then - now).max() < 0.01, scene.skeleton.names[joint]


def on_the_ground(model: Any) -> None:
    """A goal stands where the person stood: hips above the same place, feet as low."""
    scene = walkers()
    answer, pelvis = _ask(model, scene), scene.skeleton.index("pelvis")
    aside = answer.poses[..., pelvis, :2] - scene.positions[-1, :, pelvis, :2]
    assert np.abs(aside).max() < 0.05
    lower = answer.poses[..., 2].min(-1) - scene.positions[-1, ..., 2].min(-1)
    assert np.abs(lower).max() < 0.15


GOAL_CLAUSES: dict[str, Callable[[Any], None]] = {
    clause.__name__: clause
    for clause in (
        moving, turning, reordering, absent_person, padding, not_a_number, apart_from_others, late_person, frame_rate,
        seed, question_untouched, gaps, nobody, many_goals, whole_bones, on_the_ground,
    )
}  # fmt: skip
"""Every clause by name."""
