"""Damaged files of every kind: one sentence of ours comes out, never anything else, and never a half scene."""

from __future__ import annotations

import json
import zipfile
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from motioncast.core.card import ModelCard
from motioncast.core.forecast import Forecast
from motioncast.core.kinematics import fit_rotations
from motioncast.errors import FormatError, InputError, MotioncastError
from motioncast.formats import npz
from motioncast.formats.files import read_npz
from motioncast.formats.load import load_forecast, load_scene, load_truth, save_scene
from motioncast.testing import walkers

CARD = ModelCard("steps", "A guess", "forecast", "mrt15", 15, 10, 15.0)


@pytest.fixture(scope="module")
def originals(tmp_path_factory) -> dict[str, bytes]:
    """The bytes of one small whole file a format."""
    folder = tmp_path_factory.mktemp("whole")
    scene = fit_rotations(walkers(people=1, frames=3))
    found = {}
    for suffix in ("bvh", "npz", "csv", "trc"):
        (target,) = save_scene(scene, folder / f"a.{suffix}")
        found[suffix] = target.read_bytes()
    samples = np.broadcast_to(scene.positions[-1], (2, 4, 1, 15, 3))
    npz.write_forecast(Forecast(samples, scene, scene.people, CARD), folder / "f.npz", truth=scene)
    found["forecast.npz"] = (folder / "f.npz").read_bytes()
    return found


def one_sentence(error: MotioncastError) -> None:
    text = str(error)
    assert "\n" not in text
    assert len(text) < 700


def damaged(content: bytes, how: str, place: int, junk: bytes) -> bytes:
    place %= len(content)
    if how == "cut":
        return content[:place]
    if how == "flip":
        return content[:place] + bytes([content[place] ^ (1 + junk[0] % 255)]) + content[place + 1 :]
    if how == "insert":
        return content[:place] + junk + content[place:]
    if how == "drop":
        return content[:place] + content[place + 1 + junk[0] :]
    lines = content.split(b"\n")
    line = place % len(lines)
    if how == "drop line":
        return b"\n".join(lines[:line] + lines[line + 1 :])
    return b"\n".join([*lines[:line], lines[line], *lines[line:]])  # twice


HOWS = st.sampled_from(["cut", "flip", "insert", "drop", "drop line", "double line"])


@pytest.mark.parametrize("kind", ["bvh", "npz", "csv", "trc", "forecast.npz"])
@given(how=HOWS, place=st.integers(0, 1 << 20), junk=st.binary(min_size=1, max_size=4))
def test_damage_gives_one_sentence_or_a_sound_scene(originals, tmp_path_factory, kind, how, place, junk):
    path = tmp_path_factory.mktemp("damaged") / f"a.{kind}"
    path.write_bytes(damaged(originals[kind], how, place, junk))
    for reader in (load_scene, load_forecast, load_truth) if kind == "forecast.npz" else (load_scene,):
        try:
            reader(path)
        except MotioncastError as error:
            one_sentence(error)


JSON = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=5),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=5), inner, max_size=3),
    max_leaves=6,
)


@pytest.mark.parametrize("kind", ["npz", "forecast.npz"])
@given(data=st.data())
def test_every_entry_of_the_meta_text_is_checked(originals, tmp_path_factory, kind, data):
    path = tmp_path_factory.mktemp("meta") / "a.npz"
    path.write_bytes(originals[kind])
    arrays = read_npz(path)
    meta = json.loads(str(arrays["meta"]))
    part = meta
    while True:
        name = data.draw(st.sampled_from(sorted(part)))
        if isinstance(part[name], dict) and part[name] and data.draw(st.booleans()):
            part = part[name]
            continue
        break
    if data.draw(st.booleans()):
        del part[name]
    else:
        part[name] = data.draw(JSON)
    np.savez(path, **{**arrays, "meta": np.array(json.dumps(meta))})
    for reader in (load_scene, load_forecast):
        try:
            reader(path)
        except MotioncastError as error:
            one_sentence(error)


@pytest.mark.parametrize("name", ["positions", "observed", "rotations", "offsets"])
@pytest.mark.parametrize("change", ["gone", "text", "object", "nan", "complex", "flat", "longer", "empty"])
def test_every_array_is_checked(originals, tmp_path, name, change):
    path = tmp_path / "a.npz"
    path.write_bytes(originals["npz"])
    arrays = read_npz(path)
    array = arrays.pop(name)
    changed = {
        "gone": None, "text": array.astype(str), "object": array.astype(object), "nan": array * np.nan,
        "complex": array * 1j, "flat": array.ravel(), "longer": np.concatenate([array, array]), "empty": array[:0],
    }[change]  # fmt: skip
    np.savez(path, **arrays, **({} if changed is None else {name: changed}))
    if name == "rotations" and change == "gone":
        assert load_scene(path).rotations is None
        return
    with pytest.raises(FormatError) as caught:
        load_scene(path)
    one_sentence(caught.value)


