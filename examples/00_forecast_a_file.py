"""Forecast the people of a file and read the answer.

python examples/00_forecast_a_file.py a.bvh b.bvh
"""

from __future__ import annotations

import sys

import motioncast as mc


def main(*paths: str) -> None:
    scene = mc.load_scene(*paths)
    for remark in scene.remarks:  # what was inferred: unit, up axis, frame rate
        print("note:", remark)

    forecast = mc.load("somoformer-fast").forecast(scene, horizon_s=3.0)

    wrist = scene.skeleton.find("left_wrist")
    for person, name in enumerate(forecast.people):
        x, y, z = forecast.best[-1, person, wrist]
        print(f"{name}: left wrist at ({x:.2f}, {y:.2f}, {z:.2f}) m in {forecast.times_s[-1]:.1f} s")
    for level, radius in forecast.radius_m.items():  # (time, joints)
        print(f"{float(level):.0%} of left wrists are expected within {radius[-1, wrist]:.2f} m of that")

    mc.save_forecast(forecast, "forecast.npz")
    mc.write_page(forecast, "forecast.html")


if __name__ == "__main__":
    main(*sys.argv[1:])
