"""One door for every motion file: the format is told from suffix and content.

A format is one file of this folder with ``suffixes``, ``sniff(head)``, ``read(path, up=, unit=, fps=, named=)`` and,
where it can be written, ``write(scene, path)``; it is entered in ``FORMATS``.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Protocol, cast

from motioncast.core.forecast import Forecast
from motioncast.core.goal_poses import GoalPoses
from motioncast.core.room import furnish
from motioncast.core.scene import Scene, join
from motioncast.errors import FormatError, InputError, OutputError
from motioncast.formats import asf_amc, bvh, c3d, csv, npz, trc, units
from motioncast.formats.files import read_bytes, read_text
from motioncast.formats.room import read_room

HEAD_BYTES = 4096


class Format(Protocol):
    """What a format's module offers."""

    suffixes: tuple[str, ...]

    def sniff(self, head: bytes) -> bool:
        """Whether a file that begins so is of this format."""
        ...

    def read(
        self, path: str | Path, *, up: str | None, unit: str | None, fps: float | None, named: Mapping[str, str] | None
    ) -> Scene:
        """The scene in a file."""
        ...


FORMATS: dict[str, Format] = {
    name: cast(Format, module) for name, module in {"bvh": bvh, "npz": npz, "csv": csv, "trc": trc, "c3d": c3d}.items()
}
"""Formats of one file a scene; ASF/AMC comes in pairs and is handled apart."""


def load_scene(
    *paths: str | Path,
    up: str | None = None,
    unit: str | None = None,
    fps: float | None = None,
    named: Mapping[str, str] | None = None,
    room: str | Path | None = None,
) -> Scene:
    """The people of one world and one clock, from one scene file or several motion files.

    Args:
        *paths: BVH, NPZ, CSV, TRC, C3D or AMC files. The ASF file of an AMC file lies beside it or is given too.
            Several files share world and clock; files of one person name that person by their stem.
        up: Axis that points up in the files (x, y, z, with a minus for down); else stated by them or inferred.
        unit: Unit of length of the files (m, cm, mm, inch, cmu); else stated by them or inferred.
        fps: Frame rate to believe instead of the files'.
        named: Landmarks by joint name, over the recognised ones (``read_map``).
        room: JSON or GLB file of the furniture around them (``formats.room``), in their world.

    Raises:
        InputError: If a file is missing, comes twice, or its format is unknown.
        FormatError: With the line, if a file is damaged.
        SceneError: If the files do not fit together or no unit makes a person of a body.
        MissingExtra: If a C3D file comes and ezc3d is not installed.
    """
    if fps is not None and not 0 < fps < float("inf"):
        raise InputError(f"{fps:g} frames a second were given; expected a positive number")
    if not paths:
        raise InputError("no motion file came; give one scene file, or one motion file a person")
    files = [Path(path) for path in paths]
    seen: set[Path] = set()
    for file in files:
        if file.resolve() in seen:
            raise InputError(f"{file} is given twice; give each person's file once")
        seen.add(file.resolve())
    skeletons = [file for file in files if file.suffix.lower() == ".asf"]
    motions = [file for file in files if file not in skeletons]
    if not motions or (skeletons and not any(_is_amc(file) for file in motions)):
        raise InputError(f"{skeletons[0]} is a skeleton without motion; give its AMC file too")
    scenes = []
    for file in motions:
        if _is_amc(file):
            scene = _read_amc(file, skeletons, up, unit, fps, named)
        else:
            scene = format_of(file).read(file, up=up, unit=unit, fps=fps, named=named)
        scenes.append(units.check_size(scene))
    scene = scenes[0] if len(scenes) == 1 else join(scenes)
    return scene if room is None else furnish(scene, read_room(room))


FOR_BLENDER = (".fbx", ".dae", ".blend", ".usd", ".usda", ".usdc", ".usdz", ".abc")
"""Animation files that are not read here, but that Blender opens."""


def format_of(path: str | Path) -> Format:
    """The format of a file, from its suffix and its first bytes.

    Raises:
        InputError: If the file is missing or of no known format.
    """
    head = read_bytes(path, HEAD_BYTES)
    suffix = Path(path).suffix.lower()
    ours = [entry for entry in FORMATS.values() if suffix in entry.suffixes]
    for entry in (*ours, *FORMATS.values()):
        if entry.sniff(head):
            return entry
    if ours:  # its reader says best what is wrong with the file
        return ours[0]
    known = ", ".join(suffix for entry in FORMATS.values() for suffix in entry.suffixes)
    advice = "; open it in Blender and export BVH" if suffix in FOR_BLENDER else ""
    raise InputError(f"{path} is of no known format; expected one of {known}, .amc{advice}")


def save_scene(scene: Scene, path: str | Path) -> tuple[Path, ...]:
    """Writes a scene; the suffix tells the format: .npz .csv .trc .bvh .glb.

    BVH and GLB need rotations: they are fitted where the scene has none.

    Returns:
        The files written: several where the format holds one person.

    Raises:
        OutputError: If a file cannot be written, or the suffix is unknown.
    """
    return _writer(path)(scene, path)


