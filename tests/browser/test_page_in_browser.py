"""The page in a real browser: it is drawn, it obeys, it asks nobody for anything."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import chromium
import numpy as np
import pytest

from motioncast.core.card import ModelCard
from motioncast.core.forecast import Forecast
from motioncast.core.scene import Scene
from motioncast.core.skeletons import MRT15
from motioncast.view.page import write_page

pytestmark = [
    pytest.mark.browser,
    pytest.mark.skipif(chromium.find() is None, reason="needs Chromium"),
]

SCENE = (100, 160, 600, 360)
"""A part of the window that nothing covers: left, top, width, height."""


@pytest.fixture(scope="module")
def browser() -> Iterator[chromium.Chromium]:
    with chromium.Chromium() as opened:
        yield opened


@pytest.fixture
def page(browser: chromium.Chromium, walkers: Scene, tmp_path: Path) -> Path:
    """A page with everything in it: three samples, radii, a truth that is 20 cm off, a baseline."""
    truth = walkers[20:]
    ahead = truth.positions + np.array([0.0, 0.2, 0.0], np.float32)
    samples = np.stack([ahead, ahead + np.float32(0.1), ahead - np.float32([0.1, 0.1, 0])])
    radius = {"0.5": np.full((40, 15), 0.15), "0.9": np.full((40, 15), 0.4)}
    card = ModelCard("somoformer-fast", "SoMoFormer", "forecast", "mrt15", 15, 45, 15.0)
    forecast = Forecast(samples, walkers[:20], walkers.people, card, radius_m=radius)
    target = tmp_path / "page.html"
    still = (forecast.times_s, forecast.times_s * 0.8)
    write_page(forecast, target, truth, "Two <walkers>", {"standing still": still})
    browser.events.clear()
    browser.resize((1000, 640))
    return target


def complaints(browser: chromium.Chromium) -> list[dict]:
    """What the page threw or printed; notes of the graphics driver are not the page's."""
    return [
        event["params"]
        for event in browser.events
        if event.get("method") in ("Runtime.exceptionThrown", "Runtime.consoleAPICalled")
        or (event.get("method") == "Log.entryAdded" and event["params"]["entry"]["source"] != "rendering")
    ]


def test_it_is_drawn_and_asks_for_nothing_but_itself(browser: chromium.Chromium, page: Path) -> None:
    browser.open(page, "t=0.5")
    assert browser.evaluate("window.__mc.colors()") > 50  # pyright: ignore[reportOperatorIssue]
    requests = [
        event["params"]["request"]["url"]
        for event in browser.events
        if event.get("method") == "Network.requestWillBeSent"
    ]
    outside = [url for url in requests if not url.startswith((page.as_uri(), "about:", "data:", "blob:"))]
    assert outside == []
    assert complaints(browser) == []
    assert browser.evaluate("document.getElementById('title').textContent") == "Two <walkers>"
    assert browser.evaluate("document.getElementById('failed').hidden") is True


@pytest.mark.parametrize("key", ["f", "t", "s", "p", "w", "b", "e", "2", "3"])
def test_a_key_changes_the_picture_and_changes_it_back(browser: chromium.Chromium, page: Path, key: str) -> None:
    browser.open(page, "t=0.6")
    before = browser.picture(SCENE)
    browser.key(key)
    assert browser.picture(SCENE) != before
    if key in "ftspw":
        browser.key(key)
        browser.evaluate("document.activeElement.blur()")
        assert browser.picture(SCENE) == before
    assert complaints(browser) == []


def test_the_playhead_obeys_keys_and_stays_within_the_scene(browser: chromium.Chromium, page: Path) -> None:
    browser.open(page, "t=0")

    def time() -> float:
        return round(float(browser.evaluate("window.__mc.state.time")), 3)  # pyright: ignore[reportArgumentType]

    for key, expected in (
        ("ArrowRight", 1 / 30), ("ArrowLeft", 0), ("End", 40 / 30), ("ArrowRight", 40 / 30),
        ("Home", -19 / 30), ("ArrowLeft", -19 / 30), ("n", 0),
    ):  # fmt: skip
        browser.key(key)
        assert time() == pytest.approx(expected, abs=2e-3), key
    assert browser.evaluate("document.getElementById('clock').textContent") == "now"


def test_it_plays(browser: chromium.Chromium, page: Path) -> None:
    browser.open(page, "t=0")
    browser.key(" ")
    moved = (
        "new Promise(done => { const look = () => "
        "window.__mc.state.time > 0.1 ? done(1) : setTimeout(look, 20); look() })"
    )
    assert browser.evaluate(moved) == 1
    browser.key(" ")
    assert browser.evaluate("window.__mc.state.playing") is False


def test_the_address_keeps_the_view(browser: chromium.Chromium, page: Path) -> None:
    browser.open(page, "t=0.5&camera=top&look=bones&doubt=joints&layers=forecast&future=2")
    state = "(({camera, look, doubt, layers, future}) => [camera, look, doubt, [...layers], future])(window.__mc.state)"
    assert browser.evaluate(state) == ["top", "bones", "joints", ["forecast"], "2"]
    browser.open(page, "t=nonsense&camera=../../&layers=&future=99")
    assert browser.evaluate("[window.__mc.state.camera, window.__mc.state.future]") == ["follow", "all"]
    assert complaints(browser) == []


