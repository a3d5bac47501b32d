"""The page of ``motioncast annotate``, served to one's own browser and to nobody else.

The server listens on the loopback address alone. Its address holds a secret of 128 bits that is drawn anew each time;
a request without it is refused before anything else is looked at. No path of a request is ever a path of a file: there
are five addresses, and what they answer is in memory.
"""

from __future__ import annotations

import json
import re
import secrets
import threading
from collections.abc import Callable
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from importlib.resources import files
from typing import Any

from motioncast.errors import MotioncastError
from motioncast.view.annotate_desk import Desk
from motioncast.view.page import filled, source_hash

MAX_BODY_BYTES = 1 << 20
"""Largest request: 1 MiB, thousands of moments."""

PATIENCE_S = 30.0
"""A request that sends nothing for so long is dropped."""

ROUTE = re.compile(r"/([\w-]{22})/(|motions|motions/(\d{1,6}))")


class AnnotateServer(ThreadingHTTPServer):
    """Serves a desk; ``url`` is where.

    Args:
        desk: What is annotated.
        port: Port on the loopback address; 0 takes a free one.
    """

    daemon_threads = True
    allow_reuse_address = True

    def __init__(self, desk: Desk, port: int = 0) -> None:
        super().__init__(("127.0.0.1", port), _Handler)
        self.desk, self.turn = desk, threading.Lock()
        self.token = secrets.token_urlsafe(16)
        self.page = page()

    @property
    def url(self) -> str:
        """The address of the page, secret and all."""
        return f"http://127.0.0.1:{self.server_port}/{self.token}/"


def page() -> bytes:
    """The page: one file that may ask its own server and nobody else."""
    source = files("motioncast.view")
    style, script = (source.joinpath(f"annotate.{kind}").read_text(encoding="utf-8") for kind in ("css", "js"))
    policy = (
        f"default-src 'none'; script-src '{source_hash(script)}'; style-src '{source_hash(style)}'; img-src data:; "
        "connect-src 'self'; base-uri 'none'; form-action 'none'"
    )
    template = source.joinpath("annotate.html").read_text(encoding="utf-8")
    return filled(template, {"policy": policy, "style": style, "script": script}).encode()


class _Handler(BaseHTTPRequestHandler):
    server: AnnotateServer  # pyright: ignore[reportIncompatibleVariableOverride]
    timeout = PATIENCE_S
    server_version, sys_version = "motioncast", ""

    def do_GET(self) -> None:
        """Answer with the page, the list of motions, or one motion."""
        route = self._route()
        if route is None:
            return
        if route[2] == "":
            self._send(200, self.server.page, "text/html; charset=utf-8")
        elif route[3] is None:
            self._answer(self.server.desk.listed)
        else:
            self._answer(lambda: self.server.desk.opened(int(route[3])))

    def do_PUT(self) -> None:
        """Keep the moments of a motion."""
        route = self._route()
        if route is None:
            return
        length = self.headers.get("Content-Length", "")
        if route[3] is None:
            self._refuse(405, "this address is only read")
        elif not length.isdecimal():
            self._refuse(411, "the request has no length")
        elif int(length) > MAX_BODY_BYTES:
            self._refuse(413, f"the request has {length} bytes; at most {MAX_BODY_BYTES} are read")
        else:
            body = self.rfile.read(int(length))
            try:
                rows = json.loads(body)
            except (ValueError, RecursionError):
                self._refuse(400, "the request is not JSON")
                return
            self._answer(lambda: self.server.desk.keep(int(route[3]), rows))

    def _route(self) -> re.Match[str] | None:
        """What is asked for; whoever does not know the secret gets the same answer whatever they ask."""
        route = ROUTE.fullmatch(self.path)
        if route is None or not secrets.compare_digest(route[1], self.server.token):
            self._refuse(403, "this is not the address that motioncast annotate printed")
            return None
        if route[3] is not None and int(route[3]) >= len(self.server.desk.motions):
            self._refuse(404, f"there is no motion {route[3]}")
            return None
        return route

    def _answer(self, act: Callable[[], Any]) -> None:
        """What an act gives, as JSON; the desk is used by one request at a time."""
        try:
            with self.server.turn:
                body = json.dumps(act(), separators=(",", ":")).encode()
        except MotioncastError as error:
            self._refuse(422, str(error))
        else:
            self._send(200, body, "application/json")

    def _refuse(self, status: int, why: str) -> None:
        self.close_connection = True  # a body that was not read must not become the next request
        self._send(status, why.encode(), "text/plain; charset=utf-8")

    def _send(self, status: int, body: bytes, kind: str) -> None:
        self.send_response(status)
        for name, value in (
            ("Content-Type", kind),
            ("Content-Length", str(len(body))),
            ("Cache-Control", "no-store"),
            ("X-Content-Type-Options", "nosniff"),
            ("Referrer-Policy", "no-referrer"),
            ("Cross-Origin-Resource-Policy", "same-origin"),
        ):
            self.send_header(name, value)
        self.end_headers()
        self.wfile.write(body)

    def log_message(self, format: str, *args: Any) -> None:
        """Say nothing: a line a request would hide what the command printed."""
