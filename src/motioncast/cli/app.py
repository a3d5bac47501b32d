"""The commands by name, each loaded when it is called, and the exit status of what it did.

Exit status: 0 done, 1 our fault, 2 the user's input, 130 interrupted.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Sequence

from cyclopts import App, CycloptsError, Parameter

from motioncast.cli.say import complain
from motioncast.errors import InputError, MotioncastError

COMMANDS = {
    "demo": "Forecast the shipped dancing couple, or a room, and compare with what really happened.",
    "forecast": "Forecast the people of a scene file, or of several motion files of one world and clock.",
    "info": "Say what a motion file holds: people, frame rate, joints and what they were recognised as.",
    "view": "Show a forecast as an interactive page.",
    "annotate": "Mark characteristic moments of motions in the browser, by key.",
    "export": "Write a scene or a forecast as npz, csv, trc, bvh or glb, or a forecast as a page (html).",
    "models": "List the models, trained and simple.",
    "time": "Measure how long a model takes.",
    "train": "Train a model by a recipe.",
    "ship": "Write the graph and the card of a trained run, with calibrated error radii.",
    "plot": "Draw the curves of a training run.",
    "evaluate": "Measure a model by a benchmark.",
    "leaderboard": "Show the models of a benchmark, the most accurate first.",
    "coverage": "Print how much of what really happened lies within a model's error radii.",
    "doctor": "Say which versions, extras, models and cores are here; first thing to attach to a report.",
}
"""Every command: function of that name in the module of that name, and its line of help."""


def build() -> App:
    """The command line parser; no command's module is loaded yet."""
    app = App(
        name="motioncast",
        help="What will they do next? Forecasts of people's motion.",
        help_epilogue="Start with: motioncast demo",
        version_flags=[],
        default_parameter=Parameter(negative=()),
        result_action="return_value",
        suppress_keyboard_interrupt=False,
    )
    for name, line in COMMANDS.items():
        app.command(f"motioncast.cli.{name}:{name}", name=name, help=line)
    datasets = App(name="datasets", help="List the data sets and where to obtain them; check a copy.")
    datasets.command("motioncast.cli.datasets:check", name="check", help="Check a copy of a data set.")
    datasets.command("motioncast.cli.datasets:convert", name="convert", help="Write its scenes as files of our own.")
    datasets.default(_list_datasets)  # a default command cannot be named by a string
    app.command(datasets)
    return app


def _list_datasets(*, json: bool = False) -> None:
    from motioncast.cli.datasets import datasets

    datasets(json=json)


def run(arguments: Sequence[str]) -> int:
    """Runs one command line and returns its exit status.

    Example:
        >>> run(["forecats"])  # the complaint goes to stderr
        2
    """
    try:
        build()(list(arguments), exit_on_error=False, print_error=False)
    except CycloptsError as error:
        return complain(f"{error} (motioncast --help shows what there is)", 2)
    except InputError as error:
        return complain(str(error), 2)
    except MotioncastError as error:
        return complain(str(error), 1)
    except KeyboardInterrupt:
        return complain("interrupted; nothing half-written was left behind", 130)
    except BrokenPipeError:  # the reader of our output, such as head, has seen enough
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 0
    except Exception as error:
        if "MOTIONCAST_TRACEBACK" in os.environ:
            raise
        what = f"{type(error).__name__}: {error}".replace("\n", " ")
        return complain(
            f"a fault of motioncast, not of yours ({what}); report it with what MOTIONCAST_TRACEBACK=1 shows",
            1,
        )
    return 0
