from __future__ import annotations

from math import cos, pi

import numpy as np
import pytest

from motioncast.core.schedule import cosine_abar

PUBLISHED = {
    0: "0.99996", 100: "0.9716", 250: "0.8459", 500: "0.4923", 750: "0.1432", 900: "0.0236", 990: "0.000197",
    999: "0.0000000024",
}  # fmt: skip
"""Shares of the clean signal that are left in the authors' code, by step, as far as they were noted down."""


@pytest.mark.parametrize("step", PUBLISHED)
def test_the_shares_are_those_of_the_authors_schedule(step: int) -> None:
    noted = PUBLISHED[step]
    assert f"{cosine_abar(1000)[step]:.{len(noted) - 2}f}" == noted


def test_naive_twin() -> None:
    def left(time: float) -> float:
        return cos((time + 0.008) / 1.008 * pi / 2) ** 2

    share, shares = 1.0, []
    for step in range(1000):
        share *= 1 - min(1 - left((step + 1) / 1000) / left(step / 1000), 0.999)
        shares.append(share)
    np.testing.assert_allclose(cosine_abar(1000), shares, rtol=1e-9, atol=0)
