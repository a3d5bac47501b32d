"""Furniture of Humans in Kitchens: ``scenes/{A|B|C|D}_scene/NAME.json`` and ``NAME.npy``, metres, z up, floor at 0.

A box is eight corners (0 to 3 one face, 4 to 7 behind them in the same order), a cylinder the middle of its top and its
radius; a row a frame of things that are moved, every second one at 12.5 a second. Markers of what is out of bounds are
left out, as the owners do. Names, shapes and the counting of rows are those of the owners' code; no file was at hand.
"""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from motioncast.core.rotation import from_matrix
from motioncast.core.scene_object import CATEGORIES, SceneObject
from motioncast.datasets.catalogue import below
from motioncast.errors import FormatError
from motioncast.formats.files import read_text

OUTSIDE = "out_of_bound"


@dataclass(frozen=True, slots=True, eq=False)
class Piece:
    """A piece of furniture, wherever it stands.

    Attributes:
        name: Its name.
        category: One of ``CATEGORIES``.
        places: ``(rows, 8, 3)`` corners of a box, or ``(rows, 4)`` top and radius of a cylinder.
        frames_a_row: Frames of the recording for a row; 0 of what never moves.
    """

    name: str
    category: str
    places: np.ndarray
    frames_a_row: int

    def at(self, frame: int) -> SceneObject:
        """The object as it stands in a frame of the recording."""
        row = frame // self.frames_a_row if self.frames_a_row else 0
        place = self.places[min(row, len(self.places) - 1)].astype(np.float64)
        if place.ndim == 1:
            x, y, top, radius = place
            size, middle = (2 * radius, 2 * radius, top), (x, y, top / 2)
            return SceneObject(self.name, self.category, "cylinder", np.array(size), np.array(middle))
        edges = place[[1, 3, 4]] - place[0]
        edges = np.roll(edges, 2 - np.abs(edges[:, 2]).argmax(), 0)  # the steepest one is the height
        edges[2] *= np.sign(edges[2, 2])
        lengths = np.linalg.norm(edges, axis=-1)
        along = edges[0] / max(lengths[0], 1e-9)
        axes = np.stack([along, np.cross([0, 0, 1], along), [0, 0, 1]], -1)
        return SceneObject(self.name, self.category, "box", lengths, place.mean(0), from_matrix(axes))


def pieces(folder: str | Path, kitchen: str) -> list[Piece]:
    """The furniture of a kitchen; none where the folder has no scenes.

    Raises:
        FormatError: If a file is damaged or of another layout.
    """
    found = [_piece(path) for path in below(Path(folder), f"{kitchen}_scene/*.json")]
    return [piece for piece in found if piece.category != OUTSIDE]


def _piece(path: Path) -> Piece:
    try:
        told = json.loads(read_text(path))
        category = told["type"].rpartition(".")[2].lower()
        places = np.load(path.with_suffix(".npy"), allow_pickle=False)
        shape = (8, 3) if told["shape"] == "box" else (4,)
        piece = Piece(told["name"], category, places, int(told["frame_multiplier"]))
    except (OSError, ValueError, TypeError, KeyError, AttributeError, RecursionError):
        raise FormatError(path, "is no object of Humans in Kitchens with its .npy beside it; get both again") from None
    if category not in CATEGORIES or places.shape[1:] != shape or not len(places) or not np.isfinite(places).all():
        raise FormatError(
            path, f'has the type "{category}" and places of shape {places.shape}; expected a known type and (rows, '
            f"{', '.join(map(str, shape))}) finite numbers"
        )  # fmt: skip
    return piece
