from __future__ import annotations

from dataclasses import replace
from typing import Any

import pytest

torch = pytest.importorskip("torch")

from torch.nn import functional  # noqa: E402
from torch.overrides import TorchFunctionMode  # noqa: E402

from motioncast.core.basis_points import WIDTH  # noqa: E402
from motioncast.core.skeletons import SKELETONS  # noqa: E402
from motioncast.models.sast import PRESETS, SAST, SASTConfig  # noqa: E402
from motioncast.nn.frames import turn  # noqa: E402

pytestmark = pytest.mark.torch

SMALL = {
    "history": 9, "horizon": 18, "channels": (32, 32, 64), "others_channels": (32, 32, 32), "scene_width": 32,
    "scene_layers": 1, "people_width": 32, "people_layers": 2,
}  # fmt: skip
OURS = SASTConfig(**SMALL)
RELEASE = SASTConfig(preset="release", **(SMALL | {"horizon": 23}))
"""What is published takes whole tokens only."""


def model_of(config: SASTConfig) -> SAST:
    torch.manual_seed(0)
    model = SAST(config).eval()
    for parameter in model.decoder.blocks[-1].parameters():
        torch.nn.init.normal_(parameter, std=0.03)
    return model


@pytest.fixture(scope="module")
def ours() -> SAST:
    return model_of(OURS)


@pytest.fixture(scope="module")
def release() -> SAST:
    return model_of(RELEASE)


def inputs(config: SASTConfig, people: int = 3, objects: int = 4, batch: int = 1) -> dict[str, torch.Tensor]:
    random = torch.Generator().manual_seed(1)
    joints = len(SKELETONS[config.skeleton])

    def normal(*size: int) -> torch.Tensor:
        return torch.randn(size, generator=random)

    return {
        "history": normal(batch, config.history, people, joints, 3),
        "observed": torch.ones(batch, config.history, people, dtype=torch.bool),
        "noisy": normal(batch, people, config.horizon, joints, 3),
        "estimate": normal(batch, config.horizon, people, joints, 3),
        "level": torch.tensor(3.0),
        "codes": torch.rand(batch, people, objects, WIDTH, generator=random) * 4,
        "there": torch.ones(batch, objects, dtype=torch.bool),
    }


@torch.no_grad()
def answer(model: SAST, given: dict[str, torch.Tensor]) -> tuple[torch.Tensor, torch.Tensor]:
    rest = {name: value for name, value in given.items() if name != "codes"}
    return model(**rest, memory=model.encode_objects(given["codes"], given["there"]))


def count(module: torch.nn.Module) -> int:
    return sum(parameter.numel() for parameter in module.parameters())


def test_the_release_has_its_parameters_module_by_module() -> None:
    model = SAST(PRESETS["release"])
    assert count(model) == 15_458_346
    assert sum(parameter.numel() for parameter in model.parameters() if parameter.requires_grad) == 15_458_314
    counts = {name: count(module) for name, module in model.named_children()}
    assert counts == {
        "scaling": 0, "code": 32, "encoder": 2_903_296, "others_encoder": 351_488, "scene": 6_321_408,
        "people": 1_074_432, "decoder": 4_807_690,
    }  # fmt: skip
    assert list(map(count, model.encoder.blocks)) == [225_024, 543_232, 2_135_040]
    assert list(map(count, model.others_encoder.blocks)) == [103_168, 124_160, 124_160]
    assert list(map(count, model.decoder.blocks)) == [3_575_552, 903_040, 329_098]
    scene, people = model.scene, model.people
    assert count(scene.objects) == 527_872
    assert [count(scene.reader.inward), count(scene.reader.outward)] == [131_328, 131_584]
    assert count(scene.encoder) + count(scene.norm) == 2_369_792
    assert count(scene.reader.layers) + count(scene.reader.norm) == 3_160_832
    assert [count(people.reader.inward), count(people.people), count(people.reader.outward)] == [65_664, 16_512, 66_048]
    assert count(people.encoder) + count(people.norm) == 396_800
    assert count(people.reader.layers) + count(people.reader.norm) == 529_408


