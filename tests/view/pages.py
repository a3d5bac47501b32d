"""Forecasts to make pages of, and pages taken apart again."""

from __future__ import annotations

import base64
import json
import re
import zlib

import numpy as np

from motioncast.core.card import ModelCard
from motioncast.core.forecast import Forecast
from motioncast.core.scene import Scene

CARD = ModelCard("somoformer-fast", "SoMoFormer", "forecast", "mrt15", 15, 45, 15.0)


def forecast_of(scene: Scene, now: int, samples: int = 1, **more: object) -> Forecast:
    """A forecast that is wrong by 10 cm to the side, sample by sample 1 cm more."""
    ahead = scene[now:].positions + np.array([0.1, 0, 0], np.float32)
    drawn = np.stack([ahead + np.float32(0.01 * number) for number in range(samples)])
    radius = {"0.5": np.full(ahead.shape[:1] + ahead.shape[2:3], 0.12), "0.9": np.full((len(ahead), 15), 0.4)}
    return Forecast(drawn, scene[:now], scene.people, CARD, radius_m=radius, **more)  # pyright: ignore[reportArgumentType]


def read(text: str) -> tuple[dict, dict[str, np.ndarray]]:
    """Description and arrays of a page, unpacked without the help of the program."""
    about = json.loads(re.search(r'id="about">(.*?)</script>', text)[1])  # pyright: ignore[reportOptionalSubscript]
    numbers = re.search(r'id="numbers">(.*?)</script>', text)[1]  # pyright: ignore[reportOptionalSubscript]
    raw = np.frombuffer(zlib.decompress(base64.b64decode(numbers)), np.uint8).astype(int)
    words = raw[: len(raw) // 2] + 256 * raw[len(raw) // 2 :]
    arrays, start = {}, 0
    for entry in about["arrays"]:
        size = int(np.prod(entry["shape"]))
        part = words[start : start + size].reshape(entry["shape"])
        steps = np.where(part % 2, -(part + 1) // 2, part // 2)
        arrays[entry["name"]] = np.cumsum(np.cumsum(steps, 0), 0).astype(np.int16) * entry["scale"]
        start += size
    assert start == len(words)
    return about, arrays
