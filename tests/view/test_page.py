"""The page as a file: whole, escaped, exact to half a millimetre, closed to the outside."""

from __future__ import annotations

import base64
import hashlib
import re
import zlib
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from pages import CARD, forecast_of, read

from motioncast.core.forecast import Forecast
from motioncast.core.scene import Scene
from motioncast.core.skeletons import MRT15
from motioncast.errors import OutputError, SceneError
from motioncast.view.contents import HISTORY_S
from motioncast.view.curves import joint_errors
from motioncast.view.packing import pack
from motioncast.view.page import page_html, write_page


def test_positions_are_exact_to_half_a_millimetre(walkers: Scene) -> None:
    forecast = forecast_of(walkers, 30)
    about, arrays = read(page_html(forecast, truth=walkers[30:]))
    exact = np.concatenate([walkers.positions[:30], forecast.best])
    assert np.abs(arrays["main/positions"] + about["origin"] - exact).max() <= 0.5e-3 + 1e-6
    assert np.abs(arrays["truth/positions"][1:] + about["origin"] - walkers.positions[30:]).max() <= 0.5e-3 + 1e-6
    assert (about["now"], about["frames"], about["truth"]) == (30, 60, 31)


def test_text_of_the_user_cannot_leave_its_place(walkers: Scene) -> None:
    evil = "</script><script>alert(1)</script><!-- & \u2028"
    forecast = forecast_of(replace(walkers, people=(evil, "b")), 30, warnings=(evil,))
    text = page_html(forecast, title=evil, curves={evil: (np.array([0.1]), np.array([0.2]))})
    assert "<script>alert" not in text
    about, _ = read(text)
    assert about["title"] == about["people"][0]["id"] == about["warnings"][0] == evil
    assert text.count("<script") == page_html(forecast_of(walkers, 30)).count("<script")


def test_text_that_looks_like_a_placeholder_stays_text(walkers: Scene) -> None:
    about, _ = read(page_html(forecast_of(walkers, 30), title="{{script}} {{numbers}}"))
    assert about["title"] == "{{script}} {{numbers}}"


def test_the_policy_allows_this_script_and_style_alone(walkers: Scene) -> None:
    text = page_html(forecast_of(walkers, 30))
    policy = re.search(r'Content-Security-Policy" content="([^"]*)"', text)[1]  # pyright: ignore[reportOptionalSubscript]
    assert policy.startswith("default-src 'none'")
    assert "unsafe" not in policy
    for tag in ("script", "style"):
        body = re.search(rf"<{tag}>(.*?)</{tag}>", text, re.DOTALL)[1]  # pyright: ignore[reportOptionalSubscript]
        digest = base64.b64encode(hashlib.sha256(body.encode()).digest()).decode()
        assert f"{tag}-src 'sha256-{digest}'" in policy
    assert not re.search(r'(src|href)="(?!data:)', text)


def test_the_notice_of_three_js_is_kept(walkers: Scene) -> None:
    text = page_html(forecast_of(walkers, 30))
    assert "three.js authors" in text
    assert "Permission is hereby granted" in text


def test_three_people_for_250_frames_stay_below_a_megabyte() -> None:
    rng = np.random.default_rng(0)
    time = np.arange(250)[:, None, None, None] / 30
    start, phase = rng.normal(size=(1, 3, 22, 3)), rng.uniform(0, 6, (1, 3, 22, 3))
    from motioncast.core.skeletons import SMPL22

    positions = start + 0.3 * np.sin(2 * np.pi * time + phase) + [1.2, 0, 0] * time
    scene = Scene(positions, SMPL22, 30)
    forecast = Forecast(scene.positions[None, 100:], scene[:100], scene.people, CARD)
    assert len(page_html(forecast, truth=scene[100:]).encode()) < 1_000_000


def test_ten_seconds_of_three_people_in_four_futures_stay_below_a_megabyte_and_a_half() -> None:
    from motioncast.core.skeletons import SMPL22

    rng = np.random.default_rng(0)
    time = np.arange(275)[:, None, None, None] / 25
    start, phase = rng.normal(size=(4, 1, 3, 22, 3)), rng.uniform(0, 6, (4, 1, 3, 22, 3))
    samples = start + 0.3 * np.sin(2 * np.pi * time + phase) + [1.2, 0, 0] * time
    history = Scene(samples[0, :25], SMPL22, 25)
    forecast = Forecast(samples[:, 25:], history, history.people, replace(CARD, fps=25.0))
    assert len(page_html(forecast).encode()) < 1_500_000


def test_a_minute_is_shown_with_fewer_frames_a_second(walkers: Scene) -> None:
    ahead = np.resize(walkers.positions, (1, 1800, 2, 15, 3))
    about, arrays = read(page_html(Forecast(ahead, walkers, walkers.people, CARD)))
    assert (about["fps"], about["frames"] - about["now"]) == (15.0, 900)
    shown = arrays["main/positions"][-1] + about["origin"]
    np.testing.assert_allclose(shown, ahead[0, -1], atol=1e-3)