def save_forecast(forecast: Forecast, path: str | Path, truth: Scene | None = None) -> tuple[Path, ...]:
    """Writes a forecast; the suffix tells the format, as for ``save_scene``.

    NPZ holds everything, CSV all samples, the others the most probable sample.

    Args:
        forecast: The forecast.
        path: The file.
        truth: What really happened, for NPZ files.

    Returns:
        The files written.

    Raises:
        OutputError: If a file cannot be written, or the suffix is unknown.
    """
    suffix = Path(path).suffix.lower()
    if suffix in npz.suffixes:
        return npz.write_forecast(forecast, path, truth)
    if suffix in csv.suffixes:
        return csv.write_forecast(forecast, path)
    return _writer(path, forecast.history)(forecast.scene(), path)


def save_goals(goals: GoalPoses, path: str | Path) -> tuple[Path, ...]:
    """Writes goal poses as an NPZ file, all of them.

    Returns:
        The file written.

    Raises:
        OutputError: If the file cannot be written.
    """
    return npz.write_goals(goals, path)


def load_goals(path: str | Path) -> GoalPoses:
    """The goal poses in an NPZ file.

    Raises:
        InputError: If the file is missing.
        FormatError: If it is damaged or holds something else.
    """
    return npz.read_goals(path)


def load_forecast(path: str | Path) -> Forecast:
    """The forecast in an NPZ file.

    Raises:
        InputError: If there is no such file.
        FormatError: If it is damaged or holds no forecast.
    """
    return npz.read_forecast(path)


def load_truth(path: str | Path) -> Scene | None:
    """What really happened, where the forecast file holds it.

    Raises:
        InputError: If there is no such file.
        FormatError: If it is damaged or holds no forecast.
    """
    return npz.read_truth(path)


def read_map(path: str | Path) -> dict[str, str]:
    """Landmarks by joint name from a text file: ``joint = landmark`` a line, ``#`` starts a comment.

    Raises:
        InputError: If there is no such file.
        FormatError: With the line, if a line is anything else or a joint comes twice.
    """
    named: dict[str, str] = {}
    for number, line in enumerate(read_text(path, 1 << 20).split("\n"), 1):
        joint, equals, landmark = (part.strip() for part in line.partition("#")[0].partition("="))
        if not equals and not joint:
            continue
        if not equals or not joint:
            raise FormatError(path, f'"{line.strip()[:60]}" where "joint = landmark" was expected', number)
        if joint in named:
            raise FormatError(path, f'the joint "{joint}" comes twice', number)
        named[joint] = landmark
    return named


def _writer(path: str | Path, reference: Scene | None = None) -> Callable[[Scene, str | Path], tuple[Path, ...]]:
    suffix = Path(path).suffix.lower()
    if suffix in (".bvh", ".glb"):
        return lambda scene, path: _write_turned(scene, Path(path), reference)
    for module in (npz, csv, trc):
        if suffix in module.suffixes:
            return module.write
    raise OutputError(f'cannot write {path}: the suffix "{suffix}" is unknown; use .npz, .csv, .trc, .bvh or .glb')


def _write_turned(scene: Scene, path: Path, reference: Scene | None) -> tuple[Path, ...]:
    if scene.rotations is None:
        from motioncast.core.kinematics import fit_rotations

        scene = fit_rotations(scene, reference)
    if path.suffix.lower() == ".bvh":
        return bvh.write(scene, path)
    from motioncast.formats.glb import write_glb

    write_glb(scene, path)
    return (path,)


def _is_amc(path: Path) -> bool:
    return path.suffix.lower() == ".amc"


def _read_amc(
    amc: Path,
    skeletons: list[Path],
    up: str | None,
    unit: str | None,
    fps: float | None,
    named: Mapping[str, str] | None,
) -> Scene:
    if up is not None or unit is not None:
        raise InputError(f"{amc} takes unit and axes from its ASF file, which has y up; leave --up and --unit out")
    if named:
        raise InputError(f"{amc} has CMU's bone names, which are known; leave --map out")
    read_bytes(amc, 1)  # a missing motion file is the better news than a missing skeleton
    return asf_amc.read_asf_amc(_skeleton_of(amc, skeletons), amc, fps)


def _skeleton_of(amc: Path, skeletons: list[Path]) -> Path:
    """The ASF file of an AMC file: given, or beside it; the same stem or the part before "_" ("60" of "60_01")."""
    beside = sorted(entry for entry in amc.parent.iterdir() if entry.suffix.lower() == ".asf")
    for choices in (skeletons, beside):
        for stem in (amc.stem, amc.stem.partition("_")[0]):
            for choice in choices:
                if choice.stem == stem:
                    return choice
        if len(choices) == 1:
            return choices[0]
    raise InputError(f"{amc} has no skeleton file {amc.stem.partition('_')[0]}.asf beside it; give it as a path too")
