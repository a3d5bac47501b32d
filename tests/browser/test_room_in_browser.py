"""The page of a furnished room with several futures: things are drawn and named, futures are told apart."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import chromium
import numpy as np
import pytest

from motioncast.core.card import ModelCard
from motioncast.core.forecast import Forecast
from motioncast.core.scene import Scene
from motioncast.core.scene_object import SceneObject
from motioncast.view.page import write_page

pytestmark = [
    pytest.mark.browser,
    pytest.mark.skipif(chromium.find() is None, reason="needs Chromium"),
]

CARD = ModelCard("sast", "SAST", "forecast", "mrt15", 15, 45, 15.0)
CORNERS = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], np.float32)
FACES = np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])
NAMES = (
    "[...document.querySelectorAll('#names span')].filter(text => !text.hidden).map(text => text.textContent).sort()"
)


@pytest.fixture(scope="module")
def browser() -> Iterator[chromium.Chromium]:
    with chromium.Chromium((1000, 640)) as opened:
        yield opened


def thing(name: str, category: str, shape: str, size: tuple, position: tuple, role: str = "") -> SceneObject:
    return SceneObject(name, category, shape, np.array(size), np.array(position), role=role)


def room_around(walkers: Scene, *more: SceneObject) -> Scene:
    """The first 20 frames, in a room; bea comes in after ten of them."""
    way = np.linspace((-1.5, -1.5, 0.1), (1.5, -1.5, 0.1), 20)
    things = (
        thing("the table", "table", "box", (1.2, 0.7, 0.7), (0, 2, 0.35), role="decoy"),
        thing("the stool", "sittable", "cylinder", (0.4, 0.4, 0.5), (-2, 2, 0.25), role="caused"),
        SceneObject("the rock", "trash", "mesh", position=np.array([2, 1.5, 0]), points=CORNERS, faces=FACES),
        SceneObject("the ball", "kettle", "cylinder", np.full(3, 0.2), way),
        *more,
    )
    observed = walkers.observed[:20].copy()
    observed[:10, 1] = False
    return replace(walkers[:20], objects=things, observed=observed)


def write(walkers: Scene, folder: Path, *more: SceneObject) -> Path:
    ahead = walkers.positions[20:]
    samples = np.stack([ahead, ahead + np.float32([0, 0.6, 0]), ahead - np.float32([0, 0.6, 0])])
    weights = np.array([0.5, 0.3, 0.2])
    write_page(Forecast(samples, room_around(walkers, *more), walkers.people, CARD, weights), folder / "room.html")
    return folder / "room.html"


@pytest.fixture
def page(browser: chromium.Chromium, walkers: Scene, tmp_path: Path) -> Path:
    browser.events.clear()
    return write(walkers, tmp_path)


def test_things_are_drawn_and_named_and_can_be_switched_off(browser: chromium.Chromium, page: Path) -> None:
    browser.open(page, "t=0.5")
    assert browser.evaluate(NAMES) == ["the ball", "the rock", "the stool", "the table"]
    kinds = "[...document.querySelectorAll('#kinds li')].map(item => item.textContent)"
    assert browser.evaluate(kinds) == ["table", "seat", "bin", "kettle"]
    furnished = browser.picture()
    browser.key("i")
    assert browser.evaluate(NAMES) == []
    unnamed = browser.picture()
    browser.key("o")
    assert len({furnished, unnamed, browser.picture()}) == 3
    thrown = [event for event in browser.events if event.get("method") == "Runtime.exceptionThrown"]
    assert thrown == []
    assert "decoy" not in page.read_text(encoding="utf-8").split("<script>")[0]


def test_a_thing_that_moves_takes_its_name_along_and_stays_where_it_was_last_seen(
    browser: chromium.Chromium, page: Path
) -> None:
    ball = "[...document.querySelectorAll('#names span')].find(text => text.textContent === 'the ball').style.transform"
    browser.open(page, "t=-0.6&camera=free")
    places = []
    for time in (-0.6, -0.3, 0, 0.5):
        browser.evaluate(f"window.__mc.seek({time})")
        browser.frame()
        places.append(browser.evaluate(ball))
    assert len(set(places)) == 3
    assert places[2] == places[3]


def test_a_wall_before_people_does_not_hide_them(browser: chromium.Chromium, walkers: Scene, tmp_path: Path) -> None:
    colored = (
        "(() => { window.__mc.colors(); const from = document.getElementById('stage');"
        " const to = document.createElement('canvas'); [to.width, to.height] = [from.width, from.height];"
        " const pen = to.getContext('2d'); pen.drawImage(from, 0, 0);"
        " const data = pen.getImageData(0, 0, to.width, to.height).data; let found = 0;"
        " for (let i = 0; i < data.length; i += 4)"
        " found += Math.max(data[i], data[i + 1], data[i + 2]) - Math.min(data[i], data[i + 1], data[i + 2]) > 90;"
        " return found; })()"
    )
    for category in ("occluder", "cupboard"):  # glass, and a solid that turns to glass
        around = [
            thing(f"{category} {x} {y}", category, "box", (5 if y else 0.1, 5 if x else 0.1, 2.5), (x, y, 1.25))
            for x, y in ((3, 0), (-3, 0), (0, 3), (0, -3))
        ]
        browser.open(write(walkers, tmp_path, *around), "t=0.5&layers=forecast,things")
        walled = browser.evaluate(colored)
        browser.key("o")
        alone = browser.evaluate(colored)
        assert isinstance(walled, int)
        assert isinstance(alone, int)
        assert walled > 0.8 * alone > 1000, category


def test_one_future_or_another_or_all_at_once(browser: chromium.Chromium, page: Path) -> None:
    browser.open(page, "t=1")
    pressed = "document.querySelector('#futures [aria-pressed=true]').textContent"
    buttons = "[...document.querySelectorAll('#futures button')].map(button => button.textContent)"
    assert browser.evaluate(buttons) == ["150 %", "230 %", "320 %", "All"]
    assert browser.evaluate(pressed) == "All"
    pictures = [browser.picture()]
    for shown in ("150 %", "230 %", "320 %"):
        browser.key("v")
        assert browser.evaluate(pressed) == shown
        pictures.append(browser.picture())
    assert len(set(pictures)) == 4
    browser.key("a")
    browser.evaluate("document.activeElement.blur()")
    assert browser.picture() == pictures[0]
    browser.evaluate("document.querySelectorAll('#futures button')[1].click()")
    assert browser.evaluate("window.__mc.state.future") == "2"


def test_what_was_seen_is_the_same_in_every_future(browser: chromium.Chromium, page: Path) -> None:
    scene = (0, 130, 640, 400)
    pictures = set()
    for future in ("1", "3"):
        browser.open(page, f"t=-0.2&layers=seen,things&future={future}")
        pictures.add(browser.picture(scene))
    assert len(pictures) == 1


def test_who_comes_and_goes_is_read_on_the_time_axis(browser: chromium.Chromium, page: Path) -> None:
    browser.open(page, "t=-0.6")
    away = "[...document.querySelectorAll('#people li')].map(item => item.classList.contains('away'))"
    assert browser.evaluate(away) == [False, True]
    browser.evaluate("window.__mc.seek(0.5)")
    assert browser.evaluate(away) == [False, False]
    lanes = str(browser.evaluate("document.getElementById('time').style.getPropertyValue('--lanes')")).split("linear")
    assert "transparent 0.00%" in lanes[1], "ada is there from the first frame on"
    begin = 100 * 9.5 / 59  # half a frame before the eleventh of sixty
    assert f"var(--seen)) {begin:.2f}%" in lanes[2]


def test_a_phone_shows_the_room_too(browser: chromium.Chromium, page: Path) -> None:
    browser.resize((390, 844), mobile=True)
    browser.open(page, "t=0.5")
    assert browser.evaluate("document.documentElement.scrollWidth") == 390
    assert len(browser.evaluate(NAMES)) >= 2  # pyright: ignore[reportArgumentType]
    browser.evaluate("document.getElementById('more').click()")
    box = browser.evaluate("document.getElementById('options').getBoundingClientRect().toJSON()")
    assert isinstance(box, dict)
    assert box["bottom"] < 844
    browser.resize((1000, 640))