def test_the_release_halves_and_doubles_304_frames() -> None:
    model = SAST(PRESETS["release"]).eval()
    code = torch.zeros(1, 64)
    bottom, skips = model.encoder(torch.zeros(1, 304, 174), code)
    assert bottom.shape == (1, 38, 512)
    assert [tuple(skip.shape[1:]) for skip in skips] == [(304, 128), (152, 256), (76, 512)]
    assert model.decoder(bottom, skips, code).shape == (1, 304, 174)


class Products(TorchFunctionMode):
    """Counts the operations of all matrix products instead of computing them."""

    operations = 0

    def __torch_function__(self, function, types, arguments=(), options=None):
        if function is functional.linear:
            left, right = arguments[0], arguments[1].transpose(0, 1)
        elif function is torch.Tensor.matmul:  # the operator @
            left, right = arguments
        elif function is functional.scaled_dot_product_attention:
            query, key, _ = arguments
            self.operations += 4 * query.numel() * key.shape[-2]
            return query
        else:
            return function(*arguments, **(options or {}))
        result = left.new_empty(*left.shape[:-1], right.shape[-1])
        self.operations += 2 * result.numel() * left.shape[-1]
        return result


@pytest.mark.parametrize(("people", "objects", "most"), [(1, 30, 1.9), (3, 30, 6.4), (16, 50, 65.0)])
def test_the_release_does_not_compute_more_than_published(people: int, objects: int, most: float) -> None:
    config = PRESETS["release"]
    with Products() as products:
        answer(SAST(config).eval(), inputs(config, people, objects))
    assert 0.8 * most < round(products.operations / 1e9, 1) <= most


def test_people_of_a_frame_cost_less_than_all_frames_behind_a_mask() -> None:
    """7.3 of the 12.5 GFLOP of 16 people's encoder are left: what is not seen in another frame is not computed."""
    people, features = SAST(PRESETS["release"]).people.eval(), torch.zeros(16, 38, 15, 128)
    hidden = torch.zeros(16, 15, dtype=torch.bool)
    spent = []
    for encoder in (people.encoder, torch.nn.ModuleList()):
        people.encoder = encoder
        with Products() as products, torch.no_grad():
            people(torch.zeros(16, 38, 512), features, hidden)
        spent.append(products.operations)
    assert round((spent[0] - spent[1]) / 1e9, 1) == 7.3


@pytest.mark.parametrize("config", [OURS, RELEASE, replace(RELEASE, preset="paper")], ids=lambda config: config.preset)
def test_moved_and_turned_worlds_have_moved_and_turned_answers(config: SASTConfig) -> None:
    model, given = model_of(config), inputs(config)
    angle = torch.tensor(2.3)
    heading, shift = torch.stack([angle.cos(), angle.sin()]), torch.tensor([4.0, -7.0, 0.0])
    moved = given | {name: turn(given[name], heading) + shift for name in ("history", "estimate")}
    clean, future = answer(model, given)
    clean_moved, future_moved = answer(model, moved)
    torch.testing.assert_close(clean_moved, clean, atol=1e-4, rtol=0)
    torch.testing.assert_close(future_moved, turn(future, heading) + shift, atol=1e-4, rtol=0)


@pytest.mark.parametrize("config", [OURS, RELEASE, replace(RELEASE, preset="paper")], ids=lambda config: config.preset)
def test_the_order_of_people_and_objects_does_not_matter(config: SASTConfig) -> None:
    model, given = model_of(config), inputs(config)
    order, things = [2, 0, 1], [3, 1, 0, 2]
    shuffled = given | {
        "history": given["history"][:, :, order], "noisy": given["noisy"][:, order],
        "estimate": given["estimate"][:, :, order], "codes": given["codes"][:, order][:, :, things],
    }  # fmt: skip
    torch.testing.assert_close(answer(model, shuffled)[0], answer(model, given)[0][:, order], atol=1e-5, rtol=0)


def with_more(given: dict[str, torch.Tensor], people: int, objects: int) -> dict[str, torch.Tensor]:
    """The same with empty slots, full of nonsense."""
    more = dict(given)
    for name, axis, extra in (
        ("history", 2, people), ("noisy", 1, people), ("estimate", 2, people), ("codes", 1, people),
        ("codes", 2, objects),
    ):  # fmt: skip
        size = list(more[name].shape)
        size[axis] = extra
        more[name] = torch.cat([more[name], torch.full(size, 7.0)], axis)
    more["observed"] = torch.nn.functional.pad(more["observed"], (0, people))
    more["there"] = torch.nn.functional.pad(more["there"], (0, objects))
    return more


