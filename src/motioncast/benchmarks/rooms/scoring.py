"""What ten seconds in a room are measured by: how people move, where they go, what they respect.

Errors and spread apart, every figure is of the first sample, so that a model of one future and a model of many stand
on one footing. A person counts in the frames in which it was truly there.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from motioncast.benchmarks.rooms.tally import Mean, Measured, Pooled, Ratio, Tally
from motioncast.benchmarks.rooms.windows import PROTOCOL, Goal, RoomWindow
from motioncast.core.skeletons import SKELETONS
from motioncast.metrics.furniture import Legs, crosses, grounded, joint_depth, nearest_of_kind, seated, sits, stands
from motioncast.metrics.ndms import Dictionary, similarity
from motioncast.metrics.onsets import onset_lags, onsets
from motioncast.metrics.paths import FASTEST_M_S, path_length_m, root_path, wasserstein_1
from motioncast.metrics.people import gaps, nearest_approach
from motioncast.metrics.physical import foot_skating, seam_jump, velocity_change
from motioncast.metrics.position import joint_errors
from motioncast.metrics.samples import ade, apd, fde
from motioncast.metrics.synchrony import smoothed, synchrony
from motioncast.metrics.umwr import umwr, umwr_of_second
from motioncast.metrics.words import motion_words, with_seam

SKELETON = SKELETONS[PROTOCOL.skeleton]
FPS, HORIZON = PROTOCOL.fps, PROTOCOL.horizon
LEGS = Legs.of(SKELETON)
HIPS = LEGS.hips
SECONDS = range(1, HORIZON // round(FPS) + 1)

DEEP_M = (0.02, 0.05)
"""Joints deeper than this in a thing are told of: touching, and within."""

NEAR_M = 1.5
"""Bodies whose hips are farther apart do not touch."""

NEIGHBOURS_M = 2.5
"""People who stand farther apart at now are no neighbours."""

EVERY = 5
"""Places are looked at five times a second: the frames between are alike."""

Samples = Sequence[np.ndarray]
"""For each window the futures of a model, ``(samples, time, people, joints, 3)`` metres."""


def figures_of(windows: Sequence[RoomWindow], samples: Samples, real: Dictionary | None = None) -> list[Measured]:
    """The figures of a model.

    Args:
        windows: What happened.
        samples: What was forecast.
        real: Words of real motion for NDMS and UMWR. Default: these are left out.
    """
    tally = Tally(len(windows), HORIZON)
    depths: list[np.ndarray] = []
    lengths: list[np.ndarray] = []
    approaches: list[np.ndarray] = []
    for number, (window, futures) in enumerate(zip(windows, samples, strict=True)):
        body = futures[0]
        errors(tally, number, window, futures)
        lengths.append(ways(tally, number, window, body))
        depths.append(things(tally, number, window, body))
        approaches.append(company(tally, number, window, body))
        goals(tally, number, window, body)
        feet(tally, number, window, body)
        if real is not None:
            words(tally, number, window, body, real)
    in_time(tally, windows, samples)
    found = tally.figures()
    return [
        *(figure for figures in found.values() for figure in figures),
        Ratio("seam_over_real", found["seam_jump"][0], found["real_velocity_change"][0]),
        Pooled("path_length_std", HORIZON, "m", lengths, lambda pairs: float(pairs[:, 0].std())),
        Pooled("path_length_w1", HORIZON, "m", lengths, lambda pairs: wasserstein_1(pairs[:, 0], pairs[:, 1])),
        Pooled("nearest_approach_w1", HORIZON, "m", approaches, lambda pairs: wasserstein_1(pairs[:, 0], pairs[:, 1])),
        Pooled("depth_in_things_p95", HORIZON, "m", depths, lambda deep: float(np.percentile(deep, 95))),
    ]


def over_standing_still(windows: Sequence[RoomWindow], samples: Samples) -> Measured:
    """The mean error at the summary's moments over that of people who stay as they are: below 1 a model is of use."""
    tallies = Tally(len(windows), HORIZON), Tally(len(windows), HORIZON)
    for number, (window, futures) in enumerate(zip(windows, samples, strict=True)):
        for tally, body in zip(tallies, (futures[0], window.scene.positions[-1:]), strict=True):
            displacement(tally, number, window, body)
    forecast, still = (Mean("mpjpe", tally.figures()["mpjpe_at"]) for tally in tallies)
    return Ratio("ratio_to_zero_velocity", forecast, still)


