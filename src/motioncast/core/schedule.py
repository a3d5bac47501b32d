"""How much of a clean signal is left at each step of a diffusion: the cosine schedule.

Papers: Nichol, Dhariwal, "Improved Denoising Diffusion Probabilistic Models", 2021, Eq. 17; Hoogeboom, Heek, Salimans,
"Simple Diffusion", 2023, Sec. 3.1, for its shift.
"""

from __future__ import annotations

import numpy as np

OFFSET = 0.008
"""Keeps the first steps from adding next to no noise."""

MOST_NOISE = 0.999
"""Largest variance that one step adds."""


def cosine_abar(steps: int, shift: float = 0.0) -> np.ndarray:
    """Share of the clean signal's variance at each step, ``(steps,)`` float64, falling from almost 1 to almost 0.

    Args:
        steps: Number of steps; step 0 is the cleanest.
        shift: Added to the log signal-to-noise ratio of every step. What many numbers tell together, such as where a
            path of 250 frames leads, can be seen through much noise, and the plain schedule hurries past it.

    Example:
        >>> " ".join(f"{share:.4g}" for share in cosine_abar(1000)[[0, 100, 250, 500, 750, 900, 990, 999]])
        '1 0.9716 0.8459 0.4923 0.1432 0.02362 0.0001967 2.429e-09'
        >>> plain, shifted = cosine_abar(1000)[500], cosine_abar(1000, -3.0)[500]
        >>> round(float(np.log(shifted / (1 - shifted)) - np.log(plain / (1 - plain))), 6)
        -3.0
    """
    angle = (np.arange(steps + 1) / steps + OFFSET) / (1 + OFFSET) * np.pi / 2
    left = np.cos(angle) ** 2
    abar = np.cumprod(1 - np.minimum(1 - left[1:] / left[:-1], MOST_NOISE))
    return abar / (abar + (1 - abar) * np.exp(-shift))
