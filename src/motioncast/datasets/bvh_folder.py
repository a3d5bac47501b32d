"""Any folder of BVH files: one scene a file, one person a scene; unit and up axis inferred from the body."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from motioncast.core.scene import Scene
from motioncast.datasets.catalogue import DataSet, below
from motioncast.formats.load import load_scene


def takes(folder: str | Path) -> list[Path]:
    """The BVH files below a folder."""
    return below(Path(folder), "*.bvh", "*.BVH")


def read(path: str | Path) -> Iterator[Scene]:
    """The scene of one file.

    Raises:
        InputError: If there is no such file.
        FormatError: With the line, if it is damaged.
        SceneError: If no unit makes a person of the body.
    """
    yield load_scene(path)


DATASET = DataSet(
    "bvh-folder",
    "any folder of BVH files, one person a file",
    "that of your files",
    "any",
    "your own files; which joints are recognised says: motioncast info FILE",
    ("*.bvh or *.BVH",),
    takes,
    read,
)
