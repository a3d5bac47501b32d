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
from motioncast.datasets.rooms.acts import LOOK_BACK, Actor, actor_of, around, perform
from motioncast.datasets.rooms.bodies import PELVIS
from motioncast.datasets.rooms.clips import Clip, Library, load
from motioncast.datasets.rooms.contacts import FPS
from motioncast.datasets.rooms.events import Event
from motioncast.datasets.rooms.footprint import footprint
from motioncast.datasets.rooms.furnish import decoys, walls
from motioncast.datasets.rooms.ground import Ground
from motioncast.datasets.rooms.solo import on_the_floor, solo
from motioncast.datasets.rooms.stitch import placed
from motioncast.datasets.rooms.tracks import Track, enter, walk_to

WISHES = {"walk": 0.2, "stand": 0.08, "sit": 0.36, "reach": 0.16, "write": 0.08, "play": 0.12}
"""What somebody wants to do next, and how often."""

LEAD = round(8 * FPS)
"""Frames that are made and thrown away, so that a room does not start empty."""

SHORTEST_TRACK = round(11 * FPS)
TRIES = 12


@dataclass(frozen=True, slots=True)
class Recipe:
    """How rooms of one split are made.

    Attributes:
        people: Fewest and most people over the whole scene.
        objects: Fewest and most decoys and used things, walls counted.
        seconds: Shortest and longest scene.
        couple: Share of rooms with the dancing couple.
        solo: Share of people who are there with a whole take.
    """

    people: tuple[int, int] = (1, 8)
    objects: tuple[int, int] = (24, 32)
    seconds: tuple[float, float] = (24.0, 40.0)
    couple: float = 0.2
    solo: float = 0.15


RECIPES = {"train": Recipe(), "validation": Recipe(), "test": Recipe(people=(1, 16), objects=(30, 46))}


@dataclass(frozen=True, slots=True, eq=False)
class Room:
    """A furnished room and what happens in it.

    Attributes:
        scene: People on the 31 joints of CMU, objects, floor at 0; ``scene.on(MRT15)`` for a model.
        events: What people do.
        pairs: For each two people whether they were ``recorded`` together or ``composed``.
        synthetic: Frames that inverse kinematics made, ``(time, people)`` bool.
        takes: The takes that each person is made of.
        seed: That made it.
        split: ``train``, ``validation`` or ``test``.
    """

    scene: Scene
    events: tuple[Event, ...]
    pairs: dict[tuple[int, int], str]
    synthetic: np.ndarray
    takes: tuple[tuple[str, ...], ...]
    seed: int
    split: str

    @property
    def here(self) -> np.ndarray:
        """Who is there when, ``(time, people)`` bool."""
        return self.scene.observed.all(-1)


@dataclass(frozen=True, slots=True, eq=False)
class Cast:
    """Who can play in the rooms of one split: by subject who walks, whole takes on the floor, and couples."""

    actors: dict[int, Actor]
    solos: tuple[Clip, ...]
    couples: tuple[Clip, ...]


