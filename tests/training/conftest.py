"""Made-up takes in CMU's layout, and a recipe of a toy."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from motioncast.core.skeletons import CMU_ENDS
from motioncast.datasets.cmu import SLOW_SUBJECTS
from motioncast.datasets.offsets import OFFSET_STEP_M


@pytest.fixture(scope="session")
def data(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Eight takes of people who wander about, as positions of CMU's joints."""
    folder = tmp_path_factory.mktemp("data") / "extra"
    folder.mkdir()
    random = np.random.default_rng(0)
    names = list(CMU_ENDS)
    body = random.normal(0, 0.3, (len(names), 3))
    arrays: dict[str, np.ndarray] = {"joint_names": np.array(names), "parents": np.arange(-1, len(names) - 1)}
    rows = ["id,archive"]
    for take in ("01_01", "03_01", "03_02", "03_03", "60_01", "61_01", "60_12", "61_12"):
        seconds = np.arange(5 * (60 if int(take[:2]) in SLOW_SUBJECTS else 120)) / 60
        root = np.stack([np.sin(seconds), 0.2 * seconds, 1 + 0 * seconds], 1) + random.normal(0, 1, 3) * [1, 1, 0]
        arrays[f"{take}_root"] = root.astype(np.float32)
        offsets = np.broadcast_to(body[1:] / OFFSET_STEP_M, (len(root), len(names) - 1, 3))
        arrays[f"{take}_rel"] = offsets.astype(np.int16)
        rows.append(f"{take},extra_cmu_toy.npz")
    np.savez(folder / "extra_cmu_toy.npz", **arrays)  # pyright: ignore[reportArgumentType]
    (folder / "index.csv").write_text("\n".join(rows), encoding="utf-8")
    return folder.parent
