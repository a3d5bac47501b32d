"""Forecast people in a furnished room, and see them there.

    python examples/05_forecast_in_a_room.py walk.bvh kitchen.json

Without a room it writes one, to be edited by hand. Models that do not look at furniture carry it through.
"""

from __future__ import annotations

import sys
from pathlib import Path

import motioncast as mc

KITCHEN = """{
 "schema": "motioncast.room/1",
 "floor_m": 0,
 "objects": [
  {"name": "table", "category": "table", "size": [1.6, 0.8, 0.74], "position": [2.2, 1.0], "yaw_deg": 20},
  {"name": "chair", "category": "sittable", "size": [0.45, 0.45, 0.46], "position": [2.0, 1.8]},
  {"name": "stool", "category": "sittable", "shape": "cylinder", "size": [0.4, 0.4, 0.6], "position": [-2, 1]},
  {"name": "whiteboard", "category": "whiteboard", "size": [1.8, 0.05, 1.1], "position": [0, 3, 1.5]}
 ]
}
"""


def main(motion: str, room: str = "kitchen.json") -> None:
    if not Path(room).exists():
        Path(room).write_text(KITCHEN, encoding="utf-8")
    scene = mc.load_scene(motion, room=room)
    for remark in scene.remarks:  # a floor that was inferred, somebody inside a table
        print("note:", remark)

    forecast = mc.load("somoformer-fast").forecast(scene)

    for thing in forecast.history.objects:
        print(f"{thing.name}: {thing.category} at {thing.position.round(2)}")
    mc.write_page(forecast, "room.html")


if __name__ == "__main__":
    main(*sys.argv[1:])
