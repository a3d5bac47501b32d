"""How much of a clean signal is left at each step of a diffusion: the cosine schedule.

Paper: Nichol, Dhariwal, "Improved Denoising Diffusion Probabilistic Models", 2021, Eq. 17.
"""

from __future__ import annotations

import numpy as np

OFFSET = 0.008
"""Keeps the first steps from adding next to no noise."""

MOST_NOISE = 0.999
"""Largest variance that one step adds."""


def cosine_abar(steps: int) -> np.ndarray:
    """Share of the clean signal's variance at each step, ``(steps,)`` float64, falling from almost 1 to almost 0.

    Args:
        steps: Number of steps; step 0 is the cleanest.

    Example:
        >>> " ".join(f"{share:.4g}" for share in cosine_abar(1000)[[0, 100, 250, 500, 750, 900, 990, 999]])
        '1 0.9716 0.8459 0.4923 0.1432 0.02362 0.0001967 2.429e-09'
    """
    angle = (np.arange(steps + 1) / steps + OFFSET) / (1 + OFFSET) * np.pi / 2
    left = np.cos(angle) ** 2
    return np.cumprod(1 - np.minimum(1 - left[1:] / left[:-1], MOST_NOISE))
