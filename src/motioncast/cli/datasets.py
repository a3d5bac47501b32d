"""``motioncast datasets``: the data sets, where to obtain them, whether a copy is whole, and their scenes as files."""

from __future__ import annotations

import re
from dataclasses import asdict
from pathlib import Path

from motioncast.cli import say
from motioncast.errors import InputError


def datasets(*, json: bool = False) -> None:
    """List the data sets and where to obtain them.

    Args:
        json: Print one JSON object.
    """
    from motioncast.datasets.catalogue import catalogue

    found = catalogue().values()
    if json:
        keys = ("name", "what", "licence", "size", "origin", "files")
        rows = [{key: getattr(entry, key) for key in keys} for entry in found]
        say.emit({"schema": "motioncast.datasets/1", "datasets": rows})
        return
    for entry in found:
        print(f"{entry.name}: {entry.what}\n  licence: {entry.licence}")
        print(f"  size:    {entry.size}\n  from:    {entry.origin}")
    print("\ncheck a copy: motioncast datasets check cmu --data FOLDER")


def check(name: str, /, *, data: Path, json: bool = False) -> None:
    """Check a copy of a data set: what is there, what is missing, what is odd; every scene is read once.

    Args:
        name: Name of the data set.
        data: Folder that holds it.
        json: Print one JSON object.
    """
    from motioncast.datasets.catalogue import data_set

    entry = data_set(name)
    with say.progress("reading every scene") as progress:
        findings = entry.check(data, progress)
    if json:
        rows = [asdict(finding) for finding in findings]
        say.emit({"schema": "motioncast.check/1", "dataset": name, "folder": str(data), "findings": rows})
    else:
        for finding in findings:
            print(f"{finding.kind + ':':<9}{finding.what}")
    missing = [finding.what for finding in findings if finding.kind == "missing"]
    if missing:
        raise InputError(f"{data} lacks {', '.join(missing)}; obtain {name} from {entry.origin}")


def convert(name: str, /, *, data: Path, out: Path, back: bool = False) -> None:
    """Write each scene of a copy as a file of our own (npz), or such files as the data set's own (somof only).

    Args:
        name: Name of the data set.
        data: Folder that holds it; with --back, folder of our files.
        out: Folder for the files; it is made.
        back: Write the data set's own files from ours.
    """
    from motioncast.cli.writing import make_folder
    from motioncast.datasets.catalogue import data_set

    entry = data_set(name)
    if back and name != "somof":
        raise InputError(f"{name} cannot be written, only read; --back is there for somof")
    if back:
        files = _written_back(data, out)
    else:
        make_folder(out)
        from motioncast.formats.load import save_scene

        files, taken = [], set[str]()
        for scene in entry.scenes(data):
            file = _file_name(scene.source, taken)
            taken.add(file.lower())
            files += save_scene(scene, out / file)
    print(f"{len(files):,} files in {out}")


def _written_back(data: Path, out: Path) -> list[Path]:
    """SoMoF's files of every split that a folder of our files holds."""
    from motioncast.cli.writing import make_folder
    from motioncast.datasets import somof
    from motioncast.datasets.catalogue import below
    from motioncast.formats.load import load_scene

    windows = [load_scene(path) for path in below(data, "*.npz")]
    if not windows:
        raise InputError(f"{data} holds no npz files; give a folder that --out of this command wrote")
    make_folder(out)
    files: list[Path] = []
    for split in somof.SPLITS:
        own = [window for window in windows if window.source.startswith(f"SoMoF {split} ")]
        files += somof.write(own, out, split) if own else ()
    if not files:
        raise InputError(f"no file in {data} comes from SoMoF; give a folder that --out of this command wrote")
    return files


def _file_name(source: str, taken: set[str]) -> str:
    """A name for the file of a scene, that no other has.

    Example:
        >>> _file_name("AMASS CMU/01 01_01", set()), _file_name("a b", {"a_b.npz"})
        ('AMASS_CMU_01_01_01.npz', 'a_b_2.npz')
    """
    stem = re.sub(r"[^\w.-]+", "_", source).strip("_.")[:150] or "scene"
    name, number = f"{stem}.npz", 1
    while name.lower() in taken:
        number += 1
        name = f"{stem}_{number}.npz"
    return name
