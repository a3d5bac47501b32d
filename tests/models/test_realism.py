from __future__ import annotations

import numpy as np
import pytest

torch = pytest.importorskip("torch")

from motioncast.nn.realism import FRAMES, HOP, Realism, fit, realism_until, snippets_of  # noqa: E402

pytestmark = pytest.mark.torch

HIPS = (0, 1)


def motions(count: int, frames: int, joints: int = 3) -> np.ndarray:
    random = np.random.default_rng(0)
    steps = np.cumsum(random.normal(scale=0.01, size=(count, frames, joints, 3)), 1)
    return steps + random.normal(size=(count, 1, joints, 3))


@pytest.mark.parametrize(("joints", "count"), [(17, 284_385), (29, 480_993)])
def test_parameters(joints: int, count: int) -> None:
    assert sum(parameter.numel() for parameter in Realism(joints).parameters()) == count


def test_naive_twin_of_the_network() -> None:
    torch.manual_seed(0)
    model = Realism(3)
    snippet = torch.randn(FRAMES, 3, 3)
    times = torch.arange(FRAMES, dtype=torch.float64)
    features = []
    for joint in range(3):
        trajectories = []
        for axis in range(3):
            for order in range(FRAMES):
                size = (1 / FRAMES if order == 0 else 2 / FRAMES) ** 0.5
                wave = size * torch.cos(torch.pi / (2 * FRAMES) * (2 * times + 1) * order)
                trajectories.append(float((wave * snippet[:, joint, axis]).sum()))
        # a joint's x, y and z stand one after another, in an order that all joints share
        by_axis = torch.tensor(trajectories).view(3, FRAMES)
        features.append(torch.relu(model.joint(by_axis.T.flatten())))
    expected = model.verdict(torch.relu(model.body(torch.cat(features))))
    torch.testing.assert_close(model(snippet[None]), expected, atol=1e-4, rtol=1e-4)


def test_where_a_person_is_and_looks_does_not_matter() -> None:
    motion = motions(2, 80)
    turn = np.array([[0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    moved = snippets_of(motion @ turn + [4.0, -2.0, 0.0], HIPS)
    torch.testing.assert_close(moved, snippets_of(motion, HIPS), atol=1e-5, rtol=0)


def test_scores_are_running_means_over_snippets() -> None:
    torch.manual_seed(1)
    model, motion = Realism(3), motions(2, 50 + 3 * HOP)
    until = realism_until(model, motion, HIPS)
    assert until.shape == (2, 4)
    for person in range(2):
        alone = [
            realism_until(model, motion[person, start : start + FRAMES], HIPS)[0] for start in range(0, 4 * HOP, HOP)
        ]
        np.testing.assert_allclose(until[person], [np.mean(alone[: end + 1]) for end in range(4)], atol=1e-6)
    assert np.all((until > 0) & (until < 1))


def test_it_learns_to_tell_swinging_people_from_frozen_ones() -> None:
    random = np.random.default_rng(1)
    pose = random.normal(size=(3, 3))
    phase = random.uniform(0, 2 * np.pi, (60, 1, 3, 1))
    swinging = pose + 0.5 * np.sin(np.arange(FRAMES)[:, None, None] / 4 + phase)
    frozen = np.repeat(swinging[:, :1], FRAMES, 1)
    real, made_up = (snippets_of(part, HIPS)[:, 0] for part in (swinging, frozen))
    model = fit(real[:40], made_up[:40], epochs=30)
    assert realism_until(model, swinging[40:], HIPS).mean() > 0.7
    assert realism_until(model, frozen[40:], HIPS).mean() < 0.3


def test_training_is_repeatable_and_leaves_the_random_state_alone() -> None:
    torch.manual_seed(3)
    before = torch.get_rng_state()
    snippets = snippets_of(motions(6, FRAMES), HIPS)[:, 0]
    one, other = (fit(snippets[:3], snippets[3:], seed=5, epochs=1) for _ in range(2))
    torch.testing.assert_close(one(snippets), other(snippets))
    assert torch.equal(before, torch.get_rng_state())
