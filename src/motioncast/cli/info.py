"""``motioncast info``: what a motion file holds."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from motioncast.cli.reading import AS_THE_FILE_SAYS, Reading, read_scene
from motioncast.cli.say import table
from motioncast.core.scene import Scene


def info(*files: Path, reading: Reading = AS_THE_FILE_SAYS) -> None:
    """Say what motion files hold: people, rate, and what each joint was recognised as.

    Args:
        files: One scene file, or one motion file a person.
        reading: How to read files whose header lies.
    """
    from motioncast.formats.units import stature

    scene = read_scene(files, reading)
    print(f"{scene.source}")
    print(f"{scene.frames} frames at {scene.fps:g} a second, {scene.duration_s:.2f} s")
    print(f"skeleton {scene.skeleton.label}, {len(scene.skeleton)} joints\n")
    rows = []
    for row, person in enumerate(scene.people):
        alone = scene.select((person,))
        seen = np.flatnonzero(alone.observed.any((1, 2)))
        when = f"{seen[0] / scene.fps:.2f} to {(seen[-1] + 1) / scene.fps:.2f} s" if len(seen) else "never"
        height = stature(alone.positions, alone.observed, alone.skeleton)
        rows.append((person, when, f"{scene.observed[:, row].mean():.0%}", f"{height:.2f} m"))
    table(("person", "there", "joints seen", "stature about"), rows)
    print()
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


def bone_lengths(scene: Scene) -> np.ndarray:
    """Median distance of each joint from its parent, ``(joints,)`` metres; NaN if unknown."""
    lengths = np.full(len(scene.skeleton), np.nan)
    for joint, parent in scene.skeleton.bones:
        seen = scene.observed[:, :, joint] & scene.observed[:, :, parent]
        if seen.any():
            bone = scene.positions[:, :, joint][seen] - scene.positions[:, :, parent][seen]
            lengths[joint] = np.median(np.linalg.norm(bone, axis=-1))
    return lengths
