"""FutureHuman3D: projection, critic, what is read, two people."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

torch = pytest.importorskip("torch")

from motioncast.core.skeletons import UPPER9  # noqa: E402
from motioncast.core.upper_body import NECK  # noqa: E402
from motioncast.datasets import kitchen  # noqa: E402
from motioncast.datasets.action_windows import cut_steps  # noqa: E402
from motioncast.models.futurehuman3d import PRESETS, FutureHuman3D, FutureHuman3DConfig, Past, project  # noqa: E402
from motioncast.nn.pose_critic import PoseCritic, kinematic_chain  # noqa: E402

pytestmark = pytest.mark.torch

SMALL = FutureHuman3DConfig(pose_width=16, action_width=8, object_width=8, width=24, decoder_width=16)


def asked(people: int = 1, count: int = 3) -> Past:
    windows = cut_steps(kitchen.sequences("train", 1, people=people), 10, 10)
    return Past(*map(torch.from_numpy, windows.past(10, slice(count))))


def test_the_papers_size():
    model = FutureHuman3D(PRESETS["paper"])
    made = sum(part.numel() for name, part in model.named_parameters() if not name.startswith("critic"))
    assert made == 1_323_389
    assert sum(part.numel() for part in model.critic.parameters()) == 80_001


def test_projection_is_the_cameras():
    sequence = kitchen.sequence("train", 0)
    camera = sequence.camera
    seen = camera.seen(sequence.positions)
    neck = seen[:, :, NECK]
    pixels = camera.project(sequence.positions)
    rays, depth = neck[..., :2] / -neck[..., 2:], -neck[..., 2]
    told = (torch.from_numpy(part) for part in (seen - neck[:, :, None], rays, depth))
    offsets = project(*told).numpy() * camera.focal_px / depth[..., None, None] * [1, -1]
    np.testing.assert_allclose(offsets, pixels - pixels[:, :, [NECK]], atol=1e-6)


def test_where_people_stand_in_the_image_moves_their_answer_likewise():
    model, past = FutureHuman3D(SMALL).eval(), asked()
    shift = torch.tensor([31.0, -12.0])
    moved = past._replace(pixels=past.pixels + shift, camera=past.camera + torch.tensor([0, 31.0, -12.0]))
    for one, other in zip(model(past, model.silence(past)), model(moved, model.silence(past)), strict=True):
        shifted = one + shift if one.shape[-1] == 2 else one
        torch.testing.assert_close(other, shifted, atol=1e-3, rtol=1e-4)


def test_steps_before_the_first_change_nothing():
    model, past = FutureHuman3D(SMALL).eval(), asked()
    seen, actions = past.seen.clone(), past.actions.clone()
    seen[:, :4], actions[:, :4] = False, -1
    short = past._replace(seen=seen, actions=actions)
    other = short._replace(pixels=torch.cat([past.pixels[:, :4] + 50, past.pixels[:, 4:]], 1))
    torch.testing.assert_close(model(short, model.silence(past)).poses, model(other, model.silence(past)).poses)


@pytest.mark.parametrize(("hidden", "field"), [("reads_poses", "pixels"), ("reads_actions", "actions")])
def test_ablations_do_not_read(hidden, field):
    model, past = FutureHuman3D(replace(SMALL, **{hidden: False})).eval(), asked()
    changed = getattr(past, field).clone()
    changed[:, 3] = changed[:, 2] + (5 if field == "pixels" else 0)
    same = model(past, model.silence(past)), model(past._replace(**{field: changed}), model.silence(past))
    torch.testing.assert_close(same[0].logits, same[1].logits)


def test_without_objects_none_are_read():
    model, past = FutureHuman3D(replace(SMALL, objects=0)).eval(), asked()
    other = past._replace(objects=1 - past.objects)
    assert torch.equal(model(past, model.silence(past)).logits, model(other, model.silence(past)).logits)


def test_two_people_tell_each_other_only_when_pooled():
    past = asked(people=2)
    actions = past.actions.clone()
    actions[:, -1, 1] = (actions[:, -1, 1] + 1) % 14
    for pooled in (True, False):
        model = FutureHuman3D(replace(SMALL, people=2, pooled=pooled)).eval()
        one, other = (model(told, model.silence(past)).logits[:, 0] for told in (past, past._replace(actions=actions)))
        assert torch.equal(one, other) is not pooled


def test_the_pose_that_it_starts_from():
    model, pose = FutureHuman3D(SMALL), torch.from_numpy(kitchen.bank(20).mean(0))
    decoder = model.decoders[0]
    decoder.start_from(pose)
    _, answered = decoder(torch.zeros(1, SMALL.width))
    offset = answered[0] - pose
    torch.testing.assert_close(offset[NECK], torch.zeros(3))
    assert offset.abs().max() < 0.3


def test_the_loss_is_zero_where_the_pose_is_right_and_the_action_sure():
    model, past = FutureHuman3D(replace(SMALL, critic_weight=0.0, action_weight=0.0)).eval(), asked()
    step = model(past, model.silence(past))
    actions = torch.zeros(3, 1, dtype=torch.int64)
    seen = torch.ones(3, 1, 9, dtype=torch.bool)
    exact = model.loss(past, model.silence(past), actions, step.pixels.detach(), seen)
    assert exact.item() == pytest.approx(0, abs=1e-6)
    off = step.pixels.detach().clone()
    off[:, :, 4] += 20
    seen[:, :, 4] = False
    assert model.loss(past, model.silence(past), actions, off, seen).item() == pytest.approx(0, abs=1e-6)


def test_the_kinematic_chain_holds_lengths_and_angles():
    poses = torch.from_numpy(kitchen.bank(4))
    chain = kinematic_chain(poses, UPPER9.bones)
    for row, (a, b) in enumerate(UPPER9.bones):
        for column, (c, d) in enumerate(UPPER9.bones):
            naive = ((poses[2, a] - poses[2, b]) * (poses[2, c] - poses[2, d])).sum()
            torch.testing.assert_close(chain[2, row, column], naive)


def test_the_critic_learns_to_tell_real_from_made_up():
    torch.manual_seed(0)
    critic, real = PoseCritic(UPPER9, 32), torch.from_numpy(kitchen.bank(64))
    made = real + 0.15 * torch.randn_like(real)
    optimiser = torch.optim.Adam(critic.parameters(), 3e-3)
    for _ in range(40):
        optimiser.zero_grad()
        critic.loss(real, made).backward()
        optimiser.step()
    assert critic(real).mean() > critic(made).mean() + 0.05
