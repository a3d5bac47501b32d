"""Every error that motioncast raises on purpose.

    MotioncastError
    ├── InputError            something that the user gave cannot be used (exit status 2)
    │   ├── FormatError       a file is damaged or is not what it claims to be (names the line or frame)
    │   ├── SkeletonError     joints that are needed are missing or ambiguous
    │   ├── SceneError        a scene cannot be forecast (history too short, nobody there, absurd numbers)
    │   └── ModelNotFound     no model of that name or path
    ├── MissingExtra          an optional dependency is not installed (names the command that installs it)
    └── OutputError           the answer could not be written (nothing half-written is left behind)

A message is one sentence: what came, what was expected, what to do.
"""

from __future__ import annotations

from pathlib import Path


class MotioncastError(Exception):
    """Base of every error that motioncast raises on purpose."""


class InputError(MotioncastError):
    """Something that the user gave cannot be used."""


class FormatError(InputError):
    """A file is damaged or is not what it claims to be.

    Args:
        path: The file.
        what: What came and what was expected.
        line: One-based line number, where the format has lines.
    """

    def __init__(self, path: str | Path, what: str, line: int | None = None) -> None:
        where = f"{path}:{line}" if line is not None else f"{path}"
        super().__init__(f"{where}: {what}")
        self.path = str(path)
        self.line = line


class SkeletonError(InputError):
    """Joints that are needed are missing or ambiguous."""


class SceneError(InputError):
    """A scene cannot be forecast."""


class ModelNotFound(InputError):
    """No model of that name or path."""


class OutputError(MotioncastError):
    """The answer could not be written."""


class MissingExtra(MotioncastError):
    """An optional dependency is not installed.

    Args:
        what: What the user asked for.
        extra: The extra of the package that brings it.
    """

    def __init__(self, what: str, extra: str) -> None:
        super().__init__(f'{what} needs the extra "{extra}"; install it with: pip install "motioncast[{extra}]"')
