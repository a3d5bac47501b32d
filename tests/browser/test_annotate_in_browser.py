"""The page of annotate in a real browser: keys change moments, and every change is in the table at once."""

from __future__ import annotations

import threading
import time
from collections.abc import Iterator
from pathlib import Path

import chromium
import numpy as np
import pytest

from motioncast.core.scene import Scene
from motioncast.core.skeletons import MRT15
from motioncast.formats.moments_tsv import Moment, read_moments
from motioncast.view.annotate_desk import Desk, Motion
from motioncast.view.annotate_server import AnnotateServer

pytestmark = [
    pytest.mark.browser,
    pytest.mark.skipif(chromium.find() is None, reason="needs Chromium"),
]


def reaching(pose: np.ndarray, times: tuple[float, ...]) -> Scene:
    clock = np.arange(240) / 30
    positions = np.tile(pose, (240, 1, 1, 1)).astype(np.float32)
    for moment in times:
        positions[:, 0, MRT15.index("right_wrist"), 2] += 0.8 * np.exp(-0.5 * ((clock - moment) / 0.3) ** 2)
    return Scene(positions, MRT15, 30, people=("ada",))


@pytest.fixture
def table(walkers: Scene, tmp_path: Path) -> Path:
    return tmp_path / "moments.tsv"


@pytest.fixture
def browser(walkers: Scene, table: Path) -> Iterator[chromium.Chromium]:
    pose = walkers.positions[0, 0]
    motions = [Motion(name, lambda times=times: reaching(pose, times), table)
               for name, times in (("first", (2.0, 5.0)), ("second", (4.0,)))]  # fmt: skip
    with AnnotateServer(Desk(motions)) as server, chromium.Chromium((1000, 640)) as opened:
        thread = threading.Thread(target=server.serve_forever, args=(0.01,))
        thread.start()
        opened.call("Page.navigate", url=server.url)
        wait_for(opened, "Boolean(window.__annotate && window.__annotate.ready)")
        yield opened
        assert complaints(opened) == []
        server.shutdown()
        thread.join()


def wait_for(browser: chromium.Chromium, condition: str) -> None:
    until = time.monotonic() + 30
    while not browser.evaluate(condition):
        assert time.monotonic() < until, condition
        time.sleep(0.02)


def complaints(browser: chromium.Chromium) -> list[dict]:
    kinds = ("Runtime.exceptionThrown", "Runtime.consoleAPICalled")
    return [event["params"] for event in browser.events if event.get("method") in kinds]


def press(browser: chromium.Chromium, *keys: str) -> None:
    for key in keys:
        browser.key(key)
    browser.evaluate("window.__annotate.saving()")


def rows(table: Path) -> list[tuple[str, int, str]]:
    return [(moment.take, round(30 * moment.second), moment.source) for moment in read_moments(table)]


def frame(browser: chromium.Chromium) -> object:
    return browser.evaluate("window.__annotate.frame()")


def test_keys_walk_accept_move_reject_insert_and_undo(browser: chromium.Chromium, table: Path) -> None:
    assert frame(browser) == 60
    assert not table.exists()
    press(browser, "a")
    assert rows(table) == [("first", 60, "accepted"), ("first", 150, "auto")]
    assert frame(browser) == 150
    press(browser, "ArrowLeft", "ArrowLeft", "m")
    assert rows(table)[1] == ("first", 148, "manual")
    press(browser, "u")
    assert rows(table)[1] == ("first", 150, "auto")
    press(browser, "n", "x")
    assert rows(table)[1] == ("first", 150, "rejected")
    press(browser, "Home", "i")
    assert rows(table)[0] == ("first", 0, "manual")
    press(browser, "x")
    assert rows(table) == [("first", 60, "accepted"), ("first", 150, "rejected")]
    press(browser, "End", "p")
    assert frame(browser) == 150


def test_enter_goes_to_the_next_motion_and_back_comes_the_one_before(browser: chromium.Chromium, table: Path) -> None:
    press(browser, "A", "Enter")
    wait_for(browser, "window.__annotate.name() === 'second'")
    assert frame(browser) == 120
    assert [row[2] for row in rows(table)] == ["accepted", "accepted"]
    press(browser, "Backspace")
    wait_for(browser, "window.__annotate.name() === 'first'")


def test_people_and_timeline_are_drawn(browser: chromium.Chromium) -> None:
    stage, line = (260, 80, 460, 380), (30, 510, 900, 100)
    before = browser.picture(stage), browser.picture(line)
    press(browser, "Home")
    after = browser.picture(stage), browser.picture(line)
    assert before[0] != after[0]
    assert before[1] != after[1]
    assert browser.evaluate("document.querySelectorAll('.marks line').length") == 2
    assert browser.evaluate("document.getElementById('failed').hidden") is True


def test_it_plays(browser: chromium.Chromium) -> None:
    press(browser, "Home", " ")
    wait_for(browser, "window.__annotate.frame() > 5")
    press(browser, " ")
    stopped = frame(browser)
    time.sleep(0.1)
    assert frame(browser) == stopped


def test_a_change_that_cannot_be_kept_is_told(browser: chromium.Chromium, table: Path) -> None:
    table.mkdir()
    press(browser, "a")
    assert browser.evaluate("document.getElementById('failed').hidden") is False
    assert "it is a folder" in str(browser.evaluate("document.getElementById('failed').textContent"))


def test_the_table_is_read_by_others(browser: chromium.Chromium, table: Path) -> None:
    press(browser, "a")
    first = read_moments(table)[0]
    assert first == Moment("first", "ada", 2.0, first.extent_m, "accepted")
    assert first.extent_m > 0.3
