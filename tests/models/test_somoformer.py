from __future__ import annotations

import pytest

torch = pytest.importorskip("torch")

from motioncast.datasets.mixer import turned  # noqa: E402
from motioncast.errors import InputError  # noqa: E402
from motioncast.models.somoformer import (  # noqa: E402
    SoMoFormer,
    SoMoFormerConfig,
    from_release,
)
from motioncast.nn.dct import dct_matrix  # noqa: E402
from motioncast.nn.gaps import fill_gaps  # noqa: E402

pytestmark = pytest.mark.torch

SMALL = {"width": 32, "layers": 2, "heads": 4, "feed_forward": 64, "grid_width": 4}


def scene(people: int = 3, batch: int = 2, history: int = 15) -> tuple[torch.Tensor, torch.Tensor]:
    generator = torch.Generator().manual_seed(0)
    positions = torch.randn(batch, history, people, 15, 3, generator=generator)
    return positions, torch.ones(batch, history, people, 15, dtype=torch.bool)


@pytest.fixture(scope="module")
def model() -> SoMoFormer:
    torch.manual_seed(0)
    return SoMoFormer(SoMoFormerConfig(**SMALL)).eval()


@pytest.mark.parametrize(("sizes", "count"), [((), 4_882_842), (("mrt15", 15, 45), 4_898_736)])
def test_the_release_has_its_number_of_parameters(sizes: tuple, count: int) -> None:
    model = SoMoFormer(SoMoFormerConfig.release(*sizes))
    assert sum(parameter.numel() for parameter in model.parameters()) == count


def test_the_papers_preset_has_the_number_that_follows_from_its_sizes() -> None:
    model = SoMoFormer(SoMoFormerConfig())
    layers, frames, content, joints, people, grid = 6 * 789_760, 60, 248, 15, 16, 8
    count = layers + (frames + 1) * content + (3 * joints + people) * content + 25 * grid + 257 * frames
    assert sum(parameter.numel() for parameter in model.parameters()) == count


def test_dct_is_over_time_and_invertible() -> None:
    matrix = dct_matrix(60)
    torch.testing.assert_close(matrix @ matrix.T, torch.eye(60), atol=1e-6, rtol=0)
    constant = matrix @ torch.ones(60)
    torch.testing.assert_close(constant[0], torch.tensor(60.0).sqrt())
    assert constant[1:].abs().max() < 1e-5


def test_a_zero_head_repeats_the_last_pose() -> None:
    model = SoMoFormer(SoMoFormerConfig(**SMALL)).eval()
    torch.nn.init.zeros_(model.head.weight)
    torch.nn.init.zeros_(model.head.bias)
    history, observed = scene()
    for answer in model(history, observed):
        torch.testing.assert_close(answer, history[:, -1:].expand_as(answer), atol=1e-5, rtol=0)


def test_absent_people_change_nothing(model: SoMoFormer) -> None:
    history, observed = scene()
    alone = model(history[:, :, :2], observed[:, :, :2])[-1]
    gone = observed.clone()
    gone[:, -1, 2] = False  # was there, and has left
    for seen in (gone, observed & (torch.arange(3) < 2)[:, None]):
        torch.testing.assert_close(model(history, seen)[-1][:, :, :2], alone, atol=1e-5, rtol=0)


def test_every_row_of_the_person_table_is_trained() -> None:
    torch.manual_seed(0)
    training = SoMoFormer(SoMoFormerConfig(**SMALL)).train()
    history, observed = scene()
    for _ in range(40):
        training(history, observed)[-1].sum().backward()
    gradient = training.person.weight.grad
    assert gradient is not None
    assert (gradient.abs().sum(1) > 0).all()


def test_in_the_release_absent_people_do_change_the_answer() -> None:
    torch.manual_seed(0)
    model = SoMoFormer(SoMoFormerConfig(preset="release", cells=3, **SMALL)).eval()
    history, observed = scene()
    observed[:, :, 2] = False
    other, seen = history.clone(), observed.clone()
    alone = model(history[:, :, :2], observed[:, :, :2])[-1]
    assert (model(other, seen)[-1][:, :, :2] - alone).abs().max() > 1e-3


