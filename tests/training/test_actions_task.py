"""Learning steps: batches, the critic's turns, export."""

from __future__ import annotations

import numpy as np
import pytest

torch = pytest.importorskip("torch")

from motioncast.core.card import ModelCard  # noqa: E402
from motioncast.datasets import kitchen  # noqa: E402
from motioncast.datasets.action_windows import cut_steps  # noqa: E402
from motioncast.inference.actions import ActionForecaster  # noqa: E402
from motioncast.models import build  # noqa: E402
from motioncast.models.futurehuman3d import Past  # noqa: E402
from motioncast.training import actions_task  # noqa: E402
from motioncast.training.actions_task import ActionsTask, overwritten  # noqa: E402
from motioncast.training.export_actions import export_actions  # noqa: E402
from motioncast.training.recipe import Recipe  # noqa: E402

pytestmark = pytest.mark.torch

SIZES = {"pose_width": 16, "action_width": 8, "object_width": 8, "width": 24, "decoder_width": 16, "noise": 4}


@pytest.fixture
def task(monkeypatch, tmp_path):
    monkeypatch.setattr(actions_task, "BANK", 256)
    monkeypatch.setattr(actions_task, "VALIDATION_SEQUENCES", 1)
    torch.manual_seed(0)
    recipe = Recipe(name="toy", model="futurehuman3d", sizes=SIZES, steps=10, batch=16, scenes=2, learning_rate=1e-3)
    return ActionsTask(recipe, build(recipe.model, recipe.sizes), tmp_path)


def test_the_critic_learns_and_the_generator_does_not_teach_it(task):
    batch = next(task.batches(np.random.default_rng(0)))
    before = [part.clone() for part in task.model.critic.parameters()]
    loss = task.loss(task.model, batch, torch.from_numpy)
    after = list(task.model.critic.parameters())
    assert any(not torch.equal(one, two) for one, two in zip(before, after, strict=True))
    loss.backward()
    assert all(part.grad is None for part in after)
    assert task.model.encoders[0].join[0].weight.grad.abs().max() > 0


def test_own_answers_end_the_past_and_the_target_lies_behind_them(task):
    task.drawn = 10_000
    random = np.random.default_rng(0)
    batch = task.batch(random)
    windows = task.train
    known = {pixels.tobytes() for pixels in windows.pixels[:, :10].reshape(-1, 10 * 18)}
    own = [row for row in range(16) if batch.past.pixels[row].numpy().tobytes() not in known]
    assert 0 < len(own) < 16


def test_rows_are_overwritten_and_others_stay(task):
    past = Past(*map(torch.from_numpy, task.train.past(10, slice(4))))
    other = overwritten(past, np.array([2]), Past(*(part[:1] for part in past)))
    assert torch.equal(other.pixels[2], past.pixels[0])
    assert torch.equal(other.pixels[3], past.pixels[3])
    assert not torch.equal(past.pixels[2], past.pixels[0])


def test_scores_are_shares(task):
    scores = task.scores(task.model)
    assert set(scores) == {"wrong", "pixels"}
    assert 0.5 < scores["wrong"] <= 1


def test_the_graph_answers_as_the_model_does_step_by_step(task, tmp_path):
    model = task.model.eval()
    card = ModelCard(
        "toy", "toy", "actions", "upper9", 10, 10, 1.0, people=1,
        needs={"labels": list(kitchen.LABELS), "objects": list(kitchen.OBJECTS), "noise": 4},
    )  # fmt: skip
    card = export_actions(model, card, tmp_path)
    assert card.parameters == sum(p.numel() for name, p in model.named_parameters() if "critic" not in name)
    with torch.no_grad():  # the file holds halved weights
        for part in model.parameters():
            part.copy_(part.half().float() if part.numel() >= 64 else part)
    sequence = kitchen.sequence("validation", 0)
    answer = ActionForecaster(card, tmp_path / "toy.onnx").forecast(sequence, steps=4)
    past = Past(*map(torch.from_numpy, cut_steps([sequence], 10, 0, 1).past(10, slice(-1, None))))
    for ahead in range(4):
        with torch.no_grad():
            step = model(past, model.silence(past))
        past = model.append(past, step)
        np.testing.assert_allclose(answer.pixels[0, ahead], step.pixels[0], atol=1e-2)
        np.testing.assert_allclose(answer.probabilities[0, ahead], step.logits[0].softmax(-1), atol=1e-4)
        assert answer.actions[0, ahead, 0] == step.logits[0].argmax()
        relative = answer.camera.seen(answer.poses[0, ahead]) - answer.camera.seen(answer.poses[0, ahead, :, [1]])
        np.testing.assert_allclose(relative[0], step.poses[0, 0], atol=1e-4)
