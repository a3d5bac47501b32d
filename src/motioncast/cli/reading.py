"""Options that every command that reads motion takes, and the reading itself."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import ceil
from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

from motioncast.cli.say import note
from motioncast.core.card import ModelCard
from motioncast.core.scene import Scene
from motioncast.errors import InputError


@Parameter(name="*")
@dataclass(frozen=True)
class Reading:
    """How to read a file whose header lies or says nothing."""

    up: Annotated[str | None, Parameter(help="Axis that points up: x, y, z, or one with a minus for down.")] = None
    unit: Annotated[str | None, Parameter(help="Unit of length: m, cm, mm, inch, cmu, or a number of metres.")] = None
    fps: Annotated[float | None, Parameter(help="Frames a second.")] = None
    map: Annotated[
        Path | None, Parameter(help='File of lines "joint = landmark" for joints that are not recognised.')
    ] = None


AS_THE_FILE_SAYS = Reading()


def read_scene(paths: Sequence[Path], reading: Reading = AS_THE_FILE_SAYS) -> Scene:
    """One scene of these files; says on stderr what the reader inferred or mended."""
    from motioncast.formats.load import load_scene, read_map

    named = None if reading.map is None else read_map(reading.map)
    scene = load_scene(*paths, up=reading.up, unit=reading.unit, fps=reading.fps, named=named)
    if not all(path.suffix.lower() == ".npz" for path in paths):  # those keep what was said of the original file
        note(scene.remarks)
    return scene


def put_into(scene: Scene, file: Path, history: int | None = None) -> Scene:
    """A scene with the furniture of a room file; says on stderr what was inferred and who stands inside a thing.

    Args:
        scene: The people.
        file: The room.
        history: Frames of the scene that may be looked at. Default: all.
    """
    from motioncast.core.room import furnish
    from motioncast.formats.room import read_room

    furnished = furnish(scene, read_room(file), history)
    note(furnished.remarks[len(scene.remarks) :])
    return furnished


def moment(scene: Scene, seconds: float) -> int:
    """Number of frames that are history when the scene is asked about after that many seconds.

    Raises:
        InputError: If the moment lies outside the scene.
    """
    frames = round(seconds * scene.fps)
    if not 1 <= frames <= scene.frames:
        raise InputError(
            f"--at {seconds:g} lies outside the motion of {scene.duration_s:.2f} s; give a moment within it"
        )
    return frames


def seconds_of(frames: int, fps: float) -> str:
    """The moment after so many frames, as --at takes it.

    Example:
        >>> seconds_of(29, fps=30)
        '0.967'
    """
    return f"{round(frames / fps, 3):g}"


def frames_needed(card: ModelCard, fps: float) -> int:
    """Frames at a scene's rate that span the history of a model.

    Example:
        >>> frames_needed(ModelCard("m", "s", "forecast", "any", history=15, horizon=45, fps=15), fps=30)
        29
    """
    return ceil((card.history - 1) / card.fps * fps - 1e-6) + 1


def holds_forecast(path: Path) -> bool:
    """Whether a file is a forecast file, to be told from the scenes that are npz files too."""
    if path.suffix.lower() != ".npz":
        return False
    from motioncast.formats.files import read_npz

    return "samples" in read_npz(path)
