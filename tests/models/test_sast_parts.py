"""The frame on the hips, and the scales of a diffusion."""

from __future__ import annotations

import pytest

torch = pytest.importorskip("torch")

from motioncast.core.skeletons import HIK29, MRT15  # noqa: E402
from motioncast.nn.frames import to_own, to_world  # noqa: E402
from motioncast.nn.hips import seen_from, stand_on_hips  # noqa: E402
from motioncast.nn.scaling import FINEST_M, Displacement, MinMax  # noqa: E402

pytestmark = pytest.mark.torch


@pytest.mark.parametrize("skeleton", [MRT15, HIK29], ids=lambda skeleton: skeleton.label)
def test_in_its_own_frame_a_person_has_its_hips_at_the_origin(skeleton) -> None:
    motion = torch.randn(2, 7, 3, len(skeleton), 3) + torch.tensor([3.0, -5.0, 1.0])
    frame = stand_on_hips(motion[:, 4], skeleton)
    own = to_own(motion, *frame)
    left, right = own[:, 4, :, skeleton.index("left_hip")], own[:, 4, :, skeleton.index("right_hip")]
    torch.testing.assert_close((left + right)[..., :2] / 2, torch.zeros(2, 3, 2), atol=1e-5, rtol=0)
    assert (right[..., 0] > 0).all()
    torch.testing.assert_close(right[..., 1], left[..., 1], atol=1e-5, rtol=0)
    assert torch.equal(own[..., 2], motion[..., 2])
    torch.testing.assert_close(to_world(own, *frame), motion, atol=2e-6, rtol=0)


def test_there_and_back_loses_less_than_a_micrometre() -> None:
    motion = torch.randn(2, 7, 3, 29, 3, dtype=torch.float64) * 5
    frame = stand_on_hips(motion[:, 4], HIK29)
    assert (to_world(to_own(motion, *frame), *frame) - motion).abs().max() < 1e-6


def test_hips_one_above_the_other_face_along_y() -> None:
    origin, across = stand_on_hips(torch.zeros(1, 15, 3), MRT15)
    assert origin.tolist() == [[0, 0, 0]]
    assert across.tolist() == [[1, 0]]


def test_who_stands_ahead_and_faces_back() -> None:
    quarter = torch.tensor([[[0.0, 1.0]]])  # the observer's x axis is the world's y: it faces the world's -x
    place, direction = torch.tensor([[[[-3.0, 0.0, 0.0]]]]), torch.tensor([[[[0.0, -1.0]]]])
    seen = seen_from(torch.zeros(1, 1, 3), quarter, place, direction).flatten()
    torch.testing.assert_close(seen, torch.tensor([0.0, 0.75, torch.exp(torch.tensor(-3.0)), -1.0, 0.0]))


def test_scales_are_fitted_and_undone() -> None:
    random = torch.Generator().manual_seed(0)
    own = torch.randn(50, 12, 15, 3, generator=random).cumsum(1) * torch.rand(15, 3, generator=random)
    last = own[:, 3:4]
    published, ours = MinMax(15), Displacement(12, 15)
    for scaling in (published, ours):
        scaling.fit(own, history=4)
        for first in (0, 4):
            part = own[:, first:]
            back = scaling.to_metres(scaling.to_model(part, last, first), last, first)
            torch.testing.assert_close(back, part, atol=2e-6, rtol=1e-6)
    scaled = published.to_model(own, last, 0)
    torch.testing.assert_close(scaled.amax((0, 1)), torch.full((15, 3), 3.0))
    torch.testing.assert_close(scaled.amin((0, 1)), torch.full((15, 3), -3.0))
    size = ours.to_model(own, last, 0).square().mean(0).sqrt()
    torch.testing.assert_close(size[4:], torch.ones(8, 15, 3), atol=1e-4, rtol=0)
    assert ours.scale[3].eq(FINEST_M).all()  # the last pose does not move from itself
    assert (ours.scale[-1] > ours.scale[4]).float().mean() > 0.9  # more can have happened by then
