"""Which takes make the rooms of which split.

As ``datasets/cmu.py`` by default: by actor, the dancing couple by take. Rooms move some takes, because a room needs
people who walk, and its test people who really sit:

- subject 86 (a high stool in 86_09) goes to test as a whole,
- subjects 12, 39 and 47 (walks) go to validation, which has no plain walk otherwise.

Subject 1's climbing and sitting on playground bars is not used, only the walks between: bars are no furniture.
Whole takes move, so no take lies in two splits. A model trained on ``cmu.takes(data, "train")`` has seen some of
these: a model that is to be judged on rooms is trained on rooms.
"""

from __future__ import annotations

from motioncast.datasets import cmu

MOVED_SUBJECTS = {86: "test", 12: "validation", 39: "validation", 47: "validation"}

LEFT_OUT = frozenset({3})
"""Uneven ground: no flat floor and no step explains where these feet stand."""


def split_of(subject: int, number: int) -> str:
    """The split of a take in rooms.

    Example:
        >>> split_of(8, 1), split_of(86, 9), split_of(1, 6), split_of(39, 3)
        ('train', 'test', 'train', 'validation')
    """
    return MOVED_SUBJECTS.get(subject) or cmu.split_of(subject, number)
