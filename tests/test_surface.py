"""The public names: one that disappears or appears is a decision, not an accident."""

from __future__ import annotations

import motioncast

NAMES = [
    "Forecast",
    "FormatError",
    "GoalPoses",
    "InputError",
    "ModelCard",
    "MotioncastError",
    "Scene",
    "Skeleton",
    "join",
    "list_models",
    "load",
    "load_forecast",
    "load_goals",
    "load_scene",
    "save_forecast",
    "save_goals",
    "save_scene",
    "write_page",
]


def test_public_names() -> None:
    assert sorted(motioncast.__all__) == sorted(NAMES), "a public name came or went: change this list and CHANGELOG.md"


def test_every_public_name_can_be_had() -> None:
    for name in motioncast.__all__:
        assert callable(getattr(motioncast, name)), name
    assert set(motioncast.__all__) <= set(dir(motioncast))
