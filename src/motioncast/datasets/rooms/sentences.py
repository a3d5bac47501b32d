"""The sentences of the grammar: what somebody who has stopped does, and the thing that it takes.

The thing follows from the act: a seat under the pelvis, a counter or a table where the hand works, a whiteboard in the
plane of writing.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from motioncast.core.scene_object import SceneObject
from motioncast.datasets.rooms import grammar, steps
from motioncast.datasets.rooms.actors import Actor, standing
from motioncast.datasets.rooms.bodies import PELVIS, facing, turned
from motioncast.datasets.rooms.contacts import FPS
from motioncast.datasets.rooms.figure import ANKLES, TIPS, toe_out
from motioncast.datasets.rooms.ground import Ground
from motioncast.datasets.rooms.kinds import HUNG_M, KINDS, thing
from motioncast.datasets.rooms.puppet import Puppet
from motioncast.datasets.rooms.stitch import placed

LEAST = round(2 * FPS)
"""Frames of the shortest real stretch that is played."""

STAND_OFF_M = 0.3
"""From the ankles of somebody who works at a thing to its front."""


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


def _stand(puppet: Puppet, _: Actor, __: Ground, random: np.random.Generator) -> Act:
    begin = puppet.time
    grammar.stand(puppet, random.uniform(1, 6))
    if random.random() < 0.6:
        steps.turn(puppet, random.uniform(-1, 1) * 2.2)
    grammar.stand(puppet, random.uniform(1, 5))
    return Act(puppet, (("stand", begin, puppet.time, "", puppet.pelvis.last, float(puppet.look.last)),))


def _sit(puppet: Puppet, _: Actor, ground: Ground, random: np.random.Generator) -> Act:
    steps.turn(puppet, random.choice([-1, 1]) * random.uniform(1.4, np.pi))
    steps.step_back(puppet, random.uniform(0.18, 0.25))
    kind_name = "stool" if random.random() < 0.25 else "chair"
    kind = KINDS[kind_name]
    size = kind.size(random)
    look = float(puppet.look.last)
    place = grammar.seat_place(puppet)
    middle = place - (size[0] / 2 - 0.25 if kind.shape == "box" else -0.02) * steps.forwards(look)
    name = ground.name(kind_name)
    seat = thing(kind, name, size, float(middle[0]), float(middle[1]), 0.0, look + np.pi, "caused")
    rest, leave = grammar.sit(puppet, float(size[2]), random.uniform(4, 18), random)
    return Act(puppet, (("sit", rest, leave, name, np.array([*place, size[2]]), look),), (seat,))


AT_COUNTER = ("counter", "sink", "dishwasher", "drawer", "table", "cupboard", "coffee machine", "microwave", "kettle")


def _reach(puppet: Puppet, _: Actor, ground: Ground, random: np.random.Generator) -> Act:
    wall = _to_wall(puppet, ground)
    kind_name = str(random.choice(AT_COUNTER))
    if abs(wall[1]) < 1.9 and wall[0] < 1.5:
        steps.turn(puppet, wall[1]) if abs(wall[1]) > 0.1 else None
    else:
        kind_name = "table"
    return _at_front(puppet, kind_name, ground, random)


def _at_front(puppet: Puppet, kind_name: str, ground: Ground, random: np.random.Generator) -> Act:
    """Reach to a thing that is set up before somebody who stands, then turn away from it."""
    look = float(puppet.look.last)
    ahead, aside = steps.forwards(look), np.array([-np.sin(look), np.cos(look)])
    base_name = kind_name if KINDS[kind_name].place != "top" else "counter"
    base, size = KINDS[base_name], KINDS[base_name].size(random)
    front = steps.centre_of(puppet) + STAND_OFF_M * ahead
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
        ("reach", begin, end, name, target, look + np.pi) for (begin, end), target in zip(held, targets, strict=True)
    )
    steps.turn(puppet, random.choice([-1, 1]) * random.uniform(1.7, np.pi))
    return Act(puppet, events, tuple(things))


def _write(puppet: Puppet, _: Actor, ground: Ground, random: np.random.Generator) -> Act:
    wall = _to_wall(puppet, ground)
    if abs(wall[1]) < 1.9 and abs(wall[1]) > 0.1:
        steps.turn(puppet, wall[1])
    look = float(puppet.look.last)
    ahead = steps.forwards(look)
    size = KINDS["whiteboard"].size(random)
    front = steps.centre_of(puppet) + 0.42 * ahead
    middle = front + size[0] / 2 * ahead
    name = ground.name("whiteboard")
    board = thing(KINDS["whiteboard"], name, size, float(middle[0]), float(middle[1]), HUNG_M, look, "caused")
    side = int(random.random() < 0.8)
    touch = np.array([*(front - 0.06 * ahead), random.uniform(1.25, 1.5)])
    begin, end = grammar.write(puppet, touch, side, random.uniform(4, 12), random)
    steps.turn(puppet, random.choice([-1, 1]) * random.uniform(1.7, np.pi))
    return Act(puppet, (("write", begin, end, name, touch, look + np.pi),), (board,))


def _play(puppet: Puppet, actor: Actor, _: Ground, random: np.random.Generator) -> Act:
    """A real stretch on the spot between two synthetic ones that lead into it and out of it."""
    name, scene = actor.scenes[int(random.integers(len(actor.scenes)))]
    rests = np.flatnonzero(standing(scene, actor.figure.height))
    # a stretch begins and ends standing, seen from its whole take
    rests = np.union1d(rests, [0, len(scene) - 1])
    first = int(random.choice(rests[rests < len(scene) - LEAST]))
    later = rests[rests >= first + LEAST]
    last = int(later[max(np.searchsorted(later, first + random.uniform(3, 14) * FPS) - 1, 0)])
    frames = scene[first : last + 1].astype(np.float64)
    angle = float(puppet.look.last) - float(facing(frames[0]))
    middle = frames[0, list(ANKLES), :2].mean(0)
    frames = placed(frames, angle, steps.centre_of(puppet) - turned(middle, angle))
    for side in range(2):
        ankle, tip = frames[0, ANKLES[side]], frames[0, TIPS[side]]
        time = puppet.time
        puppet.step(side, ankle[:2], float(toe_out(ankle, tip)), time, time + steps.FOOTFALL_S)
        puppet.time = time + steps.FOOTFALL_S
    end = float(np.ceil((puppet.time + 0.3) * FPS) / FPS)
    puppet.key_pose(end, frames[:2], 0)
    into = puppet.motion(random, 0.0)
    onwards = Puppet(actor.figure, frames[-2:])
    steps.gather(onwards)
    begin = len(into) / FPS
    event = ("play", begin, begin + len(frames) / FPS, "", frames[0, PELVIS], float(puppet.look.last))
    return Act(onwards, (event,), (), ((into, False), (frames[1:], True)), name)


def _to_wall(puppet: Puppet, ground: Ground) -> tuple[float, float]:
    """How far the nearest wall is, and by what angle somebody who stands must turn to face it."""
    place = steps.centre_of(puppet)
    gaps = np.concatenate([ground.half - place, ground.half + place])
    side = int(gaps.argmin())
    angle = (0.0, np.pi / 2, np.pi, -np.pi / 2)[side]
    away = (angle - float(puppet.look.last) + np.pi) % (2 * np.pi) - np.pi
    return float(gaps[side]), float(away)


ACTS = {"stand": _stand, "sit": _sit, "reach": _reach, "write": _write, "play": _play}
"""The sentences of the grammar by the act in their middle."""
