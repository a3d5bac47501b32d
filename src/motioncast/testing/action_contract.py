"""The contract of a model of actions: what must happen to its steps when the question changes."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np

from motioncast.core.action_sequence import ActionSequence
from motioncast.core.action_steps import ActionSteps
from motioncast.core.camera import Camera
from motioncast.core.rotation import from_axis_angle, multiply, rotate
from motioncast.datasets import kitchen
from motioncast.errors import InputError, SceneError

PAST = 12


def watched(model: Any, number: int = 0) -> ActionSequence:
    """Cooks whose actions and objects bear the names that the model knows."""
    card = model.card
    cooks = kitchen.sequence("validation", number, people=card.people)
    labels, things = tuple(card.needs["labels"]), tuple(card.needs["objects"])
    return ActionSequence(
        cooks.name, labels, cooks.actions[:PAST] % len(labels), cooks.pixels[:PAST], cooks.camera, things,
        np.arange(len(things)) % 3 > 0,
    )  # fmt: skip


def _same(model: Any, one: ActionSteps, other: ActionSteps, what: str, seen_alike: bool = True) -> None:
    """Probabilities and poses are the same; where the camera stays, so are places in the image."""
    np.testing.assert_allclose(one.probabilities, other.probabilities, atol=1e-4, err_msg=what)
    np.testing.assert_array_equal(one.actions, other.actions, err_msg=what)
    apart = float(np.abs(one.poses - other.poses).max())
    assert apart <= model.card.tolerance_m, f"{what}: {apart * 1000:.3f} mm apart"
    if seen_alike:
        np.testing.assert_allclose(one.pixels, other.pixels, atol=0.05, err_msg=what)


def _placed(camera: Camera, position: np.ndarray, rotation: np.ndarray) -> Camera:
    return Camera(camera.focal_px, camera.centre_px, camera.size_px, position, rotation)


def moving(model: Any) -> None:
    """A camera that stands elsewhere and sees the same has its poses moved likewise."""
    question, shift = watched(model), np.array([2.0, -3.0, 0.5])
    camera = question.camera
    moved = model.forecast(replace(question, camera=_placed(camera, camera.position + shift, camera.rotation)))
    _same(model, replace(moved, poses=moved.poses - shift), model.forecast(question), "moved camera")


def turning(model: Any) -> None:
    """A camera that is turned with its world has its poses turned likewise."""
    question, turn = watched(model), from_axis_angle(np.array([0.0, 0.0, 1.1]))
    camera = question.camera
    turned = _placed(camera, rotate(turn, camera.position), multiply(turn, camera.rotation))
    straight = model.forecast(question)
    expected = replace(straight, poses=rotate(turn, straight.poses.astype(np.float64)))
    _same(model, model.forecast(replace(question, camera=turned)), expected, "turned camera")


def resolution(model: Any) -> None:
    """A video twice as fine is answered alike."""
    question, camera = watched(model), watched(model).camera
    fine = Camera(2 * camera.focal_px, 2 * camera.centre_px, 2 * camera.size_px, camera.position, camera.rotation)
    one = model.forecast(question)
    other = model.forecast(replace(question, camera=fine, pixels=2 * question.pixels))
    _same(model, replace(other, pixels=other.pixels / 2), one, "a video twice as fine")


def renaming(model: Any) -> None:
    """The order in which labels and things are listed does not matter."""
    question = watched(model)
    actions = len(question.labels) - 1 - question.actions
    other = replace(
        question, labels=question.labels[::-1], actions=actions, things=question.things[::-1],
        objects=question.objects[::-1],
    )  # fmt: skip
    _same(model, model.forecast(other), model.forecast(question), "names in another order")


def truth_unread(model: Any) -> None:
    """What is known in 3D is not read."""
    question = watched(model)
    known = replace(question, positions=np.full((*question.pixels.shape[:-1], 3), 7.0))
    _same(model, model.forecast(known), model.forecast(question), "a truth beside the question")


def earlier_steps(model: Any) -> None:
    """Steps before those that the model reads change nothing."""
    question = watched(model)
    pixels, actions = question.pixels.copy(), question.actions.copy()
    before = PAST - model.card.history
    pixels[:before] += 40
    actions[:before] = 0
    changed = replace(question, pixels=pixels, actions=actions)
    _same(model, model.forecast(changed), model.forecast(question), "steps that are long past")


def seed(model: Any) -> None:
    """The same seed gives the same steps, to the last bit; another gives others; the first sample is the usual one."""
    question = watched(model)
    one, again, other = (model.forecast(question, samples=6, seed=number) for number in (3, 3, 4))
    np.testing.assert_array_equal(one.poses, again.poses)
    np.testing.assert_array_equal(one.actions, again.actions)
    assert (one.poses[1:] != other.poses[1:]).any()
    alone = model.forecast(question)
    np.testing.assert_allclose(one.poses[0], alone.poses[0], atol=model.card.tolerance_m)
    np.testing.assert_allclose(one.weights.sum(), 1, atol=1e-6)


def fewer_steps(model: Any) -> None:
    """Asked for fewer steps it gives the first ones."""
    question = watched(model)
    few, many = model.forecast(question, steps=2), model.forecast(question, steps=5)
    np.testing.assert_allclose(few.poses, many.poses[:, :2], atol=model.card.tolerance_m)
    assert many.actions.shape[1] == 5


def apart_from_others(model: Any) -> None:
    """A question is answered as if no other had been asked: nothing is kept from one to the next."""
    question = watched(model)
    alone = model.forecast(question).poses
    for number in (1, 2):
        model.forecast(watched(model, number), samples=2)
    np.testing.assert_array_equal(model.forecast(question).poses, alone)


def question_untouched(model: Any) -> None:
    """The question is not written to."""
    question = watched(model)
    before = question.pixels.copy()
    for array in (question.pixels, question.actions, question.objects):
        array.setflags(write=False)
    model.forecast(question, samples=2)
    np.testing.assert_array_equal(question.pixels, before)


def gaps(model: Any) -> None:
    """Joints that are not seen, in some step or at last, do not make the answer fail; nor does a short past."""
    question = watched(model)
    pixels = question.pixels.copy()
    pixels[-1, 0, 4] = np.nan
    pixels[-3] = np.nan
    pixels[-2, :, 1] = np.nan
    answer = model.forecast(replace(question, pixels=pixels))
    assert np.isfinite(answer.poses).all()
    short = replace(question, pixels=question.pixels[-2:], actions=question.actions[-2:])
    answer = model.forecast(short)
    assert np.isfinite(answer.poses).all()
    assert answer.warnings


def nobody(model: Any) -> None:
    """People who are never seen are refused with a sentence."""
    question = watched(model)
    try:
        model.forecast(replace(question, pixels=np.full_like(question.pixels, np.nan)))
    except SceneError:
        return
    raise AssertionError("nobody was seen, and yet an answer came")


def unknown_names(model: Any) -> None:
    """An action, or a thing, that the model does not know is refused with a sentence that names it."""
    question = watched(model)
    wrong = [replace(question, labels=("juggle", *question.labels[1:]), actions=0 * question.actions)]
    if question.things:
        wrong.append(replace(question, things=("anvil", *question.things[1:]), objects=question.objects | True))
        wrong.append(replace(question, objects=question.objects & False))
    for other, name in zip(wrong, ("juggle", "anvil", "objects"), strict=False):
        said = ""
        try:
            model.forecast(other)
        except InputError as error:
            said = str(error)
        assert name in said, f"{name} was let through, or refused without its name: {said}"


def in_the_image(model: Any) -> None:
    """Poses in space fall where the answer says in the image, near where people were seen."""
    question = watched(model)
    answer = model.forecast(question, samples=3)
    np.testing.assert_allclose(answer.camera.project(answer.poses), answer.pixels, atol=0.5)
    trunk = np.linalg.norm(question.pixels[:, :, 1] - question.pixels[:, :, 8], axis=-1).max()
    assert np.abs(answer.pixels - question.pixels[-1, :, 1:2]).max() < 5 * trunk


ACTION_CLAUSES: dict[str, Callable[[Any], None]] = {
    clause.__name__: clause
    for clause in (
        moving, turning, resolution, renaming, truth_unread, earlier_steps, seed, fewer_steps, apart_from_others,
        question_untouched, gaps, nobody, unknown_names, in_the_image,
    )
}  # fmt: skip
