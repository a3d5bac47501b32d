"""What the rooms are like, split by split: the figures of docs/rooms.md.

python benchmarks/rooms_report.py --data DIR --count 60
"""

from __future__ import annotations

import argparse
import time
from collections import Counter
from pathlib import Path

import numpy as np

from motioncast.datasets.rooms.bodies import PELVIS
from motioncast.datasets.rooms.check import check
from motioncast.datasets.rooms.clips import Library, load
from motioncast.datasets.rooms.compose import room
from motioncast.datasets.rooms.contacts import FEET, FPS, sliding, speed
from motioncast.datasets.rooms.events import events_of
from motioncast.datasets.rooms.gait import walking
from motioncast.datasets.rooms.people import Cast, cast
from motioncast.datasets.rooms.samples import windows
from motioncast.metrics.people import gaps, penetration


def source(library: Library, players: Cast) -> None:
    """What the real takes of a split hold."""
    bodies = [clip.positions[:, 0] for clips in library.singles.values() for clip in clips]
    bodies += [clip.positions[:, person] for clip in library.couples for person in range(2)]
    total = sum(map(len, bodies))
    walks = sum(int(walking(body).sum()) for body in bodies)
    stands = sum(int((speed(body[:, [PELVIS]])[:, 0] < 0.15).sum()) for body in bodies)
    sits = sum(event.end - event.start for body in bodies for event in events_of(body) if event.kind == "sit")
    minutes = total / FPS / 60
    print(f"  real takes: {minutes:.1f} minutes, {walks / total:.0%} walking forwards on the floor, ", end="")
    print(f"{stands / total:.0%} with a pelvis at rest, {sits / FPS:.0f} s sitting")
    walk = np.mean([sliding(actor.gait.positions[:, FEET]) for actor in players.actors.values()])
    print(
        f"  walkers {len(players.actors)}, whole takes {len(players.solos)}, couples {len(players.couples)}, ", end=""
    )
    print(f"sliding of their walks {100 * walk:.1f} cm/s")


def report(data: Path, split: str, count: int, seed: int) -> None:
    """Print the figures of one split."""
    print(f"{split}: rooms {seed} to {seed + count - 1}")
    library = load(data, split)
    players = cast(library)
    source(library, players)
    began = time.perf_counter()
    made = [room(players, split, seed + number) for number in range(count)]
    seconds = time.perf_counter() - began
    checks = [check(one) for one in made]
    depth = np.concatenate([one.depth_m for one in checks])
    seats = np.concatenate([one.seat_m for one in checks])
    print(f"  {seconds / count:.2f} s a room; {np.mean([one.scene.duration_s for one in made]):.0f} s long")
    people = [len(one.scene.people) for one in made]
    objects = [len(one.scene.objects) for one in made]
    print(f"  people {min(people)} to {max(people)}, mean {np.mean(people):.1f}; ", end="")
    print(f"objects {min(objects)} to {max(objects)}, mean {np.mean(objects):.1f}")
    cut = [sample for one in made for sample in windows(one)]
    still = np.concatenate([sample.still for sample in cut])
    print(f"  {len(cut)} windows, {len(still)} people to forecast, {still.mean():.0%} of them still")
    print(f"  synthetic frames {np.mean([one.synthetic[one.here].mean() for one in made]):.0%}; time: ", end="")
    print(", ".join(f"{name} {np.mean([one.time_share[name] for one in checks]):.0%}" for name in checks[0].time_share))
    print(f"  depth in things: p95 {100 * np.percentile(depth, 95):.1f} cm, ", end="")
    print(f"deeper than 3 cm {np.mean(depth > 0.03):.2%}, at most {100 * depth.max():.1f} cm")
    clear = [
        penetration(gaps(one.scene.positions[::10], one.scene.skeleton.bones, observed=one.scene.observed[::10]), 0.02)
        for one in made
        if "recorded" not in one.pairs.values()
    ]
    print(
        f"  people deeper than 2 cm in one another (composed rooms) {np.mean([share for share, _ in clear]):.3%}; ",
        end="",
    )
    print(f"nearest strangers {min(one.nearest_m for one in checks):.2f} m")
    print(
        f"  seats: {len(seats)} sittings, error p95 {100 * np.percentile(seats, 95):.1f} cm"
        if len(seats)
        else "  no seats"
    )
    for name in ("real", "synthetic"):
        print(f"  sliding of {name} frames {100 * np.nanmean([one.sliding_m_s[name] for one in checks]):.1f} cm/s")
    print(f"  free floor {np.mean([one.free for one in checks]):.0%}; ", end="")
    print(f"decoys that are lacking {sum(one.short_of_decoys for one in checks)}")
    for title, counts in (
        ("events", sum((one.events for one in checks), Counter())),
        ("objects", sum((one.categories for one in checks), Counter())),
    ):
        print(f"  {title}: " + ", ".join(f"{' '.join(key)} {number}" for key, number in sorted(counts.items())))


parser = argparse.ArgumentParser(description=__doc__)
parser.add_argument("--data", type=Path, required=True, help="folder with CMU's takes")
parser.add_argument("--count", type=int, default=60, help="rooms of each split")
parser.add_argument("--seed", type=int, default=0, help="of the first room")
given = parser.parse_args()
for split in ("train", "validation", "test"):
    report(given.data, split, given.count, given.seed)