def test_a_folder_inside_a_zip_goes_nowhere(tmp_path):
    path = tmp_path / "a.npz"
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("../../escaped.npy", b"x" * 100)
    with pytest.raises(FormatError):
        load_scene(path)
    assert [entry.name for entry in tmp_path.iterdir()] == ["a.npz"]


def test_a_member_that_lies_about_its_size_is_refused(tmp_path):
    np.savez_compressed(tmp_path / "a.npz", a=np.zeros(1000))
    content = bytearray((tmp_path / "a.npz").read_bytes())
    at = content.rindex(b"PK\x01\x02") + 24  # the unpacked size in the central directory
    assert int.from_bytes(content[at : at + 4], "little") == 8128
    content[at : at + 4] = (1128).to_bytes(4, "little")
    (tmp_path / "a.npz").write_bytes(content)
    with pytest.raises(FormatError):
        read_npz(tmp_path / "a.npz")


def test_too_many_members_are_refused(tmp_path):
    with zipfile.ZipFile(tmp_path / "a.npz", "w") as archive:
        for number in range(1001):
            archive.writestr(f"{number}.npy", b"")
    with pytest.raises(FormatError, match="1001 arrays"):
        read_npz(tmp_path / "a.npz")


def test_a_scene_is_no_forecast(originals, tmp_path):
    path = tmp_path / "a.npz"
    path.write_bytes(originals["npz"])
    with pytest.raises(FormatError, match=r'schema "motioncast.scene/1"; expected motioncast.forecast/1'):
        load_forecast(path)
    with pytest.raises(InputError, match="no file"):
        load_forecast(tmp_path / "b.npz")


def test_a_forecast_of_people_who_are_not_there_is_refused(originals, tmp_path):
    path = tmp_path / "f.npz"
    path.write_bytes(originals["forecast.npz"])
    arrays = read_npz(path)
    meta = {**json.loads(str(arrays["meta"])), "people": ["eve"]}
    np.savez(path, **{**arrays, "meta": np.array(json.dumps(meta))})
    with pytest.raises(FormatError, match='is of "eve"'):
        load_forecast(path)


def test_a_rate_beyond_all_numbers_is_refused(originals, tmp_path):
    path = tmp_path / "a.npz"
    path.write_bytes(originals["npz"])
    arrays = read_npz(path)
    meta = {**json.loads(str(arrays["meta"])), "fps": 10**400}
    np.savez(path, **{**arrays, "meta": np.array(json.dumps(meta))})
    with pytest.raises(FormatError, match='entry "fps"'):
        load_scene(path)


@pytest.mark.parametrize("suffix", ["bvh", "trc"])
@pytest.mark.parametrize("number", [b"1e308", b"-1e308", b"1e39", b"1e20"])
def test_absurd_numbers_give_one_sentence_and_no_warning(originals, tmp_path, suffix, number):
    rows = originals[suffix].rstrip().split(b"\n")
    words = rows[-1].split(b"\t" if suffix == "trc" else b" ")
    words[3] = number
    path = tmp_path / f"a.{suffix}"
    path.write_bytes(b"\n".join([*rows[:-1], (b"\t" if suffix == "trc" else b" ").join(words), b""]))
    with pytest.raises(InputError) as caught:
        load_scene(path)
    one_sentence(caught.value)


def test_what_zip_says_about_damage_stays_short(originals, tmp_path):
    content = bytearray(originals["npz"])
    at = content.index(b"positions.npy") - 4  # the length of the first member's name
    content[at : at + 2] = (60_000).to_bytes(2, "little")
    (tmp_path / "a.npz").write_bytes(content)
    with pytest.raises(FormatError, match="is damaged") as caught:
        load_scene(tmp_path / "a.npz")
    one_sentence(caught.value)


def test_names_of_every_script_come_back(tmp_path):
    scene = replace(walkers(people=2, frames=3), people=("Zoë 🕺", "日本"), source='a "quoted"\nname', remarks=("ü",))
    save_scene(scene, tmp_path / "a.npz")
    back = load_scene(tmp_path / "a.npz")
    assert (back.people, back.source, back.remarks) == (scene.people, scene.source, scene.remarks)