def test_empty_slots_change_nothing(ours: SAST) -> None:
    given = inputs(OURS)
    expected = answer(ours, given)
    for people, objects in ((2, 0), (0, 3), (1, 2)):
        clean, future = answer(ours, with_more(given, people, objects))
        torch.testing.assert_close(clean[:, :3], expected[0], atol=1e-5, rtol=0)
        torch.testing.assert_close(future[:, :, :3], expected[1], atol=1e-5, rtol=0)
    nothing = given | {"there": torch.zeros_like(given["there"])}
    one = nothing | {"there": nothing["there"][:, :1], "codes": given["codes"][:, :, :1]}
    torch.testing.assert_close(answer(ours, one)[0], answer(ours, nothing)[0], atol=1e-5, rtol=0)


def test_the_release_reads_empty_slots_of_objects_but_not_of_people(release: SAST) -> None:
    given = inputs(RELEASE)
    expected = answer(release, given)[0]
    torch.testing.assert_close(answer(release, with_more(given, 2, 0))[0][:, :3], expected, atol=1e-5, rtol=0)
    assert (answer(release, with_more(given, 0, 3))[0] - expected).abs().max() > 1e-4


def first_change(model: SAST, config: SASTConfig, changed: str, frame: int) -> int:
    """The first future frame of person 1 that differs when what was ``changed`` differs from a frame on."""
    given = inputs(config)
    other = given[changed].clone()
    if changed == "noisy":
        other[:, :, frame:] += 1
    else:
        other[:, frame:, 1:] += 1  # the other people
    difference = (answer(model, given | {changed: other})[0] - answer(model, given)[0])[0, 0].abs().amax((1, 2))
    return min((difference > 1e-7).nonzero().flatten().tolist(), default=config.horizon)


@pytest.mark.parametrize("frame", [0, 1, 5, 10, 15])
@pytest.mark.parametrize("changed", ["noisy", "estimate"])
def test_ours_is_causal(ours: SAST, changed: str, frame: int) -> None:
    assert first_change(ours, OURS, changed, frame) >= frame


def test_ours_reacts_at_once_to_its_own_frames(ours: SAST) -> None:
    assert first_change(ours, OURS, "noisy", 5) == 5


@pytest.mark.parametrize("preset", ["release", "paper"])
def test_what_is_published_is_not_causal(preset: Any) -> None:
    config = replace(RELEASE, preset=preset)
    assert first_change(model_of(config), config, "noisy", 15) < 15


@pytest.mark.parametrize("config", [OURS, RELEASE], ids=lambda config: config.preset)
def test_everybody_at_once_is_as_one_after_the_other(config: SASTConfig) -> None:
    model, given = model_of(config), inputs(config)
    together = answer(model, given)[0]
    for person in range(3):
        order = [person, *(other for other in range(3) if other != person)]
        alone = given | {
            "history": given["history"][:, :, order], "estimate": given["estimate"][:, :, order],
            "noisy": given["noisy"][:, [person]], "codes": given["codes"][:, [person]],
        }  # fmt: skip
        torch.testing.assert_close(answer(model, alone)[0], together[:, [person]], atol=1e-5, rtol=0)


def test_others_that_are_there_are_seen_and_their_history_is_known(ours: SAST) -> None:
    given = inputs(OURS)
    expected = answer(ours, given)[0][:, 0]
    for name in ("history", "estimate"):
        other = given[name].clone()
        other[:, :, 1] += 0.5
        assert (answer(ours, given | {name: other})[0][:, 0] - expected).abs().max() > 1e-5
        myself = given[name].clone()
        myself[:, :, 0] += 0.5
    torch.testing.assert_close(answer(ours, given | {"estimate": myself})[0][:, 0], expected)  # nobody sees itself


def test_untrained_it_holds_the_last_pose() -> None:
    given = inputs(OURS)
    clean, future = answer(SAST(OURS).eval(), given)
    assert clean.abs().max() == 0
    torch.testing.assert_close(future, given["history"][:, -1:].expand_as(future), atol=1e-5, rtol=0)