def cast(library: Library) -> Cast:
    """The walks and couples of a library."""
    actors = {subject: actor for subject, clips in library.singles.items() if (actor := actor_of(clips))}
    solos = tuple(clip for clips in library.singles.values() for clip in clips if on_the_floor(clip))
    return Cast(actors, solos, tuple(clip for clip in library.couples if len(clip.positions) >= SHORTEST_TRACK))


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
        seed: Of everything that is drawn.
    """
    recipe, random = RECIPES[split], np.random.default_rng([seed, *split.encode()])
    people = int(random.integers(recipe.people[0], recipe.people[1] + 1))
    frames = LEAD + round(random.uniform(*recipe.seconds) * FPS)
    ground = _ground(people, frames, random)
    bodies: list[np.ndarray] = []  # (frames, 31, 3) each, not a number while away
    takes: list[tuple[str, ...]] = []
    together: set[tuple[int, int]] = set()
    tracks: dict[int, Track] = {}
    if people > 1 and players.couples and random.random() < recipe.couple:
        clip = players.couples[int(random.integers(len(players.couples)))]
        dancers = _couple(clip, ground, random)
        if dancers is not None:
            bodies += dancers
            takes += [(clip.name,), (clip.name.replace("60_", "61_"),)]
            together.add((0, 1))
    while len(bodies) < people:
        made = _somebody(players, recipe, ground, random)
        if made is None:
            break
        track, body = made
        tracks[len(bodies)] = track
        bodies.append(body)
        takes.append(tuple(dict.fromkeys(track.takes)))
    positions = np.stack(bodies, 1)[LEAD:]
    here = np.isfinite(positions[..., 0]).all(-1)
    kept = np.flatnonzero(here.sum(0) >= FPS)
    positions, here = positions[:, kept], here[:, kept]
    numbers = {old: new for new, old in enumerate(kept.tolist())}
    synthetic, events, used = np.zeros(here.shape, bool), [], []
    for old, track in tracks.items():
        used += track.things
        if old not in numbers:
            continue
        offset, person = track.start - LEAD, numbers[old]
        for first, end in track.made:
            synthetic[max(first + offset, 0) : max(end + offset, 0), person] = True
        for event in track.events:
            first, end = max(event.start + offset, 0), min(event.end + offset, len(positions))
            if first < end:
                events.append(replace(event, person=person, start=first, end=end))
    events.sort(key=lambda event: event.start)
    points = positions[::2][here[::2]].reshape(-1, 3)
    taken = footprint(points, ground.half)
    for item in used:
        taken.take(*item.position[:2], float(2 * np.arctan2(item.rotation[3], item.rotation[0])), *item.size[:2])
    structure = walls(ground.half, ground.doors)
    wanted = int(random.integers(recipe.objects[0], recipe.objects[1] + 1)) - len(structure) - len(used)
    kinds = [item.name.rsplit(" ", 1)[0] for item in used]
    objects = [*structure, *used, *decoys(kinds, wanted, taken, ground, random)]
    scene = _scene(positions, here, objects, f"room {split} {seed}")
    recorded = {(numbers[one], numbers[other]) for one, other in together if {one, other} <= numbers.keys()}
    pairs = {
        pair: "recorded" if pair in recorded else "composed" for pair in combinations(range(len(kept)), 2)
    }
    chosen = tuple(takes[old] for old in kept)
    return Room(scene, tuple(events), pairs, synthetic, chosen, seed, split)


def _scene(positions: np.ndarray, here: np.ndarray, objects: list[SceneObject], source: str) -> Scene:
    observed = np.repeat(here[..., None], len(CMU31), -1)
    filled = np.where(observed[..., None], positions, 0).astype(np.float32)
    return Scene(filled, CMU31, FPS, observed, source=source, objects=tuple(objects), floor_m=0.0)


def _ground(people: int, frames: int, random: np.random.Generator) -> Ground:
    """An empty room, larger for more people, with a door or more in its walls."""
    area, aspect = 36 + 7 * people, random.uniform(1.0, 1.5)
    half = np.sqrt(area) / 2 * np.array([np.sqrt(aspect), 1 / np.sqrt(aspect)])
    doors = []
    for side in random.permutation(4)[: 1 + int(people > 3) + int(people > 9)]:
        aside = random.uniform(-0.5, 0.5)
        x, y = ((half[0], aside * half[1]), (aside * half[0], half[1]))[side % 2]
        sign = 1 if side < 2 else -1
        x, y = (sign * x, y) if side % 2 == 0 else (x, sign * y)
        inward = np.arctan2(0.0 if side % 2 == 0 else -sign, -sign if side % 2 == 0 else 0.0)
        doors.append((x, y, inward))
    return Ground(half, np.array(doors), frames)


def _couple(clip: Clip, ground: Ground, random: np.random.Generator) -> list[np.ndarray] | None:
    """The dancing couple set down inside the room, or None where it does not fit."""
    path = clip.positions[:, :, PELVIS, :2]
    middle = (path.reshape(-1, 2).max(0) + path.reshape(-1, 2).min(0)) / 2
    start = int(random.integers(0, max(1, ground.frames - SHORTEST_TRACK)))
    for _ in range(TRIES):
        angle = random.uniform(0, 2 * np.pi)
        there = placed(clip.positions - np.array([*middle, 0]), angle, random.uniform(-1, 1, 2) * (ground.half - 1.5))
        ways = np.moveaxis(there[:, :, PELVIS, :2], 1, 0)
        if ground.inside(ways).all():
            return [_enrolled(there[:, person], start, ground) for person in range(2)]
    return None


def _somebody(
    players: Cast, recipe: Recipe, ground: Ground, random: np.random.Generator
) -> tuple[Track, np.ndarray] | None:
    """Somebody who comes in, acts here and there and leaves, or is there with a whole take; None without a way."""
    subjects = list(players.actors)
    for _ in range(TRIES):
        start = int(random.integers(0, ground.frames - SHORTEST_TRACK))
        known = list(ground.things)
        if players.solos and random.random() < recipe.solo:
            clip = players.solos[int(random.integers(len(players.solos)))]
            track = solo(clip, start, ground, random)
            if track is not None:
                ground.things += [circle for item in track.things for circle in around(item)]
        else:
            actor = players.actors[subjects[int(random.integers(len(subjects)))]]
            track = _way(actor, start, ground, random)
        if track is not None:
            return track, _enrolled(track.positions, start, ground)
        ground.things = known
    return None


def _way(actor: Actor, start: int, ground: Ground, random: np.random.Generator) -> Track | None:
    door = ground.doors[int(random.integers(len(ground.doors)))]
    track = enter(actor.gait, door, start, random)
    until = min(ground.frames, start + round(random.uniform(11, 60) * FPS))
    misses = 0
    while track.now < until and misses < 4:
        kind = str(random.choice(list(WISHES), p=list(WISHES.values())))
        goal = _goal(kind, ground, random)
        onward = walk_to(track, actor.gait, goal, ground, random)
        if onward is None:
            misses += 1
            continue
        track = onward
        if kind != "walk" and track.frames > LOOK_BACK:
            acted = perform(track, actor, kind, ground, random)
            if acted is not None:
                new = acted.things[len(track.things) :]
                ground.things += [circle for item in new for circle in around(item)]
                track = acted
    if track.now < ground.frames:
        x, y, angle = ground.doors[int(random.integers(len(ground.doors)))]
        outside = np.array([x, y]) - 0.9 * np.array([np.cos(angle), np.sin(angle)])
        track = walk_to(track, actor.gait, outside, ground, random, 0.5) or track
    return track if track.frames >= SHORTEST_TRACK else None


def _goal(kind: str, ground: Ground, random: np.random.Generator) -> np.ndarray:
    """Somewhere in the room; by a wall for what is done there."""
    if kind not in ("reach", "write"):
        return random.uniform(-1, 1, 2) * (ground.half - 1.3)
    goal = random.uniform(-1, 1, 2) * (ground.half - 1.3)
    axis = int(random.integers(2))
    goal[axis] = random.choice([-1, 1]) * (ground.half[axis] - 1.2)
    return goal


def _enrolled(positions: np.ndarray, start: int, ground: Ground) -> np.ndarray:
    """The body on the clock of the room, ``(frames, 31, 3)``; from now on others keep clear of it."""
    body = np.full((ground.frames, len(CMU31), 3), np.nan)
    end = min(ground.frames, start + len(positions))
    body[start:end] = positions[: end - start]
    ground.people.append(body[:, PELVIS, :2])
    return body
