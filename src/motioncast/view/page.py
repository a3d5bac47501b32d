"""One self-contained, interactive page of a forecast: no request but the file itself.

The program of the page (``page.js``, ``page.css``, ``page.html``) is built from ``frontend/``; ``contents`` says what
it is about.
"""

from __future__ import annotations

import base64
import hashlib
import html
import json
import re
from collections.abc import Mapping
from importlib.resources import files
from pathlib import Path
from typing import Any

import numpy as np

from motioncast.core.forecast import Forecast
from motioncast.core.scene import Scene
from motioncast.errors import SceneError
from motioncast.formats.files import atomic_write
from motioncast.view.contents import contents
from motioncast.view.curves import Curves


def write_page(
    forecast: Forecast, path: str | Path, truth: Scene | None = None, title: str | None = None,
    curves: Curves | None = None,
) -> None:  # fmt: skip
    """Write the page of a forecast; the arguments are those of ``page_html``.

    Raises:
        SceneError: If the truth has other joints or another frame rate than the forecast.
        OutputError: If the file cannot be written.
    """
    text = page_html(forecast, truth, title, curves)
    with atomic_write(path) as temporary:
        temporary.write_text(text, encoding="utf-8", newline="\n")


def page_html(
    forecast: Forecast, truth: Scene | None = None, title: str | None = None, curves: Curves | None = None
) -> str:
    """The page of a forecast as HTML text.

    Args:
        forecast: What is shown.
        truth: What really happened: frame 0 is the first frame after the last seen one. It may be shorter
            than the forecast and lack people.
        title: Heading. Default: the source of the history.
        curves: Errors of other forecasts, drawn beside the model's own; an entry of the model's name
            replaces the error that the page would compute (mean over people and joints that the model knows).

    Raises:
        SceneError: If the truth has other joints or another frame rate than the forecast.
    """
    if truth is not None:
        _check(forecast, truth)
    about, numbers = contents(forecast, truth, title, curves or {})
    source = files("motioncast.view")
    style = source.joinpath("page.css").read_text(encoding="utf-8")
    script = source.joinpath("page.js").read_text(encoding="utf-8")
    policy = (
        f"default-src 'none'; script-src '{source_hash(script)}'; style-src '{source_hash(style)}'; img-src data:; "
        "base-uri 'none'; form-action 'none'"
    )
    parts = {
        "policy": policy,
        "title": html.escape(about["title"]),
        "style": style,
        "about": json_block(about),
        "numbers": base64.b64encode(numbers).decode("ascii"),
        "script": script,
    }
    template = source.joinpath("page.html").read_text(encoding="utf-8")
    return filled(template, parts)


def filled(template: str, parts: Mapping[str, str]) -> str:
    """A template with its marks replaced.

    Example:
        >>> filled("<h1>{{title}}</h1>", {"title": "Walk"})
        '<h1>Walk</h1>'
    """
    return re.sub(r"\{\{(\w+)\}\}", lambda match: parts[match[1]], template)


def json_block(value: Any) -> str:
    r"""JSON that is safe inside a script element, whatever text it holds.

    Example:
        >>> json_block({"name": "</script>"})
        '{"name":"\\u003c/script\\u003e"}'
    """
    text = json.dumps(value, separators=(",", ":"), allow_nan=False)
    return text.replace("<", "\\u003c").replace(">", "\\u003e").replace("&", "\\u0026")


def source_hash(text: str) -> str:
    """What a content security policy calls a script or a style of this text."""
    return "sha256-" + base64.b64encode(hashlib.sha256(text.encode("utf-8")).digest()).decode("ascii")


def _check(forecast: Forecast, truth: Scene) -> None:
    if truth.skeleton.names != forecast.skeleton.names:
        raise SceneError(
            f'the truth is on the skeleton "{truth.skeleton.label}" and the forecast on '
            f'"{forecast.skeleton.label}"; give the truth on the skeleton of the history'
        )
    if not np.isclose(truth.fps, forecast.fps):
        raise SceneError(
            f"the truth has {truth.fps:g} frames a second, the forecast {forecast.fps:g}; resample it first"
        )
