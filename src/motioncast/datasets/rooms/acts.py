"""Doing something on the way: a stop, an act and a start, spliced into a walk where there is place for it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from motioncast.datasets.rooms.actors import Actor
from motioncast.datasets.rooms.bodies import PELVIS, facing
from motioncast.datasets.rooms.contacts import FPS
from motioncast.datasets.rooms.events import Event
from motioncast.datasets.rooms.fitting import TOUCHING, fits
from motioncast.datasets.rooms.ground import Ground
from motioncast.datasets.rooms.puppet import Puppet
from motioncast.datasets.rooms.sentences import ACTS
from motioncast.datasets.rooms.steps import landed, start, stop
from motioncast.datasets.rooms.stitch import BLEND, MIDDLE, placed
from motioncast.datasets.rooms.tracks import Track

LOOK_BACK = round(1.8 * FPS)
"""A walk is cut back by at most so many frames to one in which a foot has landed."""


def perform(track: Track, actor: Actor, kind: str, ground: Ground, random: np.random.Generator) -> Track | None:
    """The track with a stop, an act and a start, or None where it cannot be done here.

    Args:
        track: Somebody walking.
        actor: Who that is.
        kind: ``stand``, ``sit``, ``reach``, ``write`` or ``play`` (a real stretch on the spot).
        ground: The room so far.
        random: Source of everything that is drawn.
    """
    whole = np.concatenate([*track.parts, track.tail])
    recent = whole[-LOOK_BACK:]
    found = np.flatnonzero(landed(recent, facing(recent))[2:-1] >= 0)
    if not len(found) or (kind == "play" and not actor.scenes):
        return None
    now = len(whole) - len(recent) + int(found[-1]) + 3  # frames that are kept
    puppet = Puppet(actor.figure, whole[now - 2 : now])
    stop(puppet)
    act = ACTS[kind](puppet, actor, ground, random)
    index = int(random.choice(actor.starts))
    angle, shift = start(act.puppet, actor.gait, index, int(actor.landings[index]))
    pieces = [*act.before, (act.puppet.motion(random), False)]
    tail = placed(actor.gait.positions[index + 1 : index + 1 + BLEND].astype(np.float64), angle, shift)
    motion = np.concatenate([*(positions for positions, _ in pieces), tail])
    if not ground.free(motion[None, :, PELVIS, :2], track.start + now)[0]:
        return None
    body = np.concatenate([whole[:now], motion])
    if not all(fits(item, body, ground, TOUCHING[kind]) for item in act.things):
        return None
    middle, made, at = index + 1 + MIDDLE, [], now
    for positions, real in pieces:
        made += [] if real else [(at, at + len(positions))]
        at += len(positions)
    real = any(real for _, real in pieces)
    events = tuple(
        Event(name, -1, now + round(begin * FPS), now + round(end * FPS), thing_name, _point(point), out, not real)
        for name, begin, end, thing_name, point, out in act.events
    )
    return replace(
        track,
        parts=(whole[:now], *(positions for positions, _ in pieces)),
        tail=tail,
        source=middle,
        look=float(actor.gait.looks[middle] + angle),
        stand=placed(actor.gait.pivots[middle], angle, shift),
        rate=0.0,
        takes=(*track.takes, *([act.take] if act.take else [])),
        made=(*track.made, *made),
        events=(*track.events, *events),
        things=(*track.things, *act.things),
    )


def _point(point: np.ndarray) -> tuple[float, float, float]:
    x, y, z = (float(value) for value in point)
    return x, y, z