def test_a_fast_capture_is_thinned_around_now(walkers: Scene) -> None:
    fast = Scene(np.repeat(walkers.positions, 4, 0), MRT15, 120.0)
    about, arrays = read(page_html(forecast_of(fast, 120)))
    assert (about["fps"], about["now"], about["frames"]) == (30.0, 30, 60)
    last_seen = arrays["main/positions"][29] + about["origin"]
    np.testing.assert_allclose(last_seen, fast.positions[119], atol=1e-3)


def test_a_long_history_is_cut(walkers: Scene) -> None:
    long = Scene(np.concatenate([walkers.positions] * 10), MRT15, 30.0)
    about, _ = read(page_html(forecast_of(long, 570)))
    assert about["now"] == HISTORY_S * 30


def test_the_most_probable_sample_leads(walkers: Scene) -> None:
    forecast = forecast_of(walkers, 30, samples=3, weights=np.array([0.2, 0.7, 0.1]))
    about, arrays = read(page_html(forecast))
    assert about["weights"] == pytest.approx([0.7, 0.2, 0.1])
    for name, sample in (("main", 1), ("sample/0", 0), ("sample/1", 2)):
        shown = arrays[f"{name}/positions"][-30:] + about["origin"]
        assert len(arrays[f"{name}/rotations"]) == len(arrays[f"{name}/positions"]), "every future can carry bodies"
        np.testing.assert_allclose(shown, forecast.samples[sample], atol=1e-3)


def test_people_who_come_and_go_are_shown_when_seen(walkers: Scene) -> None:
    observed = np.ones((30, 2, 15), bool)
    observed[20:, 1] = False
    history = replace(walkers[:30], observed=observed)
    forecast = Forecast(walkers.positions[None, 30:, :1], history, ("ada",), CARD)
    truth = walkers[30:45].select(["ada"])
    about, arrays = read(page_html(forecast, truth))
    seen = arrays["main/observed"].all(-1)
    assert seen[:, 0].all()
    assert seen[:20, 1].all()
    assert not seen[20:, 1].any()
    assert about["truth"] == 16


def test_a_skeleton_without_arms_is_shown_as_bones(walkers: Scene) -> None:
    legs = replace(MRT15, landmarks=("",) * 15)
    about, arrays = read(page_html(forecast_of(replace(walkers, skeleton=legs), 30)))
    assert about["bones"] == 0
    assert not any(name.startswith("body/") for name in arrays)


def test_the_error_curve_is_the_mean_over_known_joints(walkers: Scene) -> None:
    carried = np.zeros(15, bool)
    carried[3] = True
    forecast = forecast_of(walkers, 30, carried=carried)
    times, errors = joint_errors(forecast, walkers[30:50])
    assert len(times) == 20
    assert times[0] == pytest.approx(1 / 30)
    np.testing.assert_allclose(errors, 0.1, atol=1e-6)
    about, _ = read(page_html(forecast, walkers[30:50], curves={"standing still": (times, errors * 3)}))
    assert [curve["kind"] for curve in about["curves"]] == ["model", "baseline"]
    assert about["curves"][1]["errors"][0] == pytest.approx(0.3, abs=1e-3)


def test_without_the_truth_the_radii_are_drawn(walkers: Scene) -> None:
    about, _ = read(page_html(forecast_of(walkers, 30)))
    assert [curve["kind"] for curve in about["curves"]] == ["radius", "radius"]


def test_a_truth_of_another_skeleton_or_rate_is_refused(walkers: Scene) -> None:
    forecast = forecast_of(walkers, 30)
    with pytest.raises(SceneError, match="resample"):
        page_html(forecast, truth=replace(walkers[30:], fps=25.0))
    renamed = replace(MRT15, names=tuple(f"x{name}" for name in MRT15.names))
    with pytest.raises(SceneError, match="skeleton of the history"):
        page_html(forecast, truth=replace(walkers[30:], skeleton=renamed))


def test_packing_holds_every_step_of_16_bits() -> None:
    array = np.array([[32767], [-32768], [0], [-1]], np.int16)
    raw = np.frombuffer(zlib.decompress(pack([array])), np.uint8).astype(int)
    words = raw[:4] + 256 * raw[4:]
    steps = np.where(words % 2, -(words + 1) // 2, words // 2)
    np.testing.assert_array_equal(np.cumsum(np.cumsum(steps)).astype(np.int16), array[:, 0])


def test_the_file_is_whole_or_not_there(walkers: Scene, tmp_path: Path) -> None:
    target = tmp_path / "page.html"
    write_page(forecast_of(walkers, 30), target)
    assert target.read_text(encoding="utf-8") == page_html(forecast_of(walkers, 30))
    assert [path.name for path in tmp_path.iterdir()] == ["page.html"]
    with pytest.raises(OutputError):
        write_page(forecast_of(walkers, 30), tmp_path / "missing" / "page.html")
