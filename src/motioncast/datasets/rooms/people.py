"""Who is in a room: walkers who come, act and leave, people with a whole take, the dancing couple."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from motioncast.core.shapes import signed_distance
from motioncast.core.skeletons import CMU31
from motioncast.datasets.rooms.actors import Actor, actor_of
from motioncast.datasets.rooms.acts import LOOK_BACK, perform
from motioncast.datasets.rooms.bodies import PELVIS
from motioncast.datasets.rooms.clips import Clip, Library
from motioncast.datasets.rooms.contacts import FPS
from motioncast.datasets.rooms.fitting import DEEPEST_M, around
from motioncast.datasets.rooms.ground import LEAD, LOOKED_AT, Ground
from motioncast.datasets.rooms.solo import on_the_floor, solo
from motioncast.datasets.rooms.stitch import placed
from motioncast.datasets.rooms.tracks import SHORTEST, Track, enter, walk_to, whole_take

WISHES = {"walk": 0.08, "stand": 0.1, "sit": 0.4, "reach": 0.08, "fetch": 0.1, "write": 0.08, "play": 0.16}
"""What a walker wants to do next, and how often; who fetches something reaches here and then there."""

FROM_THE_OUTSET = 0.5
"""Share of people who are there when the scene begins; the others come at any time."""

LONGEST_S = 60
TRIES = 12
ATTEMPTS = 3
"""An act is drawn anew so often where its thing would stand in the way."""

FROM_WALL_M = 1.3
"""Goals of a walk lie this far from walls; a wall that one works at is a little nearer."""


@dataclass(frozen=True, slots=True, eq=False)
class Cast:
    """Who can play in the rooms of one split: by subject who walks, whole takes on the floor, and couples."""

    actors: dict[int, Actor]
    solos: tuple[Clip, ...]
    couples: tuple[Clip, ...]


def cast(library: Library) -> Cast:
    """Who can play, from the clips of a split."""
    actors = {subject: actor for subject, clips in library.singles.items() if (actor := actor_of(clips))}
    solos = tuple(clip for clips in library.singles.values() for clip in clips if on_the_floor(clip))
    return Cast(actors, solos, tuple(clip for clip in library.couples if len(clip.positions) >= SHORTEST))


def enrol(track: Track, ground: Ground) -> None:
    """Put a track on the clock of the room; from now on others keep clear of the person and of the things."""
    path = np.full((ground.frames, 2), np.nan)
    positions = track.positions[: ground.frames - track.start]
    path[track.start : track.start + len(positions)] = positions[:, PELVIS, :2]
    ground.people.append(path)
    ground.things += [circle for item in track.things for circle in around(item)]
    ground.items += track.things
    ground.bodies.append(positions[::LOOKED_AT])


def clean(track: Track, ground: Ground) -> bool:
    """Whether nobody of those before is in a new thing, and the new body in none of theirs."""
    body = track.positions[: ground.frames - track.start : LOOKED_AT]
    pairs = [(item, body) for item in ground.items]
    pairs += [(item, other) for item in track.things for other in ground.bodies]
    return all((signed_distance(item, joints) > -DEEPEST_M).all() for item, joints in pairs)


def on_clock(track: Track, frames: int) -> np.ndarray:
    """The body on the clock of the room, ``(frames, 31, 3)``, not a number while it is away."""
    body = np.full((frames, len(CMU31), 3), np.nan)
    positions = track.positions[: frames - track.start]
    body[track.start : track.start + len(positions)] = positions
    return body


def couple(players: Cast, ground: Ground, random: np.random.Generator) -> list[Track]:
    """The dancing couple set down inside the room together, or nobody where it does not fit."""
    clip = players.couples[int(random.integers(len(players.couples)))]
    path = clip.positions[:, :, PELVIS, :2].reshape(-1, 2)
    middle = np.array([*((path.max(0) + path.min(0)) / 2), 0])
    start = int(random.integers(0, ground.frames - SHORTEST))
    for _ in range(TRIES):
        shift = random.uniform(-1, 1, 2) * (ground.half - FROM_WALL_M)
        there = placed(clip.positions - middle, random.uniform(0, 2 * np.pi), shift)
        if ground.free(np.moveaxis(there[:, :, PELVIS, :2], 1, 0), start).all():
            names = (clip.name, clip.name.replace("60_", "61_"))
            return [whole_take(there[:, person], start, name) for person, name in enumerate(names)]
    return []


def somebody(players: Cast, solos: float, ground: Ground, random: np.random.Generator) -> Track | None:
    """One more person, or None where no way was found.

    Args:
        players: Who can play.
        solos: Share of people who are there with a whole take.
        ground: The room so far.
        random: Source of everything that is drawn.
    """
    subjects = list(players.actors)
    for _ in range(TRIES):
        latest = LEAD if random.random() < FROM_THE_OUTSET else ground.frames - SHORTEST
        start = int(random.integers(0, latest))
        if players.solos and random.random() < solos:
            track = solo(players.solos[int(random.integers(len(players.solos)))], start, ground, random)
        else:
            track = walker(players.actors[subjects[int(random.integers(len(subjects)))]], start, ground, random)
        if track is not None and clean(track, ground):
            return track
    return None


def walker(actor: Actor, start: int, ground: Ground, random: np.random.Generator) -> Track | None:
    """Somebody who comes in by a door, does this and that, and leaves by a door if there is time."""
    known = list(ground.things)
    track = enter(actor.gait, ground.doors[int(random.integers(len(ground.doors)))], start, random)
    until = min(ground.frames, start + round(random.uniform(SHORTEST / FPS, LONGEST_S) * FPS))
    misses, fetched = 0, -1  # frame in which the hand left what is fetched, or -1
    while track.now < until and misses < 4:
        kind = "reach" if fetched >= 0 else str(random.choice(list(WISHES), p=list(WISHES.values())))
        onward = walk_to(track, actor.gait, _goal(kind, ground, random), ground, random)
        if onward is None:
            misses += 1
            continue
        track = onward
        acted = _acted(track, actor, "reach" if kind == "fetch" else kind, ground, random)
        if acted is None:
            continue
        ground.things += [circle for item in acted.things[len(track.things) :] for circle in around(item)]
        new = acted.events[len(track.events) :]
        track, fetched, before = acted, -1, fetched
        if new and new[-1].kind == "reach":
            if before >= 0:
                fetch = replace(new[0], kind="fetch", start=before, end=new[0].start)
                track = replace(track, events=(*track.events, fetch))
            elif kind == "fetch":
                fetched = new[-1].end
    if track.now < ground.frames:
        x, y, angle = ground.doors[int(random.integers(len(ground.doors)))]
        outside = np.array([x, y]) - 0.9 * np.array([np.cos(angle), np.sin(angle)])
        track = walk_to(track, actor.gait, outside, ground, random, 0.5) or track
    ground.things = known  # they count from the moment on that the track is enrolled
    return track if track.frames >= SHORTEST else None


def _acted(track: Track, actor: Actor, kind: str, ground: Ground, random: np.random.Generator) -> Track | None:
    """The track with what was wished for, or else with something that needs no thing, or None."""
    if kind == "walk" or track.frames <= LOOK_BACK:
        return None
    for act in (*(kind,) * ATTEMPTS, "play", "stand"):
        acted = perform(track, actor, act, ground, random)
        if acted is not None:
            return acted
    return None


def _goal(kind: str, ground: Ground, random: np.random.Generator) -> np.ndarray:
    """Somewhere in the room; near a wall for what is done there."""
    goal = random.uniform(-1, 1, 2) * (ground.half - FROM_WALL_M)
    if kind in ("reach", "fetch", "write"):
        axis = int(random.integers(2))
        goal[axis] = random.choice([-1, 1]) * (ground.half[axis] - FROM_WALL_M + 0.1)
    return goal
