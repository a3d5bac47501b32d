"""Numbers that pin the published networks, and what the light one must and must not see."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

torch = pytest.importorskip("torch")

from motioncast.core import voxels as grid  # noqa: E402
from motioncast.models.characteristic_poses import PRESETS, CharacteristicPoses, placed  # noqa: E402
from motioncast.nn.voxels import (  # noqa: E402
    Doubling,
    JointHeads,
    cells_of,
    class_weights,
    corners,
    from_transposed,
    heat_classes,
    offsets_to,
)

pytestmark = pytest.mark.torch

TINY = PRESETS["tiny"]


def model_of(config=TINY) -> CharacteristicPoses:
    torch.manual_seed(0)
    return CharacteristicPoses(config).eval()


def poses(count: int = 2, hypotheses: int = 3) -> tuple[torch.Tensor, torch.Tensor]:
    random = torch.Generator().manual_seed(1)
    history = torch.randn(count, 10, 17, 3, generator=random) * 0.3
    return history, torch.randn(count, hypotheses, 2, 3, generator=random) * 0.4


@pytest.mark.parametrize("kind", ["paper", "release"])
@pytest.mark.parametrize(
    ("data", "stages", "total"),
    [("grab", (540_479, 553_727, 1_632_937), 2_727_143), ("h36m", (519_743, 532_991, 1_219_761), 2_272_495)],
)
def test_published_networks_have_as_many_parameters(kind: str, data: str, stages: tuple, total: int) -> None:
    model = CharacteristicPoses(PRESETS[f"{kind}-{data}"])
    assert tuple(sum(part.numel() for part in network.parameters()) for network in model.networks) == stages
    assert sum(parameter.numel() for parameter in model.parameters()) == total


def test_the_light_network_has_a_tenth_of_them() -> None:
    assert sum(part.numel() for part in CharacteristicPoses(PRESETS["light"]).parameters()) == 220_839


def test_published_networks_answer_for_the_joints_of_their_stage() -> None:
    history, known = poses(1, 2)
    with torch.no_grad():
        for kind in ("paper", "release"):
            model = model_of(PRESETS[f"{kind}-h36m"])
            said = model(history, known, 1)
            assert said.heat.shape == (2, 1, 10, 16, 16, 16)
            assert said.coarse.shape == (2, 1, 10, 8, 8, 8)
            assert said.offsets.shape == (2, 1, 3, 16, 16, 16)
            between = bool((said.heat >= 0).all() and (said.heat <= 1).all())
            assert between == (kind == "release")  # the release ends in a sigmoid before its cross entropy


def test_the_published_place_has_a_doubled_exponent() -> None:
    code = placed(torch.zeros(1, 25, 64), range(25))[0]
    assert code[3, 4].item() == pytest.approx(np.sin(3 / 10000 ** (8 / 64)), abs=1e-6)
    assert code[3, 5].item() == pytest.approx(np.cos(3 / 10000 ** (10 / 64)), abs=1e-6)


@pytest.mark.parametrize(("size", "padding", "stride"), [(3, 1, 1), (2, 0, 2)])
def test_plain_convolutions_are_the_transposed_ones(size: int, padding: int, stride: int) -> None:
    torch.manual_seed(0)
    twin = torch.nn.ConvTranspose3d(5, 7, size, stride, padding)
    plain = Doubling(5, 7) if size == 2 else torch.nn.Conv3d(5, 7, 3, padding=1)
    (plain.mix if size == 2 else plain).weight.data = from_transposed(twin.weight.data)
    assert twin.bias is not None
    assert plain.bias is not None
    plain.bias.data = twin.bias.data
    volume = torch.randn(2, 5, 4, 5, 6)
    torch.testing.assert_close(plain(volume), twin(volume), atol=1e-6, rtol=0)


def test_levels_and_kernel_of_a_target() -> None:
    heat = heat_classes(torch.zeros(3), 16)
    assert heat.unique().tolist() == [0, 4, 5, 6, 7, 8, 9]
    assert int((heat == 9).sum()) == 7  # the voxel and its six neighbours
    assert heat_classes(torch.zeros(3), 8).unique().tolist() == [0, 4, 6, 7, 9]
    assert [heat[8 + x, 8 + y, 8 + z].item() for x, y, z in ((1, 0, 0), (2, 0, 0), (2, 2, 2), (3, 0, 0))] == [
        9,
        7,
        4,
        0,
    ]
    at_edge = heat_classes(torch.tensor([5.0, -5.0, 0.0]), 16)
    assert at_edge.argmax().item() == np.ravel_multi_index((14, 0, 8), (16, 16, 16))  # first of the plateau
    assert at_edge[15, 0, 8] == 9


def test_the_grid_of_networks_is_that_of_core() -> None:
    points = torch.rand(50, 3, dtype=torch.float64) * 2.2 - 1.1
    np.testing.assert_array_equal(cells_of(points, 16).numpy(), grid.cell_of(points.numpy()))
    np.testing.assert_array_equal(corners(16).numpy(), grid.corner_of(np.arange(16)))


def test_class_weights_published_and_ours() -> None:
    release = {size: class_weights(size, release=True) for size in (16, 8)}
    for size, level, weight in (
        (16, 0, 0.1206), (16, 5, 0.5066), (16, 9, 1.2683),
        (8, 0, 0.1612), (8, 3, 0.3876), (8, 5, 0.5066), (8, 9, 1.2683),
    ):  # fmt: skip
        assert release[size][level].item() == pytest.approx(weight, abs=5e-5)
    assert int((release[16] > 0).sum()) == 3
    ours = class_weights(16)
    assert ours[0].item() == pytest.approx(0.1)
    assert ours[9].item() == pytest.approx(1 / np.log(1.2 + 7))
    assert (ours > 0).all()


def test_offsets_lead_to_the_joint_and_reach_one_voxel() -> None:
    point = torch.tensor([0.03, -0.41, 0.9])
    offsets = offsets_to(point, 16)
    cell = tuple(cells_of(point, 16).long().tolist())
    corner = torch.tensor(grid.corner_of(np.array(cell)), dtype=torch.float32)
    torch.testing.assert_close(corner + offsets[(slice(None), *cell)], point)
    assert offsets.abs().max() <= 0.125
    assert offsets[0, 0, 0, 0] == 0.125  # a far voxel points as far as it may


def test_heads_answer_for_the_joints_that_are_asked() -> None:
    heads, volume = JointHeads(4, 6, 3), torch.randn(2, 4, 3, 3, 3)
    whole, some = heads(volume, torch.arange(6)), heads(volume, torch.tensor([4, 1]))
    assert whole.shape == (2, 6, 3, 3, 3, 3)
    torch.testing.assert_close(some, whole[:, [4, 1]])


@torch.no_grad()
def test_hypotheses_at_once_are_as_one_by_one() -> None:
    model, (history, known) = model_of(), poses()
    together = model(history, known, 2)
    row = 0
    for person in range(2):
        for hypothesis in range(3):
            alone = model(history[[person]], known[[person]][:, [hypothesis]], 2)
            for one, whole in zip(alone, together, strict=True):
                torch.testing.assert_close(one[0], whole[row], atol=1e-6, rtol=0)
            row += 1


@torch.no_grad()
@pytest.mark.parametrize("preset", ["tiny", "paper-h36m"])
def test_a_stage_sees_the_hands_before_it_and_no_other(preset: str) -> None:
    model, (history, known) = model_of(PRESETS[preset]), poses(1, 1)
    for stage in range(3):
        for hand in range(2):
            other = known.clone()
            other[:, :, hand] += 0.2
            changed = (model(history, other, stage).heat - model(history, known, stage).heat).abs().max() > 1e-7
            assert bool(changed) == (hand < stage)


@torch.no_grad()
def test_stages_differ_and_the_rest_is_everything_but_the_hands() -> None:
    model, (history, known) = model_of(), poses(1, 1)
    asked = torch.tensor([5])
    assert (model(history, known, 0, asked).heat - model(history, known * 0, 2, asked).heat).abs().max() > 1e-4
    assert [len(stage) for stage in model.stages] == [1, 1, 15]
    assert sorted([*model.stages[0], *model.stages[1], *model.stages[2]]) == list(range(17))


@torch.no_grad()
def test_a_partner_is_a_set_of_tokens_and_nobody_is_none() -> None:
    model, (history, known) = model_of(replace(TINY, partner=True)), poses(2, 1)
    partner = history[:, -1] + torch.tensor([0.0, 0.8, 0.0])
    partner[1] = torch.nan
    both = model(history, known, 0, partner=partner).heat
    assert both.isfinite().all()
    moved = model(history, known, 0, partner=partner + 0.3).heat
    assert (moved[0] - both[0]).abs().max() > 1e-6
    assert torch.equal(moved[1], both[1])


@torch.no_grad()
@pytest.mark.parametrize("preset", ["tiny", "paper-h36m"])
def test_an_action_is_a_token(preset: str) -> None:
    model, (history, known) = model_of(replace(PRESETS[preset], actions=3)), poses(1, 1)
    one, other = (model(history, known, 0, action=torch.tensor([label])).heat for label in (0, 2))
    assert (one - other).abs().max() > 1e-7


def test_the_second_phase_moves_offsets_alone() -> None:
    model, (history, _) = model_of(), poses(4)
    target = history[:, -1] + 0.05
    model.train().learn_offsets()
    # made-up heat that is hot everywhere, so that offsets count
    model.networks[0].heads.bias.data[:, 9] = 50.0
    before = {name: value.clone() for name, value in model.state_dict().items()}
    optimiser = torch.optim.AdamW([part for part in model.parameters() if part.requires_grad], 1e-2)
    losses = []
    for _ in range(5):
        loss = model.loss(history, target, 2)
        loss.backward()
        optimiser.step()
        optimiser.zero_grad()
        losses.append(loss.item())
    assert losses[-1] < losses[0]
    moved = {name for name, value in model.state_dict().items() if not torch.equal(value, before[name])}
    assert moved
    assert all("offset" in name for name in moved)


def test_offsets_are_not_learned_where_nothing_is_hot() -> None:
    model, (history, known) = model_of(), poses(2, 1)
    said = model(history, known, 0)
    target = history[:, -1, [16]]
    cold = said._replace(heat=torch.nn.functional.one_hot(torch.zeros(2, 1, 8, 8, 8).long(), 10).movedim(-1, 2).float())
    assert model.offset_loss(cold, target).item() == 0


def test_a_tiny_network_learns_where_hands_go() -> None:
    torch.manual_seed(0)
    model, random = CharacteristicPoses(TINY), np.random.default_rng(0)
    optimiser = torch.optim.AdamW(model.parameters(), 1e-2)
    history = torch.from_numpy(random.normal(0, 0.3, (16, 10, 17, 3)).astype(np.float32))
    target = torch.zeros(16, 17, 3)
    target[:8, 16, 0], target[8:, 16, 0] = 0.6, -0.6
    history[:8, :, 16, 0], history[8:, :, 16, 0] = 0.5, -0.5
    for _ in range(60):
        loss = model.loss(history, target, 0)
        loss.backward()
        optimiser.step()
        optimiser.zero_grad()
    with torch.no_grad():
        said = model.eval()(history, target[:, None, [16, 13]], 0)
    levels = said.heat[:, 0].softmax(1).mul(torch.arange(10)[:, None, None, None]).sum(1)
    column = levels.flatten(2).sum(-1).argmax(1)
    assert (column[:8] > 4).all()
    assert (column[8:] < 4).all()