def displacement(tally: Tally, number: int, window: RoomWindow, body: np.ndarray) -> None:
    """Mean distance of joints from where they truly were, at the moments of the protocol."""
    off = np.where(window.seen[..., None], joint_errors(body, window.future), np.nan)
    for frame in PROTOCOL.moments:
        tally.add(number, "mpjpe_at", 1000 * off[frame - 1], "mm", frame)


def errors(tally: Tally, number: int, window: RoomWindow, futures: np.ndarray) -> None:
    """How far from what happened, of the first sample and of the best of all; how far samples are apart."""
    displacement(tally, number, window, futures[0])
    seen = np.broadcast_to(window.seen[..., None], window.future.shape[:-1])[None]
    for name, metric in (("ade", ade), ("fde", fde)):
        found = metric(futures[None], window.future[None], seen)[0]
        tally.add(number, f"{name}_k1", found[0], "m")
        tally.add(number, f"{name}_best_of_{PROTOCOL.samples}_per_person", found.min(0), "m")
    apart = np.where(window.seen.any(0), apd(futures[None])[0], np.nan)
    tally.add(number, f"apd_of_{PROTOCOL.samples}", apart, "m")


def ways(tally: Tally, number: int, window: RoomWindow, body: np.ndarray) -> np.ndarray:
    """Lengths of paths, speed in each second, walls; forecast and true lengths of who stayed, ``(people, 2)``."""
    now, seen = window.scene.positions[-1:], window.seen.T
    path, true = (root_path(np.concatenate([now, motion]), HIPS).swapaxes(0, 1) for motion in (body, window.future))
    speeds = np.linalg.norm(np.diff(path, axis=1), axis=-1) * FPS
    speeds = np.where(seen, np.minimum(speeds, FASTEST_M_S), np.nan)
    for second in SECONDS:
        frames = _second(second)
        tally.add(number, "speed_in_second", speeds[:, frames], "m/s", frames.stop)
    stayed = seen.all(1)
    lengths = np.stack([path_length_m(way[stayed]) for way in (path, true)], -1)
    tally.add(number, "path_length", lengths[:, 0], "m")
    tally.add(number, "people_through_walls", np.any(crosses(window.scene.objects, path) & seen, 1), "1")
    return lengths


def _second(second: int) -> slice:
    return slice(round((second - 1) * FPS), round(second * FPS))


def things(tally: Tally, number: int, window: RoomWindow, body: np.ndarray) -> np.ndarray:
    """Joints in things, seats under who sits, floor under who stands; depths of the deepest joint, ``(n,)``."""
    objects, floor = window.scene.objects, window.scene.floor_m or 0.0
    sitting = sits(body.swapaxes(0, 1), LEGS, FPS, floor).T[::EVERY][window.seen[::EVERY]]
    body = body[::EVERY][window.seen[::EVERY]].astype(np.float64)
    standing = stands(body, LEGS, floor) & ~sitting
    deepest = joint_depth(objects, body, sitting).max(-1)
    tally.add(number, "depth_in_things", deepest, "m")
    for depth in DEEP_M:
        tally.add(number, f"frames_deeper_than_{100 * depth:.0f}_cm", deepest > depth, "1")
    tally.add(number, "sitting_frames", sitting, "1")
    tally.add(number, "seat_under_sitting", seated(objects, body[sitting], LEGS), "1")
    tally.add(number, "floor_under_standing", grounded(objects, body[standing], LEGS, floor), "1")
    return deepest


def company(tally: Tally, number: int, window: RoomWindow, body: np.ndarray) -> np.ndarray:
    """How often and how deep two people are in one another; how near they come and truly came, ``(pairs, 2)``."""
    body, seen = body[::EVERY], window.seen[::EVERY]
    roots = root_path(body, HIPS)
    for one in range(body.shape[1]):
        for other in range(one):
            both = seen[:, one] & seen[:, other]
            near = both & (np.linalg.norm(roots[:, one] - roots[:, other], axis=-1) < NEAR_M)
            overlap = np.zeros(len(body))
            overlap[near] = np.maximum(-gaps(body[near][:, [one, other]], SKELETON.bones)[:, 0], 0)
            tally.add(number, "pairs_overlapping", overlap[both] > 0, "1")
            tally.add(number, "overlap_of_pairs", overlap[both], "m")
    nearest, true = (nearest_approach(path, seen) for path in (roots, root_path(window.future[::EVERY], HIPS)))
    tally.add(number, "nearest_approach", nearest, "m")
    return np.stack([nearest, true], -1)[~np.isnan(nearest)]