def test_a_switch_says_whether_it_is_on(browser: chromium.Chromium, page: Path) -> None:
    browser.open(page, "t=0.5")

    def switch(layer: str) -> object:
        found = f"document.querySelector('[role=switch][data-layer={layer}]')"
        return browser.evaluate(f"[{found}.getAttribute('aria-checked'), {found}.textContent]")

    assert switch("paths") == ["true", "On"]
    assert switch("stood") == ["false", "Off"], "nobody asked for figures of the past beside the forecast"
    caption = "document.getElementById('caption').textContent"
    assert "stood" not in str(browser.evaluate(caption))
    browser.evaluate("document.querySelector('[role=switch][data-layer=stood]').click()")
    browser.key("p")
    assert [switch("paths"), switch("stood")] == [["false", "Off"], ["true", "On"]]
    assert "where they stood at now" in str(browser.evaluate(caption))


def test_the_card_says_where_the_recording_ends(browser: chromium.Chromium, walkers: Scene, tmp_path: Path) -> None:
    card = ModelCard("somoformer-fast", "SoMoFormer", "forecast", "mrt15", 15, 45, 15.0)
    ahead = walkers.positions[None, 20:] + np.array([0, 1.04, 0], np.float32)
    write_page(Forecast(ahead, walkers[:20], walkers.people, card), tmp_path / "short.html", walkers[20:44])
    browser.open(tmp_path / "short.html", "t=0.5")
    value = "document.querySelector('#errors b').textContent"
    assert browser.evaluate(value) == "104 cm"
    browser.evaluate("window.__mc.seek(1.2)")
    assert browser.evaluate(value) == "your recording ends at +0.8 s"
    browser.evaluate("window.__mc.seek(-0.2)")
    assert browser.evaluate(value) == "–"


def test_the_truth_is_drawn_beside_the_forecast_and_not_across_it(
    browser: chromium.Chromium, walkers: Scene, tmp_path: Path
) -> None:
    card = ModelCard("somoformer-fast", "SoMoFormer", "forecast", "mrt15", 15, 45, 15.0)
    write_page(Forecast(walkers.positions[None, 20:], walkers[:20], walkers.people, card), tmp_path / "exact.html",
               walkers[20:])  # fmt: skip
    browser.open(tmp_path / "exact.html", "t=0.5&layers=forecast,truth")
    colored = (
        "(() => { window.__mc.colors();"
        " const from = document.getElementById('stage'), to = document.createElement('canvas');"
        " [to.width, to.height] = [from.width, from.height];"
        " const pen = to.getContext('2d'); pen.drawImage(from, 0, 0);"
        " const data = pen.getImageData(0, 0, to.width, to.height).data; const found = [];"
        " for (let i = 0; i < data.length; i += 4)"
        " if (Math.max(data[i], data[i + 1], data[i + 2]) - Math.min(data[i], data[i + 1], data[i + 2]) > 90)"
        " found.push(`${i}:${data[i]},${data[i + 1]},${data[i + 2]}`); return found; })()"
    )
    both = browser.evaluate(colored)
    browser.key("t")
    alone = browser.evaluate(colored)
    assert isinstance(both, list)
    assert isinstance(alone, list)
    assert len(alone) > 500
    assert len(set(both) ^ set(alone)) < 0.02 * len(alone)


def test_help_opens_and_closes(browser: chromium.Chromium, page: Path) -> None:
    browser.open(page, "t=0.5")
    browser.key("?")
    assert browser.evaluate("document.getElementById('help').open") is True
    browser.evaluate("document.getElementById('close').click()")
    assert browser.evaluate("document.getElementById('help').open") is False


def test_a_phone_shows_all_of_it(browser: chromium.Chromium, page: Path) -> None:
    browser.resize((390, 844), mobile=True)
    browser.open(page, "t=0.5")
    wide = browser.evaluate("document.documentElement.scrollWidth")
    assert wide == 390
    for part in ("play", "time", "more", "clock"):
        box = browser.evaluate(f"document.getElementById('{part}').getBoundingClientRect().toJSON()")
        assert isinstance(box, dict)
        assert box["left"] >= 0
        assert box["right"] <= 390
        assert box["bottom"] <= 844
    chart = browser.evaluate("document.querySelector('#errors > svg').getBoundingClientRect().width")
    label = browser.evaluate("document.querySelector('#errors text').getBoundingClientRect().height")
    assert isinstance(chart, float | int)
    assert isinstance(label, float | int)
    assert chart > 320
    assert label > 11
    overlap = "document.getElementById('now').getBoundingClientRect().bottom <= errors.getBoundingClientRect().top"
    assert browser.evaluate(overlap) is True
    assert browser.evaluate("getComputedStyle(document.getElementById('options')).display") == "none"
    browser.evaluate("document.getElementById('more').click()")
    assert browser.evaluate("getComputedStyle(document.getElementById('options')).display") == "grid"
    assert browser.evaluate("window.__mc.colors()") > 50  # pyright: ignore[reportOperatorIssue]


def test_people_who_cannot_carry_a_body_are_bones(browser: chromium.Chromium, walkers: Scene, tmp_path: Path) -> None:
    from dataclasses import replace

    plain = replace(walkers, skeleton=replace(MRT15, landmarks=("",) * 15))
    card = ModelCard("somoformer-fast", "SoMoFormer", "forecast", "mrt15", 15, 45, 15.0)
    write_page(Forecast(plain.positions[None, 20:], plain[:20], plain.people, card), tmp_path / "bones.html")
    browser.events.clear()
    browser.open(tmp_path / "bones.html", "t=0.5")
    assert browser.evaluate("window.__mc.colors()") > 20  # pyright: ignore[reportOperatorIssue]
    assert browser.evaluate("document.getElementById('looks').hidden") is True
    assert complaints(browser) == []
