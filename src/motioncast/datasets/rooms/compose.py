"""Rooms: people who come and go, and the furniture that what they do asks for."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import combinations
from pathlib import Path

import numpy as np

from motioncast.core.scene import Scene
from motioncast.core.scene_object import SceneObject
from motioncast.core.skeletons import CMU31
from motioncast.datasets.rooms.clips import load
from motioncast.datasets.rooms.contacts import FPS
from motioncast.datasets.rooms.events import Event
from motioncast.datasets.rooms.fitting import yaw
from motioncast.datasets.rooms.footprint import footprint
from motioncast.datasets.rooms.furnish import decoys, walls
from motioncast.datasets.rooms.ground import LEAD, Ground
from motioncast.datasets.rooms.people import Cast, cast, couple, enrol, on_clock, somebody
from motioncast.datasets.rooms.tracks import Track


@dataclass(frozen=True, slots=True)
class Recipe:
    """How the rooms of one split are made.

    Attributes:
        people: Fewest and most people over the whole scene.
        objects: Fewest and most objects, walls and used things counted.
        seconds: Shortest and longest scene.
        couple: Share of rooms with the dancing couple.
        solo: Share of people who are there with a whole take.
    """

    people: tuple[int, int] = (1, 8)
    objects: tuple[int, int] = (24, 32)
    seconds: tuple[float, float] = (24.0, 40.0)
    couple: float = 0.2
    solo: float = 0.15


RECIPES = {"train": Recipe(), "validation": Recipe(), "test": Recipe(people=(1, 16), objects=(30, 50))}


@dataclass(frozen=True, slots=True, eq=False)
class Room:
    """A furnished room and what happens in it.

    Attributes:
        scene: People on the 31 joints of CMU, objects, floor at 0; ``scene.on(MRT15)`` for a model.
        events: What people do, by their start.
        pairs: For each two people whether they were ``recorded`` together or ``composed``.
        synthetic: Frames that inverse kinematics made, ``(time, people)`` bool.
        takes: The takes that each person is made of.
        half: Half the length and width of the room, ``(2,)``; its middle is the origin.
        seed: That made it.
        split: ``train``, ``validation`` or ``test``.
    """

    scene: Scene
    events: tuple[Event, ...]
    pairs: dict[tuple[int, int], str]
    synthetic: np.ndarray
    takes: tuple[tuple[str, ...], ...]
    half: np.ndarray
    seed: int
    split: str

    @property
    def here(self) -> np.ndarray:
        """Who is there when, ``(time, people)`` bool."""
        return np.all(self.scene.observed, -1)


def rooms(data: str | Path, split: str, count: int, seed: int) -> Iterator[Room]:
    """Rooms of one split; the same seed gives the same rooms.

    Args:
        data: Folder with CMU's takes: see :func:`motioncast.datasets.cmu.takes`.
        split: ``train``, ``validation`` or ``test``.
        count: How many.
        seed: Of the first room; the others count on from it.

    Raises:
        InputError: If the folder holds no takes.
    """
    players = cast(load(data, split))
    for number in range(count):
        yield room(players, split, seed + number)


def room(players: Cast, split: str, seed: int) -> Room:
    """One room.

    Args:
        players: Who can play in it.
        split: Whose recipe is followed.
        seed: Of everything that is drawn; rooms of different splits share nothing.
    """
    recipe, random = RECIPES[split], np.random.default_rng([seed, *split.encode()])
    people = int(random.integers(recipe.people[0], recipe.people[1] + 1))
    frames = LEAD + round(random.uniform(*recipe.seconds) * FPS)
    ground, tracks, recorded = _crowd(players, people, frames, recipe, random)
    positions = np.stack([on_clock(track, frames) for track in tracks], 1)[LEAD:]
    seen = np.isfinite(positions[:, :, 0, 0]).sum(0) >= FPS
    # the couple stays together or goes together
    positions, stay = positions[:, seen], [track for track, here in zip(tracks, seen, strict=True) if here]
    here = np.isfinite(positions[:, :, 0, 0])
    events, synthetic = _events(stay, len(positions)), _synthetic(stay, here.shape)
    used = _roles([item for track in tracks for item in track.things], events)
    objects = _furnished(positions[here].reshape(-1, 3), used, recipe, ground, random)
    pairs = dict.fromkeys(combinations(range(len(stay)), 2), "composed")
    if recorded and seen[:2].all():
        pairs[0, 1] = "recorded"
    observed = np.repeat(here[..., None], len(CMU31), -1)
    scene = Scene(
        np.nan_to_num(positions).astype(np.float32),
        CMU31,
        FPS,
        observed,
        source=f"room {seed} ({split})",
        objects=tuple(objects),
        floor_m=0.0,
    )
    takes = tuple(tuple(dict.fromkeys(track.takes)) for track in stay)
    return Room(scene, tuple(events), pairs, synthetic, takes, ground.half, seed, split)


def _crowd(
    players: Cast, people: int, frames: int, recipe: Recipe, random: np.random.Generator
) -> tuple[Ground, list[Track], bool]:
    """A room with people in it, fewer where no more find a way, and whether the first two were recorded together."""
    while True:  # where not even one finds a way, another room is drawn
        ground = _ground(people, frames, random)
        tracks = couple(players, ground, random) if people > 1 and random.random() < recipe.couple else []
        recorded = bool(tracks)
        for track in tracks:
            enrol(track, ground)
        while len(tracks) < people and (track := somebody(players, recipe.solo, ground, random)) is not None:
            enrol(track, ground)
            tracks.append(track)
        if tracks:
            return ground, tracks, recorded


def _ground(people: int, frames: int, random: np.random.Generator) -> Ground:
    """An empty room, larger for more people, with one to three doors in its walls."""
    area, aspect = 36 + 7 * people, random.uniform(1.0, 1.5)
    half = np.sqrt(area) / 2 * np.array([np.sqrt(aspect), 1 / np.sqrt(aspect)])
    doors = []
    for side in random.permutation(4)[: 1 + int(people > 3) + int(people > 9)]:
        axis, sign = int(side) % 2, 1 if side < 2 else -1
        place = random.uniform(-0.5, 0.5, 2) * half
        place[axis] = sign * half[axis]
        doors.append((*place, np.arctan2(-sign * axis, -sign * (1 - axis))))
    return Ground(half, np.array(doors), frames)


def _events(tracks: list[Track], frames: int) -> list[Event]:
    """What happens within the room's time, on its clock."""
    found = []
    for person, track in enumerate(tracks):
        offset = track.start - LEAD
        for event in track.events:
            first, end = max(event.start + offset, 0), min(event.end + offset, frames)
            if first < end:
                found.append(replace(event, person=person, start=first, end=end))
    return sorted(found, key=lambda event: event.start)


