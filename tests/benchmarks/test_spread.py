from __future__ import annotations

import sys

import numpy as np
import pytest

from motioncast.benchmarks import spread
from motioncast.errors import InputError
from motioncast.testing import walkers


def scenes() -> list:
    return [walkers(1 + seed % 3, 15, seed=seed) for seed in range(25)]


def told(share: float) -> None:
    assert 0 < share <= 1


def test_processes_answer_bit_for_bit_as_one() -> None:
    one = spread.serially("somoformer-fast", scenes(), 3.0, True, told)
    two = spread.over_processes(2)("somoformer-fast", scenes(), 3.0, True, told)
    assert len(one) == len(two) == 25
    for first, second in zip(one, two, strict=True):
        np.testing.assert_array_equal(first, second)


@pytest.mark.cluster
def test_a_cluster_answers_bit_for_bit_as_one() -> None:
    pytest.importorskip("ray")
    one = spread.serially("root-velocity-damped", scenes(), 1.0, False, told)
    two = spread.over_ray("local")("root-velocity-damped", scenes(), 1.0, False, told)
    for first, second in zip(one, two, strict=True):
        np.testing.assert_array_equal(first, second)


def test_a_cluster_without_ray_names_the_extra(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "ray", None)
    with pytest.raises(InputError, match=r"motioncast\[cluster\]"):
        spread.over_ray("local")
