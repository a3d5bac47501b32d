"""Write the example scene that ships: six seconds of the dancing couple, from a take that no model was trained on.

python benchmarks/make_example_scene.py --data DIR
"""

from __future__ import annotations

import argparse
from dataclasses import replace
from pathlib import Path

from motioncast.datasets import cmu
from motioncast.formats.load import save_scene

START_S, LENGTH_S, FPS = 10.0, 6.0, 30

parser = argparse.ArgumentParser(description=__doc__)
parser.add_argument("--data", type=Path, required=True, help="folder with CMU's takes")
couple = next(scene for scene in cmu.couples(parser.parse_args().data, "test") if scene.people[0] == "60_14")
step = round(couple.fps / FPS)
first, length = round(START_S * couple.fps), round(LENGTH_S * couple.fps)
scene = replace(
    couple[first : first + length : step],
    fps=float(FPS),
    people=("lead", "follow"),
    source="CMU 60_14 and 61_14, salsa; data from mocap.cs.cmu.edu, created with funding from NSF EIA-0196217",
)
save_scene(scene, Path(__file__).parent.parent / "src" / "motioncast" / "data" / "salsa.npz")
