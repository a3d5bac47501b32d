"""Continue a motion file: what was seen, then what is foretold, as BVH and glTF.

python examples/02_continue_an_animation.py dance.bvh
"""

from __future__ import annotations

import sys
from pathlib import Path

import motioncast as mc


def main(*paths: str) -> None:
    scene = mc.load_scene(*paths)
    forecast = mc.load("somoformer-fast").forecast(scene, horizon_s=2.0)
    continued = forecast.continued()  # bones keep their length, and nothing jumps at the seam

    name = Path(paths[0]).stem
    for suffix in (".bvh", ".glb"):
        for file in mc.save_scene(continued, f"{name}_continued{suffix}"):  # BVH holds one person a file
            print("written:", file)


if __name__ == "__main__":
    main(*sys.argv[1:])
