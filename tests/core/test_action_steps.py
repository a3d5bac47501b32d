"""What is checked of an answer in steps."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from motioncast.core.action_steps import ActionSteps
from motioncast.core.camera import look_at
from motioncast.core.card import ModelCard
from motioncast.errors import SceneError

CAMERA = look_at(np.array([3.0, 0, 1.5]), np.array([0, 0, 1.2]))
CARD = ModelCard("toy", "toy", "actions", "upper9", 4, 3, 1.0)


def answer() -> ActionSteps:
    poses = np.random.default_rng(0).normal((0, 0, 1.2), 0.2, (2, 3, 1, 9, 3))
    return ActionSteps(
        labels=("take", "cut"),
        actions=np.array([[[0], [1], [1]], [[1], [0], [1]]]),
        probabilities=np.full((2, 3, 1, 2), 0.5),
        poses=poses,
        pixels=CAMERA.project(poses),
        camera=CAMERA,
        past_actions=np.zeros((4, 1), int),
        past_pixels=np.full((4, 1, 9, 2), np.nan),
        card=CARD,
        people=("cook",),
        weights=np.array([0.3, 0.7]),
    )


def test_the_most_probable_sample_in_words_and_as_a_scene():
    steps = answer()
    assert steps.told(steps.best) == ["cut", "take", "cut"]
    np.testing.assert_allclose(steps.scene().positions, steps.poses[1], rtol=1e-6)


def test_shapes_that_disagree_and_numbers_that_are_not_finite_are_refused():
    with pytest.raises(SceneError, match=r"pixels .* shape"):
        replace(answer(), pixels=np.zeros((2, 3, 1, 8, 2)))
    with pytest.raises(SceneError, match='"toy" answered with poses'):
        replace(answer(), poses=np.full((2, 3, 1, 9, 3), np.nan))