def test_moving_the_scene_moves_the_answer(model: SoMoFormer) -> None:
    history, observed = scene()
    shift = torch.tensor([3.0, -2.0, 0.5])
    moved, still = model(history + shift, observed)[-1], model(history, observed)[-1]
    torch.testing.assert_close(moved, still + shift, atol=1e-5, rtol=0)


def test_re_ordering_people_with_their_rows_re_orders_the_answer(model: SoMoFormer) -> None:
    history, observed = scene()
    order = [2, 0, 1]
    shuffled = SoMoFormer(SoMoFormerConfig(**SMALL)).eval()
    shuffled.load_state_dict(model.state_dict())
    shuffled.person.weight.data[:3] = model.person.weight.data[order]
    torch.testing.assert_close(
        shuffled(history[:, :, order], observed)[-1], model(history, observed)[-1][:, :, order], atol=1e-5, rtol=0
    )


def test_every_cell_of_the_grid_is_reached(model: SoMoFormer) -> None:
    x, y = torch.meshgrid(torch.linspace(-4.9, 4.9, 20), torch.linspace(-4.9, 4.9, 20), indexing="ij")
    neck = torch.stack([x.flatten(), y.flatten(), torch.ones(400)], -1)[None]
    cells = model.cell(neck, torch.ones(1, 400, dtype=torch.bool))
    assert len(torch.unique(cells[0], dim=0)) == 25


def test_the_releases_grid_is_constant_within_its_extent() -> None:
    model = SoMoFormer(SoMoFormerConfig(preset="release", cells=3, **SMALL))
    neck = torch.rand(1, 400, 3) * 5.9 - 2.95
    assert len(torch.unique(model.cell(neck, torch.ones(1, 400, dtype=torch.bool))[0], dim=0)) == 1


def test_attention_can_be_asked_for_and_sums_to_one(model: SoMoFormer) -> None:
    history, observed = scene()
    weights: list[torch.Tensor] = []
    asked = model(history, observed, weights)[-1]
    assert [tuple(layer.shape) for layer in weights] == [(2, 4, 135, 135)] * 2
    torch.testing.assert_close(weights[0].sum(-1), torch.ones(2, 4, 135))
    torch.testing.assert_close(asked, model(history, observed)[-1], atol=1e-5, rtol=0)


def test_loss_weighs_layers_as_the_equation_does(model: SoMoFormer) -> None:
    truth, observed = torch.zeros(1, 45, 1, 15, 3), torch.ones(1, 45, 1, 15, dtype=torch.bool)
    answers = [truth + torch.tensor([size, 0.0, 0.0]) for size in (1.0, 2.0)]
    assert model.loss(answers, truth, observed).item() == pytest.approx(2.0 + 0.2 * 1.0, rel=1e-4)
    squared = SoMoFormer(SoMoFormerConfig(squared=True, **SMALL))
    assert squared.loss(answers, truth, observed).item() == pytest.approx(4.0 + 0.2 * 1.0)
    released = SoMoFormer(SoMoFormerConfig(preset="release", cells=3, **SMALL))
    assert released.loss(answers, truth, observed).item() == pytest.approx((1.2 * 2.0 + 0.2) / 1.4, rel=1e-4)


def test_statistics_standardise_the_padded_trajectory(model: SoMoFormer) -> None:
    fitted = SoMoFormer(SoMoFormerConfig(**SMALL))
    history, _ = scene(batch=20)
    fitted.fit_statistics(history)
    neck = history[:, -1:, :, fitted.neck : fitted.neck + 1]
    values = fitted.standardised(history - neck).flatten(0, 3)
    assert values.mean(0).abs().max() < 1e-3
    assert values.std(0).max() < 1.001


