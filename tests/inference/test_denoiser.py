"""The sampler around a denoiser, which is played by a few lines of arithmetic."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np
import pytest

from motioncast.core.basis_points import POINTS, codes, hip_frame
from motioncast.core.card import ModelCard
from motioncast.core.scene import Scene
from motioncast.core.scene_object import SceneObject
from motioncast.core.skeletons import MRT15
from motioncast.errors import InputError
from motioncast.inference.denoiser import DiffusionForecaster
from motioncast.inference.registry import list_models, load
from motioncast.testing import Check, checks, walkers

CARD = ModelCard(
    "toy", "SAST", "forecast", "mrt15", history=25, horizon=30, fps=25.0, stochastic=True, parameters=1,
    diffusion={"steps": 1000, "shift": 0.0, "sampler": "dpm-solver++", "sampling_steps": 4},
)  # fmt: skip

TABLE = SceneObject("table 1", "table", "box", (1.6, 0.8, 0.7), (2.0, 1.0, 0.35))


@dataclass
class Objects:
    """Stands for the graph that reads objects: how near each one is."""

    asked: list[dict[str, np.ndarray]] = field(default_factory=list)

    def run(self, outputs: None, inputs: dict[str, np.ndarray]) -> list[np.ndarray]:
        self.asked.append(inputs)
        return [inputs["codes"][..., :POINTS].min(-1, keepdims=True)]


@dataclass
class Denoiser:
    """Stands for the graph that denoises: everybody walks on, a little towards the others, slower near things."""

    asked: list[dict[str, np.ndarray]] = field(default_factory=list)
    answered: list[np.ndarray] = field(default_factory=list)

    def run(self, outputs: None, inputs: dict[str, np.ndarray]) -> list[np.ndarray]:
        self.asked.append(inputs)
        history, noisy = inputs["history"], inputs["noisy"]
        people, frames = noisy.shape[:2]
        ahead = np.arange(1, frames + 1)[:, None]
        turn = np.zeros((people, 3, 3))  # from a person's own frame to the world
        cosine, sine = hip_frame(history[-1], MRT15)[1].T
        turn[:, 0, 0], turn[:, 0, 1], turn[:, 1, 0], turn[:, 1, 1], turn[:, 2, 2] = cosine, -sine, sine, cosine, 1
        here = history.mean(2)
        others = (1 - np.eye(people)) / max(1, people - 1)
        apart = (
            np.einsum("pq,fqa->pfa", others, inputs["estimate"].mean(2))
            - others.sum(1)[:, None, None] * here[-1][:, None]
        )
        near = np.where(inputs["objects"], inputs["memory"][..., 0], 1).min(1)
        path = ahead * (here[-1] - here[-5])[:, None] / 4 * near[:, None, None] + 0.05 * ahead / frames * apart
        clean = np.einsum("pba,pfb->pfa", turn, path)[:, :, None] + 0.1 * (ahead / frames)[:, None] * noisy
        future = history[-1] + np.einsum("pab,pfjb->fpja", turn, clean)
        self.answered.append(future.astype(np.float32))
        return [clean.astype(np.float32), self.answered[-1]]


def toy(**changed) -> tuple[DiffusionForecaster, Objects, Denoiser]:
    objects, denoiser = Objects(), Denoiser()
    return DiffusionForecaster(CARD, Path("toy.onnx"), _opened=[objects, denoiser], **changed), objects, denoiser  # pyright: ignore[reportArgumentType]


def room(**changed) -> Scene:
    return replace(walkers(frames=60, fps=30), objects=(TABLE,), **changed)


@pytest.mark.parametrize("check", checks(toy()[0]), ids=str)
def test_contract(check: Check) -> None:
    check()


def test_everybody_sees_the_others_as_they_were_taken_to_be_a_step_ago() -> None:
    model, _, denoiser = toy()
    model.forecast(room())
    first, *later = [inputs["estimate"] for inputs in denoiser.asked]
    np.testing.assert_array_equal(first, np.repeat(denoiser.asked[0]["history"][-1:], CARD.horizon, 0))
    assert len(later) == 3
    for shown, answered in zip(later, denoiser.answered, strict=False):
        np.testing.assert_array_equal(shown, answered)
    levels = [float(inputs["level"]) for inputs in denoiser.asked]
    assert levels == sorted(levels)
    assert -10.2 < levels[0] < -9


def test_objects_are_read_once_and_as_each_person_sees_them() -> None:
    model, objects, denoiser = toy()
    scene = room()
    model.forecast(scene, samples=3)
    (asked,) = objects.asked
    assert asked["codes"].shape == (3, 1, 2061)
    assert len(denoiser.asked) == 12
    expected = codes([TABLE], *hip_frame(scene.positions[-1], MRT15))
    np.testing.assert_allclose(asked["codes"], expected, atol=1e-5)
    plain, objects, _ = toy()
    plain.forecast(walkers(frames=60, fps=30))
    assert objects.asked[0]["codes"].shape == (3, 1, 2061)
    assert not objects.asked[0]["objects"].any()


def test_a_room_upstairs_is_a_room() -> None:
    here, there = toy()[0].forecast(room()), np.array([30.0, -20.0, 3.0], np.float32)
    upstairs = replace(
        room(), positions=room().positions + there, floor_m=3.0,
        objects=(replace(TABLE, position=TABLE.position + there),),
    )  # fmt: skip
    np.testing.assert_allclose(toy()[0].forecast(upstairs).samples, here.samples + there, atol=1e-4)


def test_samples_differ_and_their_seed_tells_them() -> None:
    model = toy()[0]
    answer = model.forecast(room(), samples=3, seed=5)
    assert np.abs(np.diff(answer.samples, axis=0)).max((1, 2, 3, 4)).min() > 1e-3
    np.testing.assert_array_equal(model.forecast(room(), samples=2, seed=5).samples, answer.samples[:2])
    assert np.abs(model.forecast(room(), seed=6).samples[0] - answer.samples[0]).max() > 1e-3
    assert not answer.warnings


def test_progress_counts_the_passes() -> None:
    told: list[float] = []
    toy()[0].forecast(room(), horizon_s=2.0, samples=2, progress=told.append)
    np.testing.assert_allclose(told, np.arange(1, 17) / 16)  # 2 samples of 2 horizons of 4 steps


def test_beyond_the_horizon_the_last_second_of_the_answer_is_the_history(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("motioncast.inference.denoiser.eased", lambda history, future: future)
    model, objects, denoiser = toy()
    answer = model.forecast(room(), horizon_s=3.4)
    assert answer.samples.shape[1] == 102
    assert "own forecast was taken as history" in answer.warnings[0]
    assert len(objects.asked) == 3
    ends = denoiser.answered[3], denoiser.asked[4]["history"]
    apart = ends[0][-25:] - ends[1]  # each relative to where its people were
    np.testing.assert_allclose(apart, np.broadcast_to(apart[:1, :1, :1], apart.shape), atol=1e-5)


def test_who_was_seen_too_briefly_is_not_shown_to_the_model() -> None:
    model, objects, denoiser = toy()
    scene = room()
    late = scene.observed.copy()
    late[:-3, 1] = False
    answer = model.forecast(replace(scene, observed=late), samples=2)
    assert answer.guessed.tolist() == [False, True, False]
    assert denoiser.asked[0]["history"].shape[1] == len(objects.asked[0]["codes"]) == 2
    pair = toy()[0].forecast(scene.select((scene.people[0], scene.people[2])), samples=2)
    np.testing.assert_allclose(answer.samples[:, :, [0, 2]], pair.samples, atol=1e-5)
    nobody = scene.observed.copy()
    nobody[:-3] = False
    alone = toy()[0].forecast(replace(scene, observed=nobody), samples=2)
    assert alone.guessed.all()
    assert len(alone.samples) == 2


def test_a_stream_knows_the_room() -> None:
    scene = room()[-40:]
    live = toy(steps=1)[0].stream(30, horizon_s=0.5, objects=scene.objects)
    for pose in scene.positions:
        answer = live.push(dict(zip(scene.people, pose, strict=True)))
    assert answer is not None
    np.testing.assert_array_equal(answer.samples, toy(steps=1)[0].forecast(scene, horizon_s=0.5).samples)
    assert (
        np.abs(answer.samples - toy(steps=1)[0].forecast(replace(scene, objects=()), horizon_s=0.5).samples).max()
        > 0.01
    )


def test_sampler_and_steps_can_be_chosen() -> None:
    model, _, denoiser = toy()
    assert (model.sampler, model.steps) == ("dpm-solver++", 4)
    chosen = model.sampled_by("ddim", 7)
    chosen.forecast(room())
    assert len(denoiser.asked) == 7
    assert chosen.sampled_by(None, None) == chosen
    with pytest.raises(InputError, match="use one of ddpm, ddim"):
        model.sampled_by("euler", None)
    with pytest.raises(InputError, match="takes 1 to 1000"):
        model.sampled_by(None, 1001)


def test_a_model_that_denoises_is_found_by_its_card_and_counted_once(tmp_path: Path, monkeypatch) -> None:
    monkeypatch.setenv("MOTIONCAST_HOME", str(tmp_path))
    for name in ("toy.onnx", "toy.scene.onnx"):
        (tmp_path / name).write_bytes(b"no graph")
    (tmp_path / "toy.json").write_text(replace(CARD, checksum="0").to_json(), encoding="utf-8")
    assert [card.name for card in list_models()].count("toy") == 1
    model = load("toy")
    assert isinstance(model, DiffusionForecaster)
    with pytest.raises(InputError, match=r"toy\.scene\.onnx or .* is damaged"):
        model.forecast(room())
    (tmp_path / "toy.scene.onnx").unlink()
    with pytest.raises(InputError, match=r"no file .*toy\.scene\.onnx"):
        model.forecast(room())


def test_the_first_steps_go_on_with_the_last_one_seen_and_the_rest_is_as_it_was() -> None:
    from motioncast.inference.denoiser import eased

    seconds = np.arange(25)[:, None, None, None] / 25
    history = seconds * np.array([1.0, 0.5, 0.0])
    future = history[-1] + np.sin(np.arange(1, 251) / 9)[:, None, None, None] * np.array([0.0, -0.3, 0.1])
    whole = np.concatenate([history, eased(history, future)])
    jumps = np.linalg.norm(np.diff(whole, n=2, axis=0), axis=-1)[:, 0, 0]
    abrupt = np.linalg.norm(np.diff(np.concatenate([history, future]), n=2, axis=0), axis=-1)[:, 0, 0]
    assert jumps[23:30].max() < 0.5 * abrupt[23:30].max()
    np.testing.assert_allclose(whole[75:], future[50:], atol=1e-4)