def test_who_is_seen_late_stood_still_before(ours: SAST) -> None:
    given = inputs(OURS)
    given["observed"][:, :4, 1] = False
    still = given["history"].clone()
    still[:, :4, 1] = still[:, 4:5, 1]
    complete = given | {"history": still, "observed": torch.ones_like(given["observed"])}
    torch.testing.assert_close(answer(ours, given), answer(ours, complete))


@pytest.mark.parametrize("preset", ["motioncast", "release"])
@pytest.mark.parametrize(("switch", "names"), [("scene", ["codes"]), ("others", ["estimate"])])
def test_what_is_switched_off_is_not_seen(preset: Any, switch: str, names: list[str]) -> None:
    config = replace(OURS if preset == "motioncast" else RELEASE, **{switch: False})
    model, given = model_of(config), inputs(config)
    changed = given | {name: given[name] + 1 for name in names}
    assert torch.equal(answer(model, changed)[0], answer(model, given)[0])


def test_the_history_of_a_published_sequence_may_be_noisy(release: SAST) -> None:
    given = inputs(RELEASE)
    own = release.sequence(torch.zeros(1, 3, 9, 15, 3), given["noisy"]).view(3, 32, 2, 45)
    assert torch.equal(own[:, :9, 0], torch.zeros(3, 9, 45))
    whole = torch.randn(1, 3, 32, 15, 3)
    clean, future = answer(release, given | {"noisy": whole})
    assert clean.shape == (1, 3, 32, 15, 3)
    assert future.shape == (1, 32, 3, 15, 3)


def windows(config: SASTConfig, people: int = 2, seen: int = 1, batch: int = 2) -> dict[str, torch.Tensor]:
    random = torch.Generator().manual_seed(2)
    noisy = config.frames if config.published else config.horizon
    return {
        "positions": torch.randn(batch, config.frames, people, 15, 3, generator=random),
        "observed": torch.ones(batch, config.frames, people, dtype=torch.bool),
        "codes": torch.rand(batch, seen, 3, WIDTH, generator=random),
        "there": torch.ones(batch, 3, dtype=torch.bool),
        "step": torch.randint(1000, (batch, seen), generator=random),
        "noise": torch.randn(batch, seen, noisy, 15, 3, generator=random),
    }


@pytest.mark.parametrize("config", [OURS, RELEASE, replace(RELEASE, preset="paper")], ids=lambda config: config.preset)
def test_frames_without_the_person_do_not_count(config: SASTConfig) -> None:
    model, batch = model_of(config), windows(config)
    half = config.history + 9
    batch["observed"][:, half:] = False
    loss = model.loss(**batch)
    batch["positions"][:, half:] += 5
    torch.testing.assert_close(model.loss(**batch), loss)
    batch["positions"][:, half - 1] += 5
    assert (model.loss(**batch) - loss).abs() > 0.1


def test_ours_has_no_dead_outputs_and_the_release_has() -> None:
    dead = {}
    for config in (OURS, RELEASE):
        model = model_of(config)
        model.loss(**windows(config, people=3)).backward()
        weight = model.decoder.blocks[-1].residual.mix.weight
        dead[config.preset] = int((weight.grad == 0).all(1).sum())
        silent = [
            name for name, parameter in model.named_parameters()
            if parameter.requires_grad and (parameter.grad is None or not parameter.grad.any())
        ]  # fmt: skip
        assert silent == []
    assert dead == {"motioncast": 0, "release": 45}


def test_levels_order_steps(ours: SAST, release: SAST) -> None:
    steps = torch.arange(1000)
    levels = ours.level(steps)
    assert (levels.diff() < 0).all()
    torch.testing.assert_close(levels.sigmoid().double()[:900], ours.abar[:900], atol=1e-6, rtol=1e-4)
    assert torch.equal(release.level(steps), steps.float())

    def likeness(codes: torch.Tensor) -> float:
        return float(torch.cosine_similarity(codes[1:], codes[:-1], dim=-1).mean())

    assert likeness(ours.code(levels)) > 0.95
    assert abs(likeness(release.code(steps.float()))) < 0.5
