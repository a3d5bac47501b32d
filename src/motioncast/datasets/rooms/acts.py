"""What somebody stops to do on the way, and the thing that it takes.

The thing follows from the act: a seat under the pelvis, a counter or a table where the hand works, a whiteboard in the
plane of writing. Nothing is done where the thing would stand in somebody's way.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from motioncast.core.scene_object import SceneObject
from motioncast.core.shapes import signed_distance
from motioncast.datasets.rooms import grammar
from motioncast.datasets.rooms.bodies import PELVIS, facing, turned
from motioncast.datasets.rooms.clips import Clip
from motioncast.datasets.rooms.contacts import FEET, FPS, foot_contact, smoothed, speed
from motioncast.datasets.rooms.events import Event
from motioncast.datasets.rooms.gait import Gait, gait_of
from motioncast.datasets.rooms.ground import Ground
from motioncast.datasets.rooms.kinds import HUNG_M, KINDS, thing
from motioncast.datasets.rooms.puppet import ANKLES, HANDS, HIPS, TIPS, Figure, Puppet, figure_of, toe_out
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
        scenes: Real stretches on the spot that begin and end standing, and their takes.
    """

    gait: Gait
    figure: Figure
    landings: np.ndarray
    starts: np.ndarray
    scenes: tuple[tuple[str, np.ndarray], ...]


def actor_of(clips: Sequence[Clip]) -> Actor | None:
    """The actor of one subject's clips, or None where there is no walk, or no frame in which it could begin."""
    gait = gait_of(clips)
    if gait is None:
        return None
    landings = grammar.landed(gait.positions, gait.looks)
    index = np.arange(len(gait))
    fits = (landings >= 0) & (index - gait.firsts >= 2) & (gait.ends - index > BLEND + 2)
    ahead = np.minimum(index + 1 + MIDDLE, len(gait) - 1)
    starts = np.flatnonzero(fits & (gait.onward[ahead, 0] >= 0))
    if not len(starts):
        return None
    figure = figure_of(gait)
    scenes = tuple((clip.name, scene) for clip in clips for scene in on_the_spot(clip.positions[:, 0], figure.height))
    return Actor(gait, figure, landings, starts, scenes)


@dataclass(frozen=True, slots=True, eq=False)
class Act:
    """Something done on the spot.

    Attributes:
        puppet: Who stands at the end of it.
        events: Kind, start and end in seconds after the cut, thing, point, outward angle.
        things: In the order in which they are set up.
        before: Motion that is over before the puppet's own: positions and whether they are real.
        take: What the real part is from.
    """

    puppet: Puppet
    events: tuple[tuple[str, float, float, str, np.ndarray, float], ...] = ()
    things: tuple[SceneObject, ...] = ()
    before: tuple[tuple[np.ndarray, bool], ...] = ()
    take: str = ""


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
    found = np.flatnonzero(grammar.landed(recent, facing(recent))[2:-1] >= 0)
    if not len(found) or (kind == "play" and not actor.scenes):
        return None
    now = len(whole) - len(recent) + int(found[-1]) + 3  # frames that are kept
    puppet = Puppet(actor.figure, whole[now - 2 : now])
    grammar.stop(puppet)
    act = ACTS[kind](puppet, actor, ground, random)
    index = int(random.choice(actor.starts))
    angle, shift = grammar.start(act.puppet, actor.gait, index, int(actor.landings[index]))
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


def fits(item: SceneObject, body: np.ndarray, ground: Ground, touching: tuple[int, ...]) -> bool:
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
TOUCHING = {"stand": (), "play": (), "sit": (PELVIS, *HIPS), "reach": HAND, "write": HAND}
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


def yaw(item: SceneObject) -> float:
    """How far a thing that stands upright is turned about the vertical, radians."""
    return float(2 * np.arctan2(item.rotation[3], item.rotation[0]))


def _stand(puppet: Puppet, _: Actor, __: Ground, random: np.random.Generator) -> Act:
    begin = puppet.time
    grammar.stand(puppet, random.uniform(1, 6))
    if random.random() < 0.6:
        grammar.turn(puppet, random.uniform(-1, 1) * 2.2)
    grammar.stand(puppet, random.uniform(1, 5))
    return Act(puppet, (("stand", begin, puppet.time, "", puppet.pelvis.last, float(puppet.look.last)),))


def _sit(puppet: Puppet, _: Actor, ground: Ground, random: np.random.Generator) -> Act:
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
    rest, leave = grammar.sit(puppet, float(size[2]), random.uniform(4, 18), random)
    return Act(puppet, (("sit", rest, leave, name, np.array([*place, size[2]]), look),), (seat,))


