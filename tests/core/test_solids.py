from __future__ import annotations

import numpy as np

from motioncast.core.rotation import normalise
from motioncast.core.scene_object import SceneObject
from motioncast.core.shapes import signed_distance
from motioncast.core.solids import Solids


def test_naive_twin_of_depths() -> None:
    random = np.random.default_rng(0)
    things = [
        SceneObject(
            f"thing {number}", "table", "cylinder" if number % 2 else "box",
            np.array([1.0, 1.0, 0.7]) * random.uniform(0.5, 1.5), random.normal(size=3) * 0.5,
            normalise(random.normal(size=4)),
        )
        for number in range(6)
    ]  # fmt: skip
    cloud = SceneObject("cloud", "table", "points", points=np.ones((1, 3)))
    body = random.normal(size=(40, 5, 3)) * 0.6
    expected = [np.maximum(-signed_distance(thing, body), 0).max(-1) for thing in things]
    solids = Solids.of([*things, cloud])
    np.testing.assert_allclose(solids.depth(body), expected, atol=1e-6)
    assert (solids.depth(body) > 0).mean() > 0.2
    np.testing.assert_allclose(solids[[1, 4]].depth(body[3]), np.array(expected)[[1, 4], 3], atol=1e-6)


def test_what_nobody_can_touch_is_left_out() -> None:
    things = Solids.of([SceneObject("box", "table", "box", (2, 2, 1), (x, 0, 0.5)) for x in (0, 4, 9)])
    assert things.near(np.array([[0.0, 0.0], [1.0, 0.0]]), reach_m=1.7).centres[:, 0].tolist() == [0, 4]
    assert len(Solids.of([]).near(np.zeros((1, 2)), reach_m=1.0)) == 0
