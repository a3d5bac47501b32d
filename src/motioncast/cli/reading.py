"""Options that every command that reads motion takes, and the reading itself."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Literal

from cyclopts import Parameter

from motioncast.cli.say import note
from motioncast.core.scene import Scene
from motioncast.errors import FormatError, InputError


@Parameter(name="*")
@dataclass(frozen=True)
class Reading:
    """How to read a file whose header lies or says nothing."""

    up: Annotated[Literal["x", "y", "z"] | None, Parameter(help="Axis that points up.")] = None
    unit: Annotated[Literal["m", "cm", "mm", "in"] | None, Parameter(help="Unit of length.")] = None
    fps: Annotated[float | None, Parameter(help="Frames a second.")] = None
    map: Annotated[
        Path | None, Parameter(help='Landmarks of joints that are not recognised: "joint = landmark" a line.')
    ] = None


AS_THE_FILE_SAYS = Reading()


def read_scene(paths: tuple[Path, ...], reading: Reading = AS_THE_FILE_SAYS) -> Scene:
    """One scene of these files; says on stderr what the reader inferred or mended."""
    if not paths:
        raise InputError("no motion file came; give one scene file, or one motion file a person")
    from motioncast.formats.load import load_scene

    named = None if reading.map is None else read_map(reading.map)
    scene = load_scene(*paths, up=reading.up, unit=reading.unit, fps=reading.fps, named=named)
    note(scene.remarks)
    return scene


def read_map(path: Path) -> dict[str, str]:
    """Landmarks by joint name, from a text of lines ``joint = landmark``; # starts a comment.

    Raises:
        FormatError: If a line has no equals sign.
    """
    try:
        lines = path.read_text(encoding="utf-8").splitlines()
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(f"the map {path} cannot be read ({error}); give a text file") from None
    named: dict[str, str] = {}
    for number, line in enumerate(lines, 1):
        joint, equals, landmark = line.partition("#")[0].partition("=")
        if equals:
            named[joint.strip()] = landmark.strip()
        elif joint.strip():
            raise FormatError(path, f'"{line.strip()}" is not "joint = landmark"', number)
    return named
