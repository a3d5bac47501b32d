"""SAST's transformers against torch's own, which attend to everything at once behind masks."""

from __future__ import annotations

import pytest

torch = pytest.importorskip("torch")

from torch import Tensor, nn  # noqa: E402

from motioncast.models.sast import HEAD, PublishedPeopleTransformer, Reader, SASTConfig, SceneTransformer  # noqa: E402
from motioncast.nn.attention import EncoderLayer  # noqa: E402
from motioncast.nn.decoder import DecoderLayer  # noqa: E402

pytestmark = pytest.mark.torch

CONFIG = SASTConfig(
    preset="release", history=9, horizon=31, channels=(32, 32, 64), others_channels=(32, 32, 48), scene_width=64,
    scene_layers=2, people_width=64, people_layers=2,
)  # fmt: skip


def fill(attention: nn.MultiheadAttention, weights: list[nn.Linear], merge: nn.Linear) -> None:
    state = {
        "in_proj_weight": torch.cat([linear.weight for linear in weights]),
        "in_proj_bias": torch.cat([linear.bias for linear in weights]),
        "out_proj.weight": merge.weight,
        "out_proj.bias": merge.bias,
    }
    attention.load_state_dict(state)


def encoder_twin(layer: EncoderLayer) -> nn.TransformerEncoderLayer:
    width = layer.merge.in_features
    twin = nn.TransformerEncoderLayer(width, width // HEAD, 4 * width, batch_first=True).eval()
    fill(twin.self_attn, [layer.project], layer.merge)
    twin.linear1, twin.linear2, twin.norm1, twin.norm2 = layer.rise, layer.fall, layer.norm_attention, layer.norm_feed
    return twin


def decoder_twin(layer: DecoderLayer) -> nn.TransformerDecoderLayer:
    width = layer.merge.in_features
    twin = nn.TransformerDecoderLayer(width, width // HEAD, 4 * width, batch_first=True).eval()
    fill(twin.self_attn, [layer.project], layer.merge)
    fill(twin.multihead_attn, [layer.ask, layer.look], layer.merge_memory)
    twin.linear1, twin.linear2 = layer.rise, layer.fall
    twin.norm1, twin.norm2, twin.norm3 = layer.norms
    return twin


def read(reader: Reader, tokens: Tensor, memory: Tensor, hidden: Tensor | None) -> Tensor:
    """What a reader answers, by torch's layers; ``hidden`` ``(N, T, K)``."""
    now = reader.inward(tokens) + reader.place
    heads = reader.layers[0].heads
    mask = None if hidden is None else hidden.repeat_interleave(heads, 0)
    for layer in reader.layers:
        now = decoder_twin(layer)(now, memory, tgt_mask=reader.seen < 0, memory_mask=mask)
    return reader.outward(reader.norm(now))


@torch.no_grad()
def test_sets_of_people_are_masked_attention_over_all_frames() -> None:
    torch.manual_seed(0)
    count, frames, others = 3, CONFIG.tokens, 4
    people = PublishedPeopleTransformer(CONFIG).eval()
    tokens, features = torch.randn(count, frames, 64), torch.randn(count, frames, others, 48)
    absent = torch.zeros(count, others, dtype=torch.bool)
    absent[1, 2:], absent[2, 0] = True, True

    frame = torch.arange(frames).repeat_interleave(others)
    elsewhere = frame[:, None] != frame
    hidden = absent.repeat(1, frames)
    memory = people.people(features).flatten(1, 2)
    for layer in people.encoder:
        mask = (elsewhere | hidden[:, None]).repeat_interleave(64 // HEAD, 0)
        memory = encoder_twin(layer)(memory, src_mask=mask)
    unseen = (torch.arange(frames)[:, None] != frame) | hidden[:, None]
    expected = read(people.reader, tokens, people.norm(memory), unseen)
    torch.testing.assert_close(people(tokens, features, absent), expected, atol=1e-5, rtol=0)


@torch.no_grad()
def test_the_scene_transformer_is_torchs_and_its_memory_serves_every_step() -> None:
    torch.manual_seed(0)
    scene = SceneTransformer(CONFIG).eval()
    codes, there = torch.rand(2, 5, 2061), torch.ones(2, 5, dtype=torch.bool)
    there[1, 3:] = False
    now = scene.objects(codes)
    for layer in scene.encoder:
        now = encoder_twin(layer)(now, src_mask=(~there[:, None]).expand(-1, 5, -1).repeat_interleave(64 // HEAD, 0))
    memory = scene.encode(codes, there)
    torch.testing.assert_close(memory, scene.norm(now), atol=1e-5, rtol=0)
    for _ in range(2):
        tokens = torch.randn(2, CONFIG.tokens, 64)
        expected = read(scene.reader, tokens, scene.norm(now), None)
        torch.testing.assert_close(scene(tokens, memory, there), expected, atol=1e-5, rtol=0)
