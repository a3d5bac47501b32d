from __future__ import annotations

import http.client
import json
import socket
import threading
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from motioncast.core.scene import Scene
from motioncast.core.skeletons import MRT15
from motioncast.errors import InputError
from motioncast.formats.load import load_scene, save_scene
from motioncast.formats.moments_tsv import read_moments
from motioncast.view.annotate_desk import Desk, Motion, beside
from motioncast.view.annotate_server import MAX_BODY_BYTES, AnnotateServer


def reaching(fps: float = 30.0) -> Scene:
    """Two people; the first holds the right hand out after 2 s and after 5 s."""
    clock = np.arange(round(8 * fps)) / fps
    positions = np.zeros((len(clock), 2, len(MRT15), 3), np.float32)
    positions[:, :, MRT15.index("left_hip"), 1], positions[:, :, MRT15.index("right_hip"), 1] = 0.1, -0.1
    for time in (2.0, 5.0):
        positions[:, 0, MRT15.index("right_wrist"), 0] += 0.5 * np.exp(-0.5 * ((clock - time) / 0.3) ** 2)
    return Scene(positions, MRT15, fps, people=("Ann", "Bo"))


@pytest.fixture
def file(tmp_path: Path) -> Path:
    (path,) = save_scene(reaching(), tmp_path / "reach.npz")
    return path


def desk_of(*files: Path) -> Desk:
    return Desk([Motion(file.stem, lambda file=file: load_scene(file), beside(file)) for file in files])


def row(frame: int, source: str = "manual", person: int = 0, note: str = "") -> dict[str, Any]:
    return {"frame": frame, "person": person, "source": source, "note": note}


def test_a_fresh_motion_shows_what_the_rule_finds_and_writes_nothing(file: Path) -> None:
    desk = desk_of(file)
    opened = desk.opened(0)
    assert opened["moments"] == [row(60, "auto"), row(150, "auto")]
    assert opened["shape"] == (240, 2, 15, 3)
    assert [len(extent) for extent in opened["extents"]] == [240, 240]
    assert desk.listed() == [{"name": "reach", "moments": 0, "open": 0, "seen": False}]
    assert not beside(file).exists()


def test_work_goes_on_where_it_ended(file: Path) -> None:
    desk_of(file).keep(0, [row(61, "accepted"), row(150, "rejected", note="a\tstep"), row(200, person=1)])
    again = desk_of(file)
    assert again.opened(0)["moments"] == [row(61, "accepted"), row(150, "rejected", note="a step"), row(200, person=1)]
    assert again.listed() == [{"name": "reach", "moments": 3, "open": 0, "seen": True}]


def test_a_fast_capture_is_shown_thinned_and_kept_in_seconds(tmp_path: Path) -> None:
    (file,) = save_scene(reaching(120), tmp_path / "fast.npz")
    desk = desk_of(file)
    opened = desk.opened(0)
    assert (opened["fps"], opened["shape"][0]) == (30.0, 240)
    desk.keep(0, opened["moments"])
    assert [moment.second for moment in read_moments(beside(file))] == pytest.approx([2.0, 5.0], abs=0.02)


def test_motions_of_one_table_do_not_touch_one_another(file: Path, tmp_path: Path) -> None:
    table = tmp_path / "all.tsv"
    desk = Desk([Motion(name, lambda: load_scene(file), table) for name in ("a", "b")])
    desk.keep(0, [row(3)])
    desk.keep(1, [row(5)])
    desk.keep(0, [row(4)])
    assert [(moment.take, round(30 * moment.second)) for moment in read_moments(table)] == [("a", 4), ("b", 5)]


def test_few_motions_are_held_and_the_last_ones_are_not_read_again(file: Path, tmp_path: Path) -> None:
    read: list[int] = []

    def reader(number: int) -> Callable[[], Scene]:
        return lambda: read.append(number) or load_scene(file)

    desk = Desk([Motion(f"m{number}", reader(number), tmp_path / "t.tsv") for number in range(5)])
    for number in (0, 1, 0, 2, 0, 3, 0, 1):
        desk.opened(number)
    assert read == [0, 1, 2, 3, 1]