def test_gaps_are_filled_by_the_last_and_the_first_seen_place() -> None:
    history = torch.arange(5.0).view(1, 5, 1, 1, 1).expand(1, 5, 1, 2, 3).clone()
    observed = torch.tensor([False, True, False, True, False]).view(1, 5, 1, 1).expand(1, 5, 1, 2).clone()
    assert fill_gaps(history, observed)[0, :, 0, 0, 0].tolist() == [1, 1, 1, 3, 3]
    observed[:, -1, 0, 1] = True  # the other joint is seen at last: it stands for one that never was
    observed[:, :, 0, 0] = False
    assert fill_gaps(history, observed)[0, :, 0, 0, 0].tolist() == [4, 4, 4, 4, 4]


def test_a_row_a_joint_serves_its_three_coordinates() -> None:
    torch.manual_seed(0)
    small = SoMoFormer(SoMoFormerConfig(joint_rows="joint", **SMALL)).eval()
    assert small.joint.weight.shape == (15, 28)
    large = SoMoFormer(SoMoFormerConfig(**SMALL)).eval()
    state = small.state_dict()
    large.load_state_dict({**state, "joint.weight": state["joint.weight"].repeat_interleave(3, 0)})
    history, observed = scene()
    torch.testing.assert_close(small(history, observed)[-1], large(history, observed)[-1])


