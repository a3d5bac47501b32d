"""Write the example room that ships: twenty seconds of test people among furniture, on 15 joints.

python benchmarks/make_example_room.py --data DIR
"""

from __future__ import annotations

import argparse
from dataclasses import replace
from pathlib import Path

import numpy as np

from motioncast.core.skeletons import MRT15
from motioncast.datasets.rooms import rooms
from motioncast.formats.load import save_scene

SEED, START_S, LENGTH_S = 36, 0.0, 20.0

parser = argparse.ArgumentParser(description=__doc__)
parser.add_argument("--data", type=Path, required=True, help="folder with CMU's takes")
(room,) = rooms(parser.parse_args().data, "test", 1, SEED)
first = round(START_S * room.scene.fps)
scene = room.scene.on(MRT15)[first : first + round(LENGTH_S * room.scene.fps)]
there = np.flatnonzero(scene.observed.any((0, 2)))
takes = ", ".join(dict.fromkeys(name for person in there for name in room.takes[person]))
scene = scene.select([scene.people[person] for person in there])
scene = replace(
    scene,
    source=f"composed from CMU {takes}, sitting and reaching by inverse kinematics; data from mocap.cs.cmu.edu, "
    "created with funding from NSF EIA-0196217",
)
save_scene(scene, Path(__file__).parent.parent / "src" / "motioncast" / "data" / "room.npz")