def _synthetic(tracks: list[Track], shape: tuple[int, ...]) -> np.ndarray:
    """Frames that inverse kinematics made, ``(time, people)``."""
    made = np.zeros(shape, bool)
    for person, track in enumerate(tracks):
        for first, end in track.made:
            made[max(first + track.start - LEAD, 0) : max(end + track.start - LEAD, 0), person] = True
    return made


def _roles(things: list[SceneObject], events: list[Event]) -> list[SceneObject]:
    """What is used within the room's time is caused, what it stands on too; what was used before is a decoy."""
    names = {event.thing for event in events}
    points = [item.position[:2] for item in things if item.name in names]
    return [
        item
        if item.name in names or any(np.abs(item.inward(np.array([*point, 0]))[:2]).max() < 0.6 for point in points)
        else replace(item, role="decoy")
        for item in things
    ]


def _furnished(
    joints: np.ndarray, used: list[SceneObject], recipe: Recipe, ground: Ground, random: np.random.Generator
) -> list[SceneObject]:
    """Walls, the used things, and decoys where no joint ever is."""
    taken = footprint(joints, ground.half)
    for item in used:
        taken.take(float(item.position[0]), float(item.position[1]), yaw(item), *item.size[:2].tolist())
    structure = walls(ground.half, ground.doors)
    count = int(random.integers(recipe.objects[0], recipe.objects[1] + 1)) - len(structure) - len(used)
    kinds = [item.name.rsplit(" ", 1)[0] for item in used if item.role == "caused"]
    return [*structure, *used, *decoys(kinds, count, taken, ground, random)]
