"""``motioncast annotate``: characteristic moments, found by a rule, accepted, moved, added or rejected in a browser."""

from __future__ import annotations

import webbrowser
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING

from motioncast.cli.reading import AS_THE_FILE_SAYS, Reading, read_scene
from motioncast.errors import InputError

if TYPE_CHECKING:
    from motioncast.core.scene import Scene
    from motioncast.view.annotate_desk import Desk, Motion


def annotate(
    *files: Path,
    data: Path | None = None,
    out: Path | None = None,
    port: int = 0,
    automatic: bool = False,
    closed: bool = False,
    reading: Reading = AS_THE_FILE_SAYS,
) -> None:
    """Mark characteristic moments: where a movement is most articulated.

    A rule finds them; the page shows them one by one, by key. Every change is written at once to a small table beside
    the motion (NAME.moments.tsv), and a later call goes on where this one ended. Stop with Ctrl+C.

    Args:
        files: Motions, each annotated by itself.
        data: Annotate the takes of a copy of CMU's motions instead.
        out: One table for all motions. Default with --data: moments.tsv in this folder.
        port: Port on the loopback address. Default: a free one.
        automatic: Write what the rule finds and serve no page.
        closed: Print the address and do not open it.
        reading: How to read files whose header lies or says nothing.
    """
    from motioncast.view.annotate_desk import Desk
    from motioncast.view.annotate_server import AnnotateServer

    if bool(files) == (data is not None):
        raise InputError("give motion files or --data with a folder of CMU's takes, one of the two")
    motions = takes_of(data, out or Path("moments.tsv")) if data is not None else motions_of(files, out, reading)
    desk = Desk(list(motions))
    if automatic:
        print(f"{write_automatic(desk):,} moments in {', '.join(map(str, desk.tables))}")
        return
    try:
        server = AnnotateServer(desk, port)
    except OSError as error:
        raise InputError(
            f"port {port} cannot be used ({(error.strerror or str(error)).lower()}); give another"
        ) from None
    with server:
        print(f"{len(desk.motions)} motions; open {server.url} (Ctrl+C stops)", flush=True)
        if not closed:
            webbrowser.open(server.url)
        server.serve_forever()


def motions_of(files: tuple[Path, ...], out: Path | None, reading: Reading) -> Iterator[Motion]:
    """Motion files, each with the table beside it or all with one."""
    from motioncast.view.annotate_desk import Motion, beside

    def reader(file: Path) -> Callable[[], Scene]:
        return lambda: read_scene([file], reading)

    for file in files:
        own = beside(file)
        yield Motion(file.stem, reader(file), out or own)


def takes_of(data: Path, out: Path) -> Iterator[Motion]:
    """CMU's takes, one person each."""
    from motioncast.datasets import cmu
    from motioncast.view.annotate_desk import Motion

    def reader(take: cmu.Take) -> Callable[[], Scene]:
        return lambda: next(iter(cmu.read([take])))

    for take in cmu.takes(data):
        yield Motion(take.name, reader(take), out)


def write_automatic(desk: Desk) -> int:
    """Write what the rule finds in every motion that no table knows yet; returns how many moments there are then."""
    for number, entry in enumerate(desk.listed()):
        if not entry["seen"]:
            desk.keep(number, desk.opened(number)["moments"])
    return sum(len(table) for table in desk.tables.values())
