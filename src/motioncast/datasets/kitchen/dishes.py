"""What a cook does, in words: dishes of five items, each fetched from its home and worked on.

The chain has a long memory, and neither labels nor places alone tell what comes next:

- There are three ways to work, and each is that of four items: by labels they are alike. An item is told by where it
  was fetched and by where the work ends.
- A home holds two items: by the place they are alike. Peeling and opening look nearly the same, and one goes on at the
  board where the other does not.
- A dish is a list of items. Every dish has a twin whose first three items are worked on by the same labels, and which
  then goes on differently. So what comes many steps later follows from poses seen now.
- A cook fetches one, two or three items at once, always as many, and works on them in that order.

The rest is chance: which items there are (the missing ones are left out), which dish comes next, an action that is done
twice, something done aside.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

LABELS = (
    "take", "wash", "peel", "cut", "put", "open", "pour", "stir", "season", "taste", "wipe", "serve",
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


def _washed(name: str, home: str, end: str) -> Item:
    return Item(name, home, (Step("wash", "sink"), Step("cut", "board"), Step("put", end)))


def _peeled(name: str, home: str, end: str) -> Item:
    return Item(name, home, (Step("peel", "board"), Step("cut", "board"), Step("put", end)))


def _poured(name: str, home: str, end: str) -> Item:
    return Item(name, home, (Step("open", "board"), Step("pour", end), Step("stir", end)))


ITEMS = (
    _washed("tomato", "basket", "bowl"), _washed("mushroom", "basket", "stove"),
    _washed("lettuce", "fridge top", "plate"), _washed("herbs", "fridge top", "stove"),
    _peeled("carrot", "drawer", "stove"), _peeled("potato", "cupboard", "plate"),
    _peeled("cucumber", "fridge bottom", "bowl"), _peeled("onion", "shelf", "stove"),
    _poured("pasta", "drawer", "plate"), _poured("flour", "cupboard", "bowl"),
    _poured("milk", "fridge bottom", "stove"), _poured("tea", "shelf", "bowl"),
)  # fmt: skip

OBJECTS = tuple(item.name for item in ITEMS)

DISHES = (
    ("tomato", "carrot", "flour", "lettuce", "cucumber"), ("mushroom", "onion", "milk", "pasta", "herbs"),
    ("potato", "herbs", "tea", "onion", "pasta"), ("cucumber", "lettuce", "pasta", "tomato", "mushroom"),
    ("milk", "tomato", "onion", "tea", "herbs"), ("flour", "mushroom", "potato", "carrot", "cucumber"),
    ("pasta", "carrot", "lettuce", "potato", "milk"), ("tea", "cucumber", "mushroom", "herbs", "flour"),
)  # fmt: skip
"""Each with its twin: washed or peeled or poured in the same order for three items, then not."""

THERE = 0.85
"""Share of the items that a kitchen has; an item that is not there is never taken."""

FEWEST = 4
"""A dish of which fewer items are there is not cooked."""

AT_ONCE = (1, 2, 3)
"""Items that a cook fetches at once."""

AGAIN = 0.06
"""Probability that an action of the work is done once more: how long it takes cannot be known."""

ASIDE = {"taste": "stove", "wipe": "board"}
ASIDE_SHARE = 0.05
"""What a cook does now and then after an item."""

ENDING = ("season", "stir", "serve")
"""What ends a dish, where its last item ended; served at the plate."""

SHORTEST, LONGEST = 28, 42
"""Steps of a sequence."""


def draw_objects(random: np.random.Generator) -> np.ndarray:
    """Which items a kitchen has, ``(12,)`` bool; enough for a dish and its twin at least."""
    while True:
        there = random.random(len(ITEMS)) < THERE
        if len(feasible(there)) >= 2:
            return there


def feasible(objects: np.ndarray) -> list[list[Item]]:
    """The dishes that can be cooked, each as its items that are there."""
    there = {item.name: item for item, known in zip(ITEMS, objects, strict=True) if known}
    found = [[there[name] for name in dish if name in there] for dish in DISHES]
    return [items for items in found if len(items) >= FEWEST]


def draw_steps(objects: np.ndarray, random: np.random.Generator) -> list[Step]:
    """What one cook does; a sequence begins and ends anywhere in a dish.

    Args:
        objects: Which items there are, ``(12,)`` bool.
        random: Source of chance.
    """
    dishes, at_once = feasible(objects), int(random.choice(AT_ONCE))
    begin, length = int(random.integers(10)), int(random.integers(SHORTEST, LONGEST + 1))
    steps: list[Step] = []
    while len(steps) < begin + length:
        items = dishes[random.integers(len(dishes))]
        for first in range(0, len(items), at_once):
            chosen = items[first : first + at_once]
            steps += [Step("take", item.home) for item in chosen]
            for item in chosen:
                steps += work_on(item, random)
        steps += [Step(label, "plate" if label == "serve" else items[-1].work[-1].place) for label in ENDING]
    return steps[begin : begin + length]


def work_on(item: Item, random: np.random.Generator) -> list[Step]:
    """What is done with an item, with repetitions, and now and then something aside at the end."""
    steps: list[Step] = []
    for step in item.work:
        steps += [step] * (2 if random.random() < AGAIN else 1)
    if random.random() < ASIDE_SHARE:
        label = str(random.choice(list(ASIDE)))
        steps.append(Step(label, ASIDE[label]))
    return steps


def draw_pair(objects: np.ndarray, random: np.random.Generator) -> tuple[list[Step], list[Step]]:
    """What two cooks do, step by step at the same time: one fetches and hands over, the other works.

    What the second one does after ``receive`` follows from where the first one fetched.

    Args:
        objects: Which items there are, ``(12,)`` bool.
        random: Source of chance.
    """
    dishes = feasible(objects)
    begin, length = int(random.integers(10)), int(random.integers(SHORTEST, LONGEST + 1))
    fetching: list[Step] = []
    working: list[Step] = []
    while len(fetching) < begin + length:
        for item in dishes[random.integers(len(dishes))]:
            work = work_on(item, random)
            fetching += [Step("take", item.home), Step("hand over", "side"), *[Step("wipe", "board")] * len(work)]
            working += [Step("wipe", "board"), Step("receive", "side"), *work]
    return fetching[begin : begin + length], working[begin : begin + length]