AT_COUNTER = ("counter", "sink", "dishwasher", "drawer", "table", "cupboard", "coffee machine", "microwave", "kettle")


def _reach(puppet: Puppet, _: Actor, ground: Ground, random: np.random.Generator) -> Act:
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
    return Act(puppet, events, tuple(things))


def _write(puppet: Puppet, _: Actor, ground: Ground, random: np.random.Generator) -> Act:
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
    begin, end = grammar.write(puppet, touch, side, random.uniform(4, 12), random)
    grammar.turn(puppet, random.choice([-1, 1]) * random.uniform(1.7, np.pi))
    return Act(puppet, (("write", begin, end, name, touch, look + np.pi),), (board,))


def _play(puppet: Puppet, actor: Actor, _: Ground, random: np.random.Generator) -> Act:
    """A real stretch on the spot between two synthetic ones that lead into it and out of it."""
    name, scene = actor.scenes[int(random.integers(len(actor.scenes)))]
    length = min(len(scene), int(random.integers(round(3 * FPS), round(14 * FPS))))
    stands = _standing(scene, actor.figure.height)
    first = int(random.choice(np.flatnonzero(stands[: len(scene) - length + 1])))
    last = first + length - 1
    last = int(np.flatnonzero(stands[: last + 1])[-1])
    frames = scene[first : last + 1].astype(np.float64)
    angle = float(puppet.look.last) - float(facing(frames[0]))
    middle = frames[0, list(ANKLES), :2].mean(0)
    frames = placed(frames, angle, grammar.centre_of(puppet) - turned(middle, angle))
    for side in range(2):
        ankle, tip = frames[0, ANKLES[side]], frames[0, TIPS[side]]
        time = puppet.time
        puppet.step(side, ankle[:2], float(toe_out(ankle, tip)), time, time + grammar.FOOTFALL_S)
        puppet.time = time + grammar.FOOTFALL_S
    end = float(np.ceil((puppet.time + 0.3) * FPS) / FPS)
    puppet.key_pose(end, frames[:2], 0)
    into = puppet.motion(random, 0.0)
    onwards = Puppet(actor.figure, frames[-2:])
    grammar.gather(onwards)
    begin = len(into) / FPS
    event = ("play", begin, begin + len(frames) / FPS, "", frames[0, PELVIS], float(puppet.look.last))
    return Act(onwards, (event,), (), ((into, False), (frames[1:], True)), name)


def _standing(positions: np.ndarray, height: float) -> np.ndarray:
    """In which frames somebody ``(time, 31, 3)`` stands upright on both feet, ``(time,)`` bool."""
    upright = np.abs(positions[:, PELVIS, 2] / height - 1) < 0.1
    return foot_contact(positions).all(-1) & upright & (speed(positions[:, [PELVIS]])[:, 0] < 0.3)


def on_the_spot(positions: np.ndarray, height: float) -> list[np.ndarray]:
    """Stretches of a take that begin and end standing and stay within a circle of 0.8 m on the floor."""
    found, first = [], 0
    stands = _standing(positions, height)
    low = smoothed(positions[:, FEET, 2].min(-1), 4) < 0.1
    while first < len(positions) - 3 * FPS:
        if not stands[first]:
            first += 1
            continue
        away = np.linalg.norm(positions[first:, PELVIS, :2] - positions[first, PELVIS, :2], axis=-1)
        leaves = np.flatnonzero((away > 0.8) | ~low[first:])
        end = first + (int(leaves[0]) if len(leaves) else len(away))
        rests = np.flatnonzero(stands[first:end])
        last = first + int(rests[-1]) + 1
        if last - first >= 3 * FPS:
            found.append(positions[first:last])
        first = max(end, first + 1)
    return found


def _to_wall(puppet: Puppet, ground: Ground) -> tuple[float, float]:
    """How far the nearest wall is, and by what angle somebody who stands must turn to face it."""
    place = grammar.centre_of(puppet)
    gaps = np.concatenate([ground.half - place, ground.half + place])
    side = int(gaps.argmin())
    angle = (0.0, np.pi / 2, np.pi, -np.pi / 2)[side]
    away = (angle - float(puppet.look.last) + np.pi) % (2 * np.pi) - np.pi
    return float(gaps[side]), float(away)


ACTS = {"stand": _stand, "sit": _sit, "reach": _reach, "write": _write, "play": _play}
"""The sentences of the grammar by the act in their middle."""
