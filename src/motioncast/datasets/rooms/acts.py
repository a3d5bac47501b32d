"""What somebody stops to do on the way, and the thing that it takes.

The thing follows from the act: a seat under the pelvis, a counter or a table where the hand works, a whiteboard in the
plane of writing. Nothing is done where the thing would stand in somebody's way.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from motioncast.core.scene_object import SceneObject
from motioncast.core.shapes import signed_distance
from motioncast.datasets.rooms import grammar
from motioncast.datasets.rooms.bodies import PELVIS, facing
from motioncast.datasets.rooms.contacts import FPS
from motioncast.datasets.rooms.events import Event
from motioncast.datasets.rooms.gait import Gait
from motioncast.datasets.rooms.ground import Ground
from motioncast.datasets.rooms.kinds import HUNG_M, KINDS, thing
from motioncast.datasets.rooms.puppet import HANDS, HIPS, Figure, Puppet, figure_of
from motioncast.datasets.rooms.stitch import BLEND, MIDDLE, placed
from motioncast.datasets.rooms.tracks import Track

LOOK_BACK = round(1.8 * FPS)
"""A walk is cut back by at most so many frames to one in which a foot has landed."""

DEEPEST_M = 0.03
"""No joint is deeper than this in a thing that it does not use."""

STAND_OFF_M = 0.3
"""From the ankles of somebody who works at a thing to its front."""


@dataclass(frozen=True, slots=True, eq=False)
class Actor:
    """A person who can walk, stop, act and walk on.

    Attributes:
        gait: The walk.
        figure: The build.
        landings: For each frame of the gait which foot has just landed, 0 left, 1 right, -1 none.
        starts: Frames of the gait in which a walk can begin.
    """

    gait: Gait
    figure: Figure
    landings: np.ndarray
    starts: np.ndarray


def actor_of(gait: Gait) -> Actor | None:
    """The actor with a gait, or None where no walk could begin."""
    landings = grammar.landed(gait.positions, gait.looks)
    index = np.arange(len(gait))
    fits = (landings >= 0) & (index - gait.firsts >= 2) & (gait.ends - index > BLEND + 2)
    ahead = np.minimum(index + 1 + MIDDLE, len(gait) - 1)
    starts = np.flatnonzero(fits & (gait.onward[ahead, 0] >= 0))
    return Actor(gait, figure_of(gait), landings, starts) if len(starts) else None


@dataclass(frozen=True, slots=True, eq=False)
class Act:
    """Something done on the spot: events on the clock of the puppet in seconds, and things.

    Attributes:
        events: Kind, start and end in seconds, thing, point, outward angle.
        things: In the order in which they are set up.
    """

    events: tuple[tuple[str, float, float, str, np.ndarray, float], ...]
    things: tuple[SceneObject, ...]


def perform(track: Track, actor: Actor, kind: str, ground: Ground, random: np.random.Generator) -> Track | None:
    """The track with a stop, an act and a start, or None where it cannot be done here.

    Args:
        track: Somebody walking.
        actor: Who that is.
        kind: ``stand``, ``sit``, ``reach`` or ``write``.
        ground: The room so far.
        random: Source of everything that is drawn.
    """
    whole = np.concatenate([*track.parts, track.tail])
    recent = whole[-LOOK_BACK:]
    found = np.flatnonzero(grammar.landed(recent, facing(recent))[2:-1] >= 0)
    if not len(found):
        return None
    now = len(whole) - len(recent) + int(found[-1]) + 3  # frames that are kept
    puppet = Puppet(actor.figure, whole[now - 2 : now])
    grammar.stop(puppet)
    act = ACTS[kind](puppet, ground, random)
    index = int(random.choice(actor.starts))
    angle, shift = grammar.start(puppet, actor.gait, index, int(actor.landings[index]))
    motion = puppet.motion(random)
    tail = placed(actor.gait.positions[index + 1 : index + 1 + BLEND].astype(np.float64), angle, shift)
    path = np.concatenate([motion, tail])[None, :, PELVIS, :2]
    if not ground.free(path, track.start + now)[0]:
        return None
    body = np.concatenate([whole[:now], motion, tail])
    if not all(_fits(item, body, ground, TOUCHING[kind]) for item in act.things):
        return None
    middle = index + 1 + MIDDLE
    events = tuple(
        Event(name, -1, now + round(begin * FPS), now + round(end * FPS), thing_name, tuple(point.tolist()), out, True)
        for name, begin, end, thing_name, point, out in act.events
    )
    return replace(
        track,
        parts=(whole[:now], motion),
        tail=tail,
        source=middle,
        look=float(actor.gait.looks[middle] + angle),
        stand=placed(actor.gait.pivots[middle], angle, shift),
        rate=0.0,
        made=(*track.made, (now, now + len(motion))),
        events=(*track.events, *events),
        things=(*track.things, *act.things),
    )


def _fits(item: SceneObject, body: np.ndarray, ground: Ground, touching: tuple[int, ...]) -> bool:
    """Whether a thing is in nobody's way, the walls' included, and not in the body that uses it."""
    corners = item.corners[:, :2]
    if (np.abs(corners) > ground.half + 0.02).any():
        return False
    circles = around(item)
    for x, y, radius in circles:
        for other in ground.people:
            square = np.square(other - [x, y]).sum(-1)
            if (square < (radius + 0.4) ** 2).any():
                return False
        for there_x, there_y, there in ground.things:
            if np.hypot(x - there_x, y - there_y) < radius + there:
                return False
    others = [joint for joint in range(body.shape[1]) if joint not in touching]
    return bool((signed_distance(item, body[::2, others]) > -DEEPEST_M).all())


HAND = tuple(joint for hand in HANDS for joint in hand[1:])
TOUCHING = {"stand": (), "sit": (PELVIS, *HIPS), "reach": HAND, "write": HAND}
"""Joints that may touch what is used: pelvis and hips a seat, hands from the wrist on a counter or a board."""


def around(item: SceneObject) -> list[tuple[float, float, float]]:
    """Circles that cover the floor under a thing: x, y, radius."""
    depth, width = float(item.size[0]), float(item.size[1])
    if item.shape == "cylinder":
        return [(float(item.position[0]), float(item.position[1]), depth / 2)]
    short, long = min(depth, width), max(depth, width)
    count = max(1, round(long / max(short, 0.3)))
    axis = np.array([1.0, 0, 0]) if depth > width else np.array([0, 1.0, 0])
    places = (np.arange(count) + 0.5) / count - 0.5
    middles = item.outward(places[:, None] * long * axis * np.ones((1, 3)))
    radius = 0.5 * float(np.hypot(short, long / count))
    return [(float(x), float(y), radius) for x, y, _ in middles]


def _stand(puppet: Puppet, ground: Ground, random: np.random.Generator) -> Act:
    begin = puppet.time
    grammar.stand(puppet, random.uniform(1, 5))
    if random.random() < 0.6:
        grammar.turn(puppet, random.uniform(-1, 1) * 2.2)
    grammar.stand(puppet, random.uniform(1, 4))
    return Act((("stand", begin, puppet.time, "", puppet.pelvis.last, float(puppet.look.last)),), ())


def _sit(puppet: Puppet, ground: Ground, random: np.random.Generator) -> Act:
    grammar.turn(puppet, random.choice([-1, 1]) * random.uniform(1.4, np.pi))
    grammar.step_back(puppet, random.uniform(0.18, 0.25))
    kind_name = "stool" if random.random() < 0.25 else "chair"
    kind = KINDS[kind_name]
    size = kind.size(random)
    look = float(puppet.look.last)
    place = grammar.seat_place(puppet)
    middle = place - (size[0] / 2 - 0.25 if kind.shape == "box" else -0.02) * grammar.forwards(look)
    name = ground.name(kind_name)
    seat = thing(kind, name, size, float(middle[0]), float(middle[1]), 0.0, look + np.pi, "caused")
    rest, leave = grammar.sit(puppet, float(size[2]), random.uniform(3, 14), random)
    return Act((("sit", rest, leave, name, np.array([*place, size[2]]), look),), (seat,))


AT_COUNTER = ("counter", "sink", "dishwasher", "drawer", "table", "cupboard", "coffee machine", "microwave", "kettle")


def _reach(puppet: Puppet, ground: Ground, random: np.random.Generator) -> Act:
    wall = _to_wall(puppet, ground)
    kind_name = str(random.choice(AT_COUNTER))
    if abs(wall[1]) < 1.9 and wall[0] < 1.5:
        grammar.turn(puppet, wall[1]) if abs(wall[1]) > 0.1 else None
    else:
        kind_name = "table"
    return _at_front(puppet, kind_name, ground, random)


def _at_front(puppet: Puppet, kind_name: str, ground: Ground, random: np.random.Generator) -> Act:
    """Reach to a thing that is set up before somebody who stands, then turn away from it."""
    look = float(puppet.look.last)
    ahead, aside = grammar.forwards(look), np.array([-np.sin(look), np.cos(look)])
    base_name = kind_name if KINDS[kind_name].place != "top" else "counter"
    base, size = KINDS[base_name], KINDS[base_name].size(random)
    front = grammar.centre_of(puppet) + STAND_OFF_M * ahead
    middle = front + size[0] / 2 * ahead + random.uniform(-0.25, 0.25) * max(size[1] - 0.5, 0) * aside
    name = ground.name(base_name)
    things = [thing(base, name, size, float(middle[0]), float(middle[1]), 0.0, look, "caused")]
    side, inside = int(random.integers(2)), 0.1
    height = float(size[2]) + 0.09
    if base_name in ("cupboard", "drawer", "dishwasher"):  # the front, by its handle
        inside, height = -0.03, min(0.72 * float(size[2]), 1.35) if base_name == "cupboard" else 0.9 * float(size[2])
    if base_name != kind_name:
        kind = KINDS[kind_name]
        top = kind.size(random)
        there = front + (0.18 + top[0] / 2) * ahead + (1 - 2 * side) * 0.12 * aside
        name = ground.name(kind_name)
        things.append(thing(kind, name, top, float(there[0]), float(there[1]), float(size[2]), look, "caused"))
        inside, height = 0.12, float(size[2]) + 0.6 * float(top[2])
    count = int(random.integers(1, 4))
    offsets = (1 - 2 * side) * random.uniform(0.06, 0.22, count)
    targets = np.stack([[*(front + inside * ahead + offset * aside), height] for offset in offsets])
    held = grammar.reach(puppet, targets, side, random)
    events = tuple(
        ("reach", begin, end, name, target, look + np.pi)
        for (begin, end), target in zip(held, targets, strict=True)
    )
    grammar.turn(puppet, random.choice([-1, 1]) * random.uniform(1.7, np.pi))
    return Act(events, tuple(things))


def _write(puppet: Puppet, ground: Ground, random: np.random.Generator) -> Act:
    wall = _to_wall(puppet, ground)
    if abs(wall[1]) < 1.9 and abs(wall[1]) > 0.1:
        grammar.turn(puppet, wall[1])
    look = float(puppet.look.last)
    ahead = grammar.forwards(look)
    size = KINDS["whiteboard"].size(random)
    front = grammar.centre_of(puppet) + 0.42 * ahead
    middle = front + size[0] / 2 * ahead
    name = ground.name("whiteboard")
    board = thing(KINDS["whiteboard"], name, size, float(middle[0]), float(middle[1]), HUNG_M, look, "caused")
    side = int(random.random() < 0.8)
    touch = np.array([*(front - 0.06 * ahead), random.uniform(1.25, 1.5)])
    begin, end = grammar.write(puppet, touch, side, random.uniform(3, 8), random)
    grammar.turn(puppet, random.choice([-1, 1]) * random.uniform(1.7, np.pi))
    return Act((("write", begin, end, name, touch, look + np.pi),), (board,))


def _to_wall(puppet: Puppet, ground: Ground) -> tuple[float, float]:
    """How far the nearest wall is, and by what angle somebody who stands must turn to face it."""
    place = grammar.centre_of(puppet)
    gaps = np.concatenate([ground.half - place, ground.half + place])
    side = int(gaps.argmin())
    angle = (0.0, np.pi / 2, np.pi, -np.pi / 2)[side]
    away = (angle - float(puppet.look.last) + np.pi) % (2 * np.pi) - np.pi
    return float(gaps[side]), float(away)


ACTS = {"stand": _stand, "sit": _sit, "reach": _reach, "write": _write}
"""The sentences of the grammar by the act in their middle."""