def test_turning_and_re_ordering_a_scene_commute_with_its_encoding(model: SoMoFormer) -> None:
    """What the training's augmentation does to positions it does to the encoded scene: poses and places alike."""
    history, observed = scene(batch=1)
    present, neck = observed[:, -1].any(-1), history[:, -1, :, model.neck]
    between = neck[:, 1] - neck[:, 0]
    angle = torch.pi / 2
    around = torch.from_numpy(turned(history.numpy(), angle))
    beside = around[:, -1, :, model.neck]
    # the way from person to person turns with them; the release turns each about the own neck only
    torch.testing.assert_close(beside[:, 1] - beside[:, 0], torch.from_numpy(turned(between.numpy(), angle)))

    def coefficients(history: torch.Tensor) -> torch.Tensor:
        return model.coefficients(history - history[:, -1:, :, model.neck : model.neck + 1])

    x, y, z = coefficients(history).unbind(3)
    torch.testing.assert_close(coefficients(around), torch.stack([-y, x, z], 3), atol=1e-5, rtol=0)
    order = [2, 0, 1]
    torch.testing.assert_close(coefficients(history[:, :, order]), coefficients(history)[:, order])
    cells = model.config.cells

    def places(neck: torch.Tensor) -> torch.Tensor:
        """Column and row of each person's cell."""
        embedded = model.cell(neck, present)[0]
        index = (embedded[:, None] == model.grid.weight).all(-1).int().argmax(1)
        return torch.stack([index // cells, index % cells], -1)

    column, row = places(neck).unbind(-1)
    assert torch.equal(places(beside), torch.stack([cells - 1 - row, column], -1))
    assert torch.equal(places(neck[:, order]), places(neck)[order])


def authors_state(frames: int = 30, joints: int = 13) -> dict[str, torch.Tensor]:
    """Random weights under the names of the authors' checkpoints."""
    generator = torch.Generator().manual_seed(0)
    shapes: dict[str, tuple[int, ...]] = {
        "x_embed.weight": (3, 8), "y_embed.weight": (3, 8), "fc_in.weight": (248, frames), "fc_in.bias": (248,),
        "double_id_encoder.learned_encoding.weight": (3 * joints, 124),
        "double_id_encoder.person_encoding.weight": (1000, 124),
        "fc_out.weight": (frames, 256), "fc_out.bias": (frames,), "id_encoder.pe": (5000, 1, 64),
    }  # fmt: skip
    layer = torch.nn.TransformerEncoderLayer(256, 8, 1024)
    for number in range(6):
        shapes |= {f"transformer.layers.{number}.{name}": tuple(v.shape) for name, v in layer.state_dict().items()}
    return {name: 0.1 * torch.randn(shape, generator=generator) for name, shape in shapes.items()}


MEAN, DEVIATION = torch.linspace(-0.05, 0.05, 30), torch.linspace(0.5, 0.01, 30)


def as_the_authors_compute(state: dict[str, torch.Tensor], history: torch.Tensor) -> torch.Tensor:
    """Their last layer's answer for one scene ``(16, people, 13, 3)``, y up, all people there, near the origin."""
    people, neck = history.shape[1], history[-1:, :, 6:7]
    padded = torch.cat([history - neck, (history - neck)[-1:].expand(14, -1, -1, -1)])
    matrix, mean, deviation = dct_matrix(30), MEAN, DEVIATION
    coefficients = ((matrix @ padded.flatten(1)).T - mean) / deviation
    tokens = coefficients @ state["fc_in.weight"].T + state["fc_in.bias"]
    tables = [state[f"double_id_encoder.{name}_encoding.weight"] for name in ("learned", "person")]
    joint, person = (table / table.norm(dim=1, keepdim=True).clamp(min=1) for table in tables)
    tokens[:, 0::2] += joint.repeat(people, 1)
    tokens[:, 1::2] += person[:people].repeat_interleave(39, 0)
    cell = (state["x_embed.weight"][0] + state["y_embed.weight"][0]).expand(len(tokens), -1)
    tokens = torch.cat([tokens, cell], 1)[:, None]
    for number in range(6):
        layer = torch.nn.TransformerEncoderLayer(256, 8, 1024).eval()
        start = f"transformer.layers.{number}."
        layer.load_state_dict({k.removeprefix(start): v for k, v in state.items() if k.startswith(start)})
        tokens = layer(tokens)
    changed = coefficients + tokens[:, 0] @ state["fc_out.weight"].T + state["fc_out.bias"]
    return ((changed * deviation + mean) @ matrix).T.view(30, people, 13, 3)[16:] + neck


@torch.no_grad()
def test_weights_of_the_authors_answer_as_in_their_world() -> None:
    state = authors_state()
    model = SoMoFormer(SoMoFormerConfig.release()).eval()
    model.load_state_dict(from_release(state, MEAN, DEVIATION))
    y_up = 0.5 * torch.randn(16, 2, 13, 3, generator=torch.Generator().manual_seed(1))
    ours = model(y_up[None][..., [2, 0, 1]], torch.ones(1, 16, 2, 13, dtype=torch.bool))[-1][0]
    torch.testing.assert_close(ours[..., [1, 2, 0]], as_the_authors_compute(state, y_up), atol=1e-4, rtol=0)


def test_a_state_of_another_model_is_refused() -> None:
    state = authors_state()
    with pytest.raises(InputError, match=r"fc_out\.weight"):
        from_release({name: value for name, value in state.items() if name != "fc_out.weight"}, MEAN, DEVIATION)
    with pytest.raises(InputError, match="60 coefficients"):
        from_release(authors_state(frames=60), MEAN, DEVIATION)


def test_the_baseline_knows_neither_joint_nor_person_nor_place() -> None:
    torch.manual_seed(0)
    baseline = SoMoFormer(SoMoFormerConfig(**{**SMALL, "grid_width": 0}, embeddings=False)).eval()
    history, observed = scene()
    answer = baseline(history, observed)[-1]
    order = [2, 0, 1]
    torch.testing.assert_close(baseline(history[:, :, order], observed)[-1], answer[:, :, order], atol=1e-5, rtol=0)
    # farther apart, all is as it was but for the place
    apart = torch.arange(3.0)[:, None, None].expand(3, 1, 3)
    torch.testing.assert_close(baseline(history + apart, observed)[-1], answer + apart, atol=1e-5, rtol=0)


def test_people_who_keep_their_order_train_only_the_first_rows() -> None:
    training = SoMoFormer(SoMoFormerConfig(permuted=False, **SMALL)).train()
    training(*scene())[-1].sum().backward()
    gradient = training.person.weight.grad
    assert gradient is not None
    assert (gradient.abs().sum(1) > 0).tolist() == [True] * 3 + [False] * 13
