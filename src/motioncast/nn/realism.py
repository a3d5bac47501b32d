"""The realism classifier of SAST: is this snippet of motion recorded, or did a model make it up?

Mueller et al., Massively multi-person 3D human motion forecasting with scene context (2024), section 4.2, figure 3 and
supplement B.2. The paper states 284,000 parameters, which is the count for 17 joints (284,385; its 29 joints would
have 480,993). No code or weights of it were released. It judges the models that it was trained on: scores of different
trainings cannot be compared.
"""

from __future__ import annotations

import numpy as np
import torch
from torch import Tensor, nn

from motioncast.metrics.words import motion_words
from motioncast.nn.dct import dct_matrix

FRAMES = 50
"""Frames of a snippet: 2 s at 25 fps."""

HOP = 5
"""Frames between two snippets of a motion that is judged."""


class Realism(nn.Module):
    """Snippets of one person each in, logits out: above 0 is "recorded".

    A joint's x, y and z over time, as DCT coefficients, pass a layer that all joints share; then two layers see all
    joints together.
    """

    dct: Tensor

    def __init__(self, joints: int = 17) -> None:
        super().__init__()
        self.register_buffer("dct", dct_matrix(FRAMES), persistent=False)
        self.joint = nn.Linear(3 * FRAMES, 32)
        self.body = nn.Linear(32 * joints, 512)
        self.verdict = nn.Linear(512, 1)

    def forward(self, snippets: Tensor) -> Tensor:
        """Logits ``(B,)`` of snippets ``(B, 50, J, 3)``: those of :func:`snippets_of`."""
        coefficients = torch.einsum("kt,btjc->bjkc", self.dct, snippets).flatten(2)
        joints = torch.relu(self.joint(coefficients))
        return self.verdict(torch.relu(self.body(joints.flatten(1))))[:, 0]


def snippets_of(motion: np.ndarray, hips: tuple[int, int]) -> Tensor:
    """Every fifth 2-s snippet of a motion at 25 fps, each in its own frame, ``(..., snippets, 50, J, 3)``.

    The paper says "normalised" and no more; here a snippet is seen from its first frame, as motion words are.

    Args:
        motion: ``(..., time, J, 3)`` metres, one person each.
        hips: Left and right hip.
    """
    return torch.from_numpy(np.ascontiguousarray(motion_words(motion, hips, FRAMES, HOP), np.float32))


@torch.no_grad()
def realism_until(model: Realism, motion: np.ndarray, hips: tuple[int, int]) -> np.ndarray:
    """Mean realism score, 0 to 1, of the snippets that lie whole before each end, ``(..., snippets)``.

    Value s (from 0) is the score until frame ``50 + 5 s``: the paper's score at k seconds is that until frame 25 k.

    Args:
        model: A trained classifier.
        motion: ``(..., time, J, 3)`` metres at 25 fps.
        hips: Left and right hip.
    """
    snippets = snippets_of(motion, hips)
    scores = torch.sigmoid(model(snippets.flatten(0, -4))).view(snippets.shape[:-3]).double().numpy()
    return np.cumsum(scores, -1) / np.arange(1, scores.shape[-1] + 1)


def fit(real: Tensor, made_up: Tensor, seed: int = 0, epochs: int = 6) -> Realism:
    """A classifier trained to tell snippets ``(B, 50, J, 3)`` that were recorded from those of models.

    As in the paper: AdamW at 1e-3, batches of 16, 6 epochs, binary cross-entropy. Its data were half recorded, half
    of five models in equal parts: the models that are to be compared must all be among them.
    """
    with torch.random.fork_rng(devices=[]):
        torch.manual_seed(seed)
        model = Realism(real.shape[2])
        optimiser = torch.optim.AdamW(model.parameters(), 1e-3)
        snippets = torch.cat([real, made_up])
        recorded = torch.cat([torch.ones(len(real)), torch.zeros(len(made_up))])
        for _ in range(epochs):
            for batch in torch.randperm(len(snippets)).split(16):
                loss = nn.functional.binary_cross_entropy_with_logits(model(snippets[batch]), recorded[batch])
                optimiser.zero_grad()
                loss.backward()
                optimiser.step()
    return model.eval()