@pytest.mark.parametrize(
    "rows",
    [
        {}, [1], [row(-1)], [row(240)], [row(1, person=2)], [row(1, "guess")], [row(1, note="x" * 201)],
        [{"frame": 1}], [row(1) | {"more": 1}], [row(1) | {"frame": 1.5}], [row(1) | {"frame": True}],
    ],
)  # fmt: skip
def test_what_is_no_moment_is_refused_and_changes_nothing(file: Path, rows: Any) -> None:
    desk = desk_of(file)
    desk.keep(0, [row(7)])
    with pytest.raises(InputError, match="no moments of this motion"):
        desk.keep(0, rows)
    assert [moment.second for moment in read_moments(beside(file))] == [0.233]


def test_two_motions_of_one_name_and_table_or_none_at_all_are_told(file: Path) -> None:
    with pytest.raises(InputError, match='two motions are called "reach"'):
        desk_of(file, file)
    with pytest.raises(InputError, match="no motion came"):
        Desk([])
    with pytest.raises(InputError, match="there is no file"):
        beside(file.with_name("nowhere.bvh"))


@pytest.fixture
def server(file: Path) -> Iterator[AnnotateServer]:
    with AnnotateServer(desk_of(file)) as running:
        thread = threading.Thread(target=running.serve_forever, args=(0.01,))
        thread.start()
        yield running
        running.shutdown()
        thread.join()


def ask(
    server: AnnotateServer, method: str, path: str, body: bytes | None = None, headers: dict[str, str] | None = None
) -> tuple[int, bytes]:
    connection = http.client.HTTPConnection("127.0.0.1", server.server_port, timeout=10)
    connection.request(method, path, body, headers or {})
    answer = connection.getresponse()
    found = answer.status, answer.read()
    connection.close()
    return found


def test_the_page_and_the_data_are_behind_the_secret(server: AnnotateServer, file: Path) -> None:
    base = f"/{server.token}/"
    status, page = ask(server, "GET", base)
    assert status == 200
    assert b"connect-src 'self'" in page
    assert b"{{" not in page.split(b"<script>")[0]
    assert json.loads(ask(server, "GET", base + "motions")[1])[0]["name"] == "reach"
    assert json.loads(ask(server, "GET", base + "motions/0")[1])["people"] == ["Ann", "Bo"]
    assert ask(server, "PUT", base + "motions/0", json.dumps([row(9)]).encode())[0] == 200
    assert [moment.second for moment in read_moments(beside(file))] == [0.3]


@pytest.mark.parametrize("method", ["GET", "PUT"])
@pytest.mark.parametrize(
    "path",
    [
        "/", "/motions", "/motions/0", "//", "/favicon.ico", "/{wrong}/", "/{wrong}/motions/0", "/{token}",
        "/{token}/../motions", "/{token}/motions/../../etc/passwd", "/{token}/%2e%2e/secret", "/{token}/motions/0/",
        "/{token}/motions/-1", "/{token}/motions/0?x", "/{token}/reach.npz", "/{token}x/", "http://x/{token}/",
    ],
)  # fmt: skip
def test_everything_else_is_refused(server: AnnotateServer, file: Path, method: str, path: str) -> None:
    wrong = "A" * len(server.token)
    body = b"[]" if method == "PUT" else None
    assert ask(server, method, path.format(token=server.token, wrong=wrong), body)[0] == 403
    assert not beside(file).exists()


def test_bodies_are_limited_and_must_be_moments(server: AnnotateServer, file: Path) -> None:
    path = f"/{server.token}/motions/0"
    assert ask(server, "PUT", path, b"[]", {"Content-Length": str(MAX_BODY_BYTES + 1)})[0] == 413
    assert ask(server, "PUT", path, b"[]", {"Content-Length": "-1"})[0] == 411
    assert ask(server, "PUT", path, b"[")[0] == 400
    assert ask(server, "PUT", path, b"[" * 100_000)[0] == 400
    assert ask(server, "PUT", path, b'[{"frame": 1e999}]')[0] == 422
    assert ask(server, "PUT", f"/{server.token}/motions", b"[]")[0] == 405
    assert ask(server, "PUT", f"/{server.token}/motions/7", b"[]")[0] == 404
    assert ask(server, "POST", path, b"[]")[0] == 501
    assert not beside(file).exists()


def test_it_listens_on_the_loopback_address_alone_with_a_new_secret_each_time(file: Path) -> None:
    with AnnotateServer(desk_of(file)) as one, AnnotateServer(desk_of(file)) as other:
        assert one.server_address[0] == "127.0.0.1"
        assert one.socket.family == socket.AF_INET
        assert len({one.token, other.token}) == 2
        assert one.url == f"http://127.0.0.1:{one.server_port}/{one.token}/"