def goals(tally: Tally, number: int, window: RoomWindow, body: np.ndarray) -> None:
    """Whether people are at what they truly went to, when they truly did, among all of its kind."""
    objects = window.scene.objects
    for goal in window.goals:
        used, place = objects[goal.thing], body[goal.frame - 1, goal.person, list(LEGS.root)].mean(0)
        kind = sum(thing.category == used.category for thing in objects)
        for what in ("goal", f"goal_{goal.kind}", *("goal_ahead",) * ahead(window, goal)):
            tally.add(number, f"{what}_accuracy", nearest_of_kind(objects, used, place), "1")
            tally.add(number, f"{what}_chance", np.array(1 / kind), "1")


def ahead(window: RoomWindow, goal: Goal) -> bool:
    """Whether the way is still ahead: many are there from the start, but here another of the kind is nearer at now."""
    place = window.scene.positions[-1, goal.person, list(LEGS.root)].mean(0)
    return not nearest_of_kind(window.scene.objects, window.scene.objects[goal.thing], place)


def feet(tally: Tally, number: int, window: RoomWindow, body: np.ndarray) -> None:
    """Jump at the seam over that of real motion at any moment, and feet that slide."""
    past = window.scene.positions.swapaxes(0, 1)
    there = window.scene.observed.swapaxes(0, 1)
    future, seen = body.swapaxes(0, 1), window.seen.T
    tally.add(number, "seam_jump", np.where(seen[:, 0], seam_jump(past, future, FPS, there), np.nan), "m/s")
    true = np.where(seen[..., None, None], window.future.swapaxes(0, 1), np.nan)
    for person, way in enumerate(true):
        frames = seen[person]
        if frames.sum() > 1:
            # ankles are not at the floor: the height at which each of this person's own stands
            ground = np.percentile(way[frames][:, LEGS.ankles, 2], 5, axis=0).tolist()
            mask = np.broadcast_to(frames[:, None], body.shape[:1] + body.shape[2:3])
            tally.add(number, "foot_skating", foot_skating(future[person], LEGS.ankles, ground, FPS, mask), "m/s")
            tally.add(number, "real_velocity_change", velocity_change(way[frames], FPS), "m/s")


def words(tally: Tally, number: int, window: RoomWindow, body: np.ndarray, real: Dictionary) -> None:
    """NDMS and UMWR of one person of the window: the first who stayed."""
    stayed = np.flatnonzero(window.seen.all(0))[:1]
    if not len(stayed):
        return
    motion = with_seam(window.scene.positions[:, stayed[0]], body[:, stayed[0]])
    found = motion_words(motion, HIPS)
    nearest = real.nearest(found)
    tally.add(number, "ndms", similarity(found, real.words[nearest]), "1")
    for second in SECONDS[1::2]:
        tally.add(number, "umwr_of_second", umwr_of_second(nearest, second, FPS), "1", _second(second).stop)
    tally.add(number, "umwr", umwr(nearest), "1")


def in_time(tally: Tally, windows: Sequence[RoomWindow], samples: Samples) -> None:
    """Do neighbours, recorded together or composed, go at one pace and set out together, more than with strangers?"""
    speeds, rooms, owners, kinds = [], [], [], []
    for number, (window, futures) in enumerate(zip(windows, samples, strict=True)):
        roots = root_path(np.concatenate([window.scene.positions[-1:], futures[0]]), HIPS)
        pace = smoothed(np.linalg.norm(np.diff(roots, axis=0), axis=-1).T * FPS, round(FPS))
        stayed = np.all(window.seen, 0)
        for one in range(len(pace)):
            for other in range(one):
                apart = np.linalg.norm(roots[0, one] - roots[0, other])
                if stayed[one] and stayed[other] and apart < NEIGHBOURS_M:
                    speeds.append((pace[one], pace[other]))
                    rooms.append(window.room)
                    owners.append(number)
                    kinds.append("recorded" if {one, other} in window.pairs else "composed")
    if not speeds:
        return
    one, other = np.moveaxis(np.array(speeds), 1, 0)
    mine, theirs = ([onsets(pace) for pace in side] for side in (one, other))
    for name, unit, (real, shuffled) in (
        ("synchrony", "1", synchrony(one, other, rooms)),
        ("onset_lag", "s", onset_lags(mine, theirs, rooms, FPS)),
    ):
        for owner, kind, together, strangers in zip(owners, kinds, real, shuffled, strict=True):
            tally.add(owner, f"{name}_{kind}", together, unit)
            tally.add(owner, f"{name}_{kind}_over_strangers", together - strangers, unit)
