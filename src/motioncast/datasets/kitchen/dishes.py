"""What a cook does, in words: items are laid out, then worked on in that order; a chain whose memory is long.

A *round* takes one to four of the items that the kitchen has and that are not used up (``take`` at the home of each),
works on one after the other by its own list of actions, and may end with seasoning, stirring, serving. A label alone
does not tell what was taken: two items share a home, and six homes share the label. A place alone does not tell what is
done there: the same hands over the board peel, cut, open or spread. What comes next follows from both, and from what
was taken many steps before: one step ahead of a ``take`` everything is open to who saw the label only.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

LABELS = (
    "take", "put", "wash", "peel", "cut", "pour", "stir", "season", "open", "spread", "crack", "taste", "wipe", "serve",
    "hand over", "receive",
)  # fmt: skip

PLACES = (
    "basket", "fridge top", "fridge bottom", "drawer", "cupboard", "shelf", "board", "bowl", "stove", "sink", "plate",
    "side",
)  # fmt: skip
"""The homes of items, then where one works; ``side`` is where two cooks meet."""


@dataclass(frozen=True, slots=True)
class Step:
    """One action at one place."""

    label: str
    place: str


@dataclass(frozen=True, slots=True)
class Item:
    """Something to cook with: where it is kept, and what is done with it."""

    name: str
    home: str
    work: tuple[Step, ...]


def _item(name: str, home: str, *work: str) -> Item:
    steps = (step.split(" at ") for step in work)
    return Item(name, home, tuple(Step(label, place) for label, place in steps))


ITEMS = (
    _item("tomato", "basket", "cut at board", "put at bowl"),
    _item("onion", "basket", "peel at board", "cut at board", "put at stove"),
    _item("egg", "fridge top", "crack at bowl", "stir at bowl"),
    _item("milk", "fridge top", "open at board", "pour at bowl", "stir at bowl"),
    _item("cucumber", "fridge bottom", "wash at sink", "peel at board", "cut at board", "put at bowl"),
    _item("cheese", "fridge bottom", "open at board", "cut at board", "put at plate"),
    _item("carrot", "drawer", "wash at sink", "cut at board", "put at stove"),
    _item("potato", "drawer", "peel at board", "wash at sink", "cut at board", "put at stove"),
    _item("bread", "cupboard", "cut at board", "spread at board", "put at plate"),
    _item("pasta", "cupboard", "open at board", "pour at stove", "stir at stove"),
    _item("tea", "shelf", "open at board", "pour at plate", "stir at plate"),
    _item("herbs", "shelf", "wash at sink", "cut at board", "season at stove"),
)

OBJECTS = tuple(item.name for item in ITEMS)

THERE = 0.75
"""Share of the items that a kitchen has; an item that is not there is never taken."""

MOST_AT_ONCE = 4
"""Items laid out in a round, at most."""

IN_ORDER = 0.85
"""Share of rounds that work in the order of taking; the others start with what was taken last."""

AGAIN = 0.15
"""Probability that an action of the work is done once more: how long it takes cannot be known."""

ASIDE = {"taste": "stove", "wipe": "board"}
ASIDE_SHARE = 0.12
"""What a cook does now and then between two items."""

ENDINGS = (
    (Step("season", "bowl"), Step("stir", "bowl"), Step("serve", "plate")),
    (Step("season", "stove"), Step("stir", "stove"), Step("taste", "stove"), Step("serve", "plate")),
    (Step("serve", "plate"), Step("wipe", "board")),
)
"""Of a round: after work that ended at the bowl, at the stove, elsewhere."""

SHORTEST, LONGEST = 28, 42
"""Steps of a sequence."""


def draw_objects(random: np.random.Generator) -> np.ndarray:
    """Which items a kitchen has, ``(12,)`` bool; never fewer than six."""
    while True:
        there = random.random(len(ITEMS)) < THERE
        if there.sum() >= 6:
            return there


def draw_steps(objects: np.ndarray, random: np.random.Generator) -> list[Step]:
    """What one cook does, from the first to the last step.

    Args:
        objects: Which items there are, ``(12,)`` bool.
        random: Source of chance.
    """
    steps: list[Step] = []
    left: list[Item] = []
    length = int(random.integers(SHORTEST, LONGEST + 1))
    while len(steps) < length:
        if not left:  # the next dish begins with a full kitchen again
            left = shuffled([item for item, there in zip(ITEMS, objects, strict=True) if there], random)
        count = min(int(random.integers(1, MOST_AT_ONCE + 1)), len(left))
        chosen, left = left[:count], left[count:]
        steps += [Step("take", item.home) for item in chosen]
        for item in chosen if random.random() < IN_ORDER else chosen[::-1]:
            steps += work_on(item, random)
        if random.random() < 0.7:
            steps += ending(steps[-1].place)
    return steps[:length]


def shuffled(items: list[Item], random: np.random.Generator) -> list[Item]:
    """The items in a random order."""
    return [items[index] for index in random.permutation(len(items))]


def work_on(item: Item, random: np.random.Generator) -> list[Step]:
    """What is done with an item, with repetitions, and now and then something aside at the end."""
    steps: list[Step] = []
    for step in item.work:
        steps += [step] * (2 if random.random() < AGAIN else 1)
    if random.random() < ASIDE_SHARE:
        label = str(random.choice(list(ASIDE)))
        steps.append(Step(label, ASIDE[label]))
    return steps


def ending(place: str) -> tuple[Step, ...]:
    """How a round ends whose last work was at a place."""
    return ENDINGS[0 if place == "bowl" else 1 if place == "stove" else 2]


def draw_pair(objects: np.ndarray, random: np.random.Generator) -> tuple[list[Step], list[Step]]:
    """What two cooks do, step by step at the same time: one fetches and hands over, the other works.

    What the second one does after ``receive`` follows from where the first one fetched.

    Args:
        objects: Which items there are, ``(12,)`` bool.
        random: Source of chance.
    """
    fetching: list[Step] = []
    working: list[Step] = []
    left: list[Item] = []
    length = int(random.integers(SHORTEST, LONGEST + 1))
    while len(fetching) < length:
        if not left:
            left = shuffled([item for item, there in zip(ITEMS, objects, strict=True) if there], random)
        item = left.pop()
        work = work_on(item, random)
        pause = Step("wipe", "board") if random.random() < 0.5 else Step("stir", "stove")
        fetching += [Step("take", item.home), Step("hand over", "side"), *[pause] * len(work)]
        working += [Step("wipe", "board"), Step("receive", "side"), *work]
    return fetching[:length], working[:length]
