"""Results as files: what a model reached on a benchmark, and all that is needed to check it."""

from __future__ import annotations

import json
import re
import subprocess
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field, fields
from importlib import resources
from pathlib import Path
from typing import Any

import motioncast
from motioncast.errors import InputError
from motioncast.formats.files import atomic_write

SCHEMA = "motioncast.result/1"


@dataclass(frozen=True, slots=True)
class Row:
    """One figure: a metric at a moment (or until one), with its 95 % interval over takes.

    Attributes:
        metric: Its name; ``_at`` a moment, ``_until`` a moment as a mean from the first frame on.
        horizon_s: The moment.
        value: The figure.
        unit: mm, cm, m, m/s or 1.
        n: Windows in which it is measured.
        low: Lower end of the interval; None where there is none.
        high: Upper end.
    """

    metric: str
    horizon_s: float
    value: float
    unit: str
    n: int
    low: float | None = None
    high: float | None = None


@dataclass(frozen=True, slots=True)
class Result:
    """What a model reaches on a benchmark (``motioncast.result/1``).

    Attributes:
        model: Name of the model.
        benchmark: Name of the benchmark.
        protocol: Hash of the protocol and its windows; results of different hashes are not comparable.
        data: SHA-256 of the windows.
        setting: The protocol in full, with true times in ms and the split.
        windows: Number of windows.
        takes: Number of takes that they come from.
        independent: What the intervals are drawn over, and how many of them.
        weights: SHA-256 of the model's weights; empty for a rule.
        parameters: Number of trained parameters.
        training: What the training cost (``ModelCard.training``).
        command: What prints this result.
        commit: State of the code; empty outside a checkout.
        seed: Seed of the samples.
        rows: The figures; the last one is the ratio to standing still.
        schema: Version of this layout.
    """

    model: str
    benchmark: str
    protocol: str
    data: str
    setting: Mapping[str, Any]
    windows: int
    takes: int
    independent: str
    weights: str
    parameters: int
    training: Mapping[str, Any]
    command: str
    commit: str
    seed: int
    rows: tuple[Row, ...] = field(default=())
    schema: str = SCHEMA

    @property
    def ratio(self) -> Row:
        """The mean error at the summary's moments over that of standing still."""
        return self.rows[-1]


def to_json(result: Result) -> dict[str, Any]:
    """A result as JSON has it."""
    return asdict(result)


def save_result(result: Result, folder: Path) -> Path:
    """Write a result as ``BENCHMARK.MODEL.json``, of a further seed as ``BENCHMARK.MODEL.seedN.json``."""
    name = re.sub(r"[^\w-]+", "-", result.model).strip("-")
    seed = result.training.get("seed", 0)
    path = folder / f"{result.benchmark}.{name}{f'.seed{seed}' if seed else ''}.json"
    with atomic_write(path) as temporary:
        temporary.write_text(json.dumps(to_json(result), indent=1) + "\n", encoding="utf-8")
    return path


def load_result(path: Path) -> Result:
    """Read a result.

    Raises:
        InputError: If the file holds none.
    """
    try:
        values = json.loads(path.read_text(encoding="utf-8"))
        if values["schema"] != SCHEMA or not set(values) <= {entry.name for entry in fields(Result)}:
            raise ValueError(values["schema"])
        return Result(**{**values, "rows": tuple(Row(**row) for row in values["rows"])})
    except (ValueError, KeyError, TypeError) as error:
        raise InputError(
            f"{path} holds no result ({error!r:.80}); expected what motioncast evaluate --out writes"
        ) from None


def shipped_results() -> Path:
    """The folder of the results that come with the package."""
    return Path(str(resources.files("motioncast.benchmarks"))) / "results"


def comparable(results: list[Result]) -> list[Result]:
    """Results of one protocol and the same windows, the most accurate first.

    Raises:
        InputError: If they are not.
    """
    hashes: dict[str, str] = {}
    for result in results:
        hashes.setdefault(result.protocol, result.model)
    if len(hashes) > 1:
        told = ", ".join(f"{model} ({protocol})" for protocol, model in hashes.items())
        raise InputError(f"results of different protocols do not compare: {told}; evaluate them again on one data set")
    return sorted(results, key=lambda result: result.ratio.value)


def commit() -> str:
    """State of the code: its commit, with ``+`` where files differ from it; the version outside a checkout."""
    root = Path(__file__).parents[3]
    if (root / ".git").exists():
        line = ["git", "-C", str(root), "describe", "--always", "--dirty=+", "--abbrev=12", "--exclude=*"]
        done = subprocess.run(line, capture_output=True, text=True)
        if done.returncode == 0:
            return done.stdout.strip()
    return motioncast.__version__
