"""What people call furniture, and the category that it is."""

from __future__ import annotations

import re
from difflib import get_close_matches

from motioncast.core.scene_object import CATEGORIES

ALIASES = {
    "chair": "sittable", "armchair": "sittable", "stool": "sittable", "seat": "sittable", "sofa": "sittable",
    "couch": "sittable", "bench": "sittable", "desk": "table", "worktop": "table", "cabinet": "cupboard",
    "shelf": "cupboard", "bookcase": "cupboard", "wardrobe": "cupboard", "closet": "cupboard", "fridge": "cupboard",
    "refrigerator": "cupboard", "counter": "cupboard", "dresser": "drawer", "basin": "sink", "washbasin": "sink",
    "coffee": "coffee_machine", "coffeemaker": "coffee_machine", "espresso": "coffee_machine", "bin": "trash",
    "wastebasket": "trash", "blackboard": "whiteboard", "board": "whiteboard", "wall": "occluder",
    "pillar": "occluder", "column": "occluder", "screen": "occluder", "partition": "occluder", "fence": "out_of_bound",
    "barrier": "out_of_bound", "bound": "out_of_bound",
}  # fmt: skip
"""Everyday words -> category."""

_WORDS = {**{category: category for category in CATEGORIES}, **ALIASES}


def category_of(name: str) -> str | None:
    """The category that a name carries, as 3D programs write names; None if it carries none.

    Example:
        >>> [category_of(name) for name in ("table.001", "Chair_2", "coffee machine", "office chair", "lamp")]
        ['table', 'sittable', 'coffee_machine', 'sittable', None]
    """
    parts = re.findall(r"[a-z]+", re.sub(r"(?<=[a-z])(?=[A-Z])", " ", name).lower())
    for length in range(len(parts), 0, -1):  # "coffee machine" before "machine"; of equals the last one: "desk chair"
        for start in range(len(parts) - length, -1, -1):
            word = "_".join(parts[start : start + length])
            for form in (word, word.removesuffix("s"), word.replace("_", "")):
                if form in _WORDS:
                    return _WORDS[form]
    return None


def closest_category(word: str) -> str:
    """The category that somebody most likely meant, to be named in an error; empty if none comes near.

    Example:
        >>> closest_category("chair"), closest_category("tabel"), closest_category("zzz")
        ('sittable', 'table', '')
    """
    named = category_of(word)
    near = get_close_matches(word.strip().lower().replace(" ", "_"), _WORDS, 1)
    return named or (_WORDS[near[0]] if near else "")
