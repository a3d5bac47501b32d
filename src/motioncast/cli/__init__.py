"""The command line; thin: every command has a Python twin."""

from __future__ import annotations

import sys


def main() -> None:
    """Entry point of the command ``motioncast``."""
    arguments = sys.argv[1:]
    if arguments == ["--version"]:  # answered before the parser is loaded, which takes a tenth of a second
        from motioncast import __version__

        print(__version__)
        return
    try:
        from motioncast.cli.app import run

        sys.exit(run(arguments))
    except KeyboardInterrupt:  # while the parser was being loaded
        sys.exit(130)
