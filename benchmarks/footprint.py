"""What motioncast costs to start: the import, a whole forecast process, the installed size.

python benchmarks/footprint.py
"""

from __future__ import annotations

import statistics
import subprocess
import sys
import tempfile
from pathlib import Path
from time import perf_counter

from motioncast.formats.load import save_scene
from motioncast.testing import walkers

ROUNDS = 7

IMPORT = """
import sys, time
begin = time.perf_counter()
import motioncast
print((time.perf_counter() - begin) * 1000, any(name in sys.modules for name in ("numpy", "torch", "onnxruntime")))
"""

FORECAST = """
import resource, sys
from motioncast.cli import main
sys.argv = ["motioncast", "forecast", sys.argv[1], "--out", sys.argv[2]]
try:
    main()
finally:
    print(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1000, file=sys.stderr)
"""


def main() -> None:
    imports = [
        subprocess.run([sys.executable, "-c", IMPORT], capture_output=True, text=True, check=True).stdout.split()
        for _ in range(ROUNDS)
    ]
    print(f"import motioncast: {statistics.median(float(row[0]) for row in imports):.1f} ms", end="")
    print(f"; numpy, torch or onnxruntime loaded: {imports[0][1]}")
    with tempfile.TemporaryDirectory() as folder:
        scene, out = Path(folder) / "three.npz", Path(folder) / "next.npz"
        save_scene(walkers(people=3, frames=90, fps=30), scene)
        times, memory = [], []
        for _ in range(ROUNDS):
            begin = perf_counter()
            done = subprocess.run(
                [sys.executable, "-c", FORECAST, scene, out], capture_output=True, text=True, check=False
            )
            times.append(perf_counter() - begin)
            memory.append(float(done.stderr.split()[-1]))
    print(f"motioncast forecast, 3 people: {statistics.median(times):.2f} s, {max(memory):.0f} MB")


if __name__ == "__main__":
    main()
