"""``motioncast info``: what a motion file holds."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from motioncast.cli.reading import AS_THE_FILE_SAYS, Reading, frames_needed, holds_forecast, put_into, read_scene
from motioncast.cli.say import table
from motioncast.core.card import ModelCard
from motioncast.core.scene import Scene
from motioncast.core.scene_object import SceneObject
from motioncast.core.skeleton import Skeleton
from motioncast.errors import SkeletonError


def info(*files: Path, room: Path | None = None, reading: Reading = AS_THE_FILE_SAYS) -> None:
    """Say what motion files hold: people, rate, what each joint was recognised as, and whether it can be forecast.

    Args:
        files: One scene file, or one motion file a person.
        room: Furniture around the people: a JSON file written by hand, or a GLB whose nodes are named.
        reading: How to read files whose header lies.
    """
    from motioncast.formats.units import stature
    from motioncast.inference.registry import list_models

    scene = read_scene(files, reading)
    if room is not None:
        scene = put_into(scene, room)
    print(f"{scene.source}")
    print(f"{scene.frames} frames at {scene.fps:g} a second, {scene.duration_s:.2f} s")
    print(f"skeleton {scene.skeleton.label}, {len(scene.skeleton)} joints")
    if len(files) == 1 and holds_forecast(files[0]):
        print(forecast_line(files[0]))
    print()
    rows = []
    for row, person in enumerate(scene.people):
        alone = scene.select((person,))
        seen = np.flatnonzero(alone.observed.any((1, 2)))
        when = f"{seen[0] / scene.fps:.2f} to {(seen[-1] + 1) / scene.fps:.2f} s" if len(seen) else "never"
        height = stature(alone.positions, alone.observed, alone.skeleton)
        rows.append((person, when, f"{scene.observed[:, row].mean():.0%}", f"{height:.2f} m"))
    table(("person", "there", "joints seen", "stature about"), rows)
    print()
    if scene.objects:
        table(("object", "category", "shape", "size", "where"), [thing_row(thing) for thing in scene.objects])
        print(f"floor at {scene.floor_m:.2f} m\n" if scene.floor_m is not None else "")
    lengths = bone_lengths(scene)
    names = scene.skeleton.names
    table(
        ("joint", "recognised as", "parent", "distance"),
        [
            (
                name,
                scene.skeleton.landmarks[joint] or "-",
                names[parent] if parent >= 0 else "-",
                "-" if np.isnan(lengths[joint]) else f"{lengths[joint] * 100:.1f} cm",
            )
            for joint, (name, parent) in enumerate(zip(names, scene.skeleton.parents, strict=True))
        ],
    )
    default = list_models()[0]
    reason = obstacle(scene, default)
    print("\nready to forecast" if reason is None else f"\ncannot be forecast by {default.name}: {reason}")


def thing_row(thing: SceneObject) -> tuple[str, ...]:
    """An object as a line of a table; of one that moves, where it is in the end."""
    size = " x ".join(f"{length:.2f}" for length in thing.size)
    x, y, z = thing.at(-1).position
    where = f"({x:.2f}, {y:.2f}, {z:.2f})" + (", moves" if thing.moves else "")
    return thing.name, thing.category.replace("_", " "), thing.shape, f"{size} m", where


def forecast_line(file: Path) -> str:
    """What a forecast file adds to its history."""
    from motioncast.formats.load import load_forecast, load_truth

    answer, truth = load_forecast(file), load_truth(file)
    happened = "not known" if truth is None else f"in it too, {truth.duration_s:.2f} s"
    return (
        f"and a forecast by {answer.card.name}, {answer.horizon_s:.2f} s, of {', '.join(answer.people)}; "
        f"what really happened is {happened}"
    )


def obstacle(scene: Scene, card: ModelCard) -> str | None:
    """Why a model cannot forecast from the end of a scene, and what to do; None if it can."""
    missing = missing_places(card.joints, scene.skeleton)
    if missing:
        return f'no joint for {", ".join(missing)}; name them with --map FILE (one "joint = landmark" a line)'
    needed = frames_needed(card, scene.fps)
    if scene.frames < needed:
        return f"{scene.frames} frames are here and it reads {needed} at {scene.fps:g} a second; give a longer motion"
    there = int(scene.observed[-1].any(-1).sum())
    if not there:
        return "nobody is seen in the last frame; forecast from an earlier moment with --at SECONDS"
    if there > card.people:
        return f"{there} people are seen in the last frame and it takes at most {card.people}; forecast them in groups"
    return None


def missing_places(wanted: Skeleton, skeleton: Skeleton) -> list[str]:
    """Places of a skeleton that another has no joint for, and no stand-in."""
    missing = []
    for place in wanted.landmarks:
        try:
            Skeleton((place,), (-1,), (place,)).map_from(skeleton)
        except SkeletonError:
            missing.append(place)
    return missing


def bone_lengths(scene: Scene) -> np.ndarray:
    """Median distance of each joint from its parent, ``(joints,)`` metres; NaN if unknown."""
    lengths = np.full(len(scene.skeleton), np.nan)
    for joint, parent in scene.skeleton.bones:
        seen = scene.observed[:, :, joint] & scene.observed[:, :, parent]
        if seen.any():
            bone = scene.positions[:, :, joint][seen] - scene.positions[:, :, parent][seen]
            lengths[joint] = np.median(np.linalg.norm(bone, axis=-1))
    return lengths
