"""The contract of a model: what must happen to its answer when the question changes.

    from motioncast.testing import checks

    @pytest.mark.parametrize("check", checks(model), ids=str)
    def test_my_model(check):
        check()

A published design that cannot hold a check names it, with the reason, in ``card.exceptions``; the check must then
fail, so that an exception which no longer holds is noticed.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from motioncast.core.forecast import Forecast
from motioncast.core.forecaster import Forecaster
from motioncast.core.scene import Scene
from motioncast.errors import SceneError
from motioncast.testing.action_contract import ACTION_CLAUSES
from motioncast.testing.goal_contract import GOAL_CLAUSES
from motioncast.testing.scenes import padded, unseen, walkers

HORIZON_S = 0.8


@dataclass(frozen=True)
class Check:
    """One clause of the contract, to be called.

    Attributes:
        name: Name of the clause.
        model: The model that is checked.
        clause: What is checked.
        exception: Why the model may break the clause, if it may.
    """

    name: str
    model: Any
    clause: Callable[[Any], None]
    exception: str = ""

    def __call__(self) -> None:
        """Check.

        Raises:
            AssertionError: If the clause is broken, or a declared exception does not show.
        """
        if not self.exception:
            self.clause(self.model)
            return
        try:
            self.clause(self.model)
        except AssertionError:
            return
        raise AssertionError(f"{self.name} holds after all; take the exception off the card: {self.exception}")

    def __str__(self) -> str:
        return f"{self.model.card.name}-{self.name}"


def checks(model: Any) -> list[Check]:
    """Every clause of the contract for a model of futures, of goals, or of actions."""
    clauses = {"forecast": CLAUSES, "goals": GOAL_CLAUSES, "actions": ACTION_CLAUSES}[model.card.task]
    exceptions = model.card.exceptions
    unknown = set(exceptions) - set(clauses)
    if unknown:
        raise AssertionError(f"{model.card.name} declares exceptions that are no clauses: {sorted(unknown)}")
    return [Check(name, model, clause, exceptions.get(name, "")) for name, clause in clauses.items()]


def check_forecaster(model: Any) -> None:
    """Check every clause of the contract.

    Raises:
        AssertionError: At the first clause that is broken.
    """
    for check in checks(model):
        check()


def _close(model: Forecaster, one: np.ndarray, other: np.ndarray, what: str) -> None:
    apart = float(np.abs(one.astype(np.float64) - other).max())
    assert apart <= model.card.tolerance_m, f"{what}: {apart * 1000:.3f} mm apart"


def _ask(model: Forecaster, scene: Scene, horizon_s: float = HORIZON_S) -> Forecast:
    return model.forecast(scene, horizon_s=horizon_s)


def moving(model: Forecaster) -> None:
    """A scene moved elsewhere has its answer moved likewise."""
    scene, shift = walkers(), np.array([12.0, -7.0, 0.0], np.float32)
    moved = replace(scene, positions=scene.positions + shift)
    _close(model, _ask(model, moved).samples, _ask(model, scene).samples + shift, "moved scene")


def turning(model: Forecaster) -> None:
    """A scene turned about the vertical has its answer turned likewise."""
    scene, angle = walkers(), 1.1
    matrix = np.array([[np.cos(angle), -np.sin(angle), 0], [np.sin(angle), np.cos(angle), 0], [0, 0, 1]])
    turned = replace(scene, positions=(scene.positions @ matrix.T).astype(np.float32))
    _close(model, _ask(model, turned).samples, _ask(model, scene).samples @ matrix.T, "turned scene")


def reordering(model: Forecaster) -> None:
    """People in another order get their answers in that order."""
    scene = walkers()
    order = [2, 0, 1]
    shuffled = scene.select([scene.people[person] for person in order])
    _close(model, _ask(model, shuffled).samples, _ask(model, scene).samples[:, :, order], "re-ordered people")


def absent_person(model: Forecaster) -> None:
    """A person who was there earlier and has left is not forecast, and changes nothing for the others."""
    scene = walkers()
    left = unseen(scene, (slice(scene.frames // 2, None), 2))
    answer = _ask(model, left)
    assert answer.people == scene.people[:2]
    other = scene.positions.copy()
    other[:, 2] += 3.0
    changed = _ask(model, replace(left, positions=other))
    _close(model, answer.samples, changed.samples, "an absent person's motion")
    _close(model, answer.samples, _ask(model, scene.select(scene.people[:2])).samples, "an absent person")


def padding(model: Forecaster) -> None:
    """A slot for a person who is never seen changes nothing."""
    scene = walkers()
    answer = _ask(model, padded(scene))
    assert answer.people == scene.people
    _close(model, answer.samples, _ask(model, scene).samples, "empty slots")


def not_a_number(model: Forecaster) -> None:
    """What is not a number counts as not seen; numbers beyond reason are refused with a sentence, or answered."""
    scene = walkers()
    answer = _ask(model, unseen(scene, (slice(-4, -2), 0, 14), (3, 1), lost=True))
    assert np.isfinite(answer.samples).all()
    try:
        answer = _ask(model, replace(scene, positions=scene.positions * np.float32(1e30)))
    except SceneError:
        return
    assert np.isfinite(answer.samples).all()


def apart_from_others(model: Forecaster) -> None:
    """A scene is answered as if no other had been asked about: nothing is kept from one to the next."""
    scene = walkers()
    alone = _ask(model, scene).samples
    for other in (walkers(people=5, seed=1), walkers(people=1, seed=2)):
        _ask(model, other)
    np.testing.assert_array_equal(_ask(model, scene).samples, alone)


def one_person(model: Forecaster) -> None:
    """One person alone is a scene."""
    assert _ask(model, walkers(people=1)).samples.shape[2] == 1


def late_person(model: Forecaster) -> None:
    """A person who has just appeared is answered and flagged, or answered by the model; never refused."""
    scene = walkers()
    answer = _ask(model, unseen(scene, (slice(-2), 1)))
    assert answer.people == scene.people
    assert np.isfinite(answer.samples).all()


def frame_rate(model: Forecaster) -> None:
    """The answer comes at the rate of the question, and tells of the same motion."""
    slow, fast = walkers(frames=60, fps=15), walkers(frames=237, fps=60)
    one, other = _ask(model, slow), _ask(model, fast)
    assert (one.fps, other.fps) == (15, 60)
    assert other.samples.shape[1] == round(HORIZON_S * 60)
    apart = np.linalg.norm(one.samples - other.samples[:, 3::4], axis=-1)
    assert apart.mean() < 0.03, f"{apart.mean() * 1000:.0f} mm apart on average"


def seed(model: Forecaster) -> None:
    """The same seed gives the same samples."""
    scene = walkers()
    one, other = (model.forecast(scene, horizon_s=HORIZON_S, seed=3).samples for _ in range(2))
    np.testing.assert_array_equal(one, other)


def question_untouched(model: Forecaster) -> None:
    """The question is not written to."""
    scene = walkers()
    scene.positions.setflags(write=False)
    scene.observed.setflags(write=False)
    before = scene.positions.copy()
    _ask(model, scene)
    np.testing.assert_array_equal(scene.positions, before)


def gaps(model: Forecaster) -> None:
    """Joints that are not seen for a while, or at last, do not make the answer jump or fail."""
    scene = walkers()
    answer = _ask(model, unseen(scene, (slice(-3, None), 0, 14), (slice(-9, -6), 1)))
    assert np.isfinite(answer.samples).all()
    whole = np.linalg.norm(answer.samples - _ask(model, scene).samples, axis=-1)[0]
    assert whole[:, 1].mean() < 0.1, f"three lost frames move the answer by {whole[:, 1].mean() * 1000:.0f} mm"
    step = np.linalg.norm(answer.samples[0, 0, 1] - scene.positions[-1, 1], axis=-1)
    assert step.max() < 0.4, f"the first frame is {step.max() * 1000:.0f} mm from the last pose"


def nobody(model: Forecaster) -> None:
    """A scene whose last frame is empty is refused with a sentence."""
    try:
        _ask(model, unseen(walkers(), (-1,)))
    except SceneError:
        return
    raise AssertionError("nobody was there, and yet an answer came")


def shorter_and_longer(model: Forecaster) -> None:
    """A shorter horizon is the beginning of a longer one; beyond the model's own the answer says so."""
    scene = walkers(frames=120, fps=30)
    whole = model.forecast(scene)
    short = _ask(model, scene)
    np.testing.assert_array_equal(short.samples, whole.samples[:, : short.samples.shape[1]])
    longer = model.forecast(scene, horizon_s=whole.horizon_s * 1.5)
    assert longer.samples.shape[1] == round(whole.horizon_s * 1.5 * scene.fps)
    assert longer.warnings or not model.card.parameters, "rolled on without a word"


def many_samples(model: Forecaster) -> None:
    """Several futures from a model that has them; one and a sentence from a model that has one."""
    answer = model.forecast(walkers(), horizon_s=HORIZON_S, samples=5)
    if model.card.stochastic:
        assert len(answer.samples) == 5
    else:
        assert len(answer.samples) == 1
        assert answer.warnings


def rigid_bones(model: Forecaster) -> None:
    """Limbs keep their length within 1 mm."""
    scene = walkers()
    answer = _ask(model, scene)
    for joint, parent in scene.skeleton.bones:
        if scene.skeleton.names[joint].endswith(("knee", "ankle", "elbow", "wrist")):
            now, then = (
                np.linalg.norm(points[..., joint, :] - points[..., parent, :], axis=-1)
                for points in (scene.positions[-1], answer.samples)
            )
            assert np.abs(then - now).max() < 1e-3, scene.skeleton.names[joint]


def no_step_at_now(model: Forecaster) -> None:
    """The answer begins where the history ends: no joint leaps."""
    scene = walkers(frames=120, fps=30)
    leap = np.linalg.norm(_ask(model, scene).samples[0, 0] - scene.positions[-1], axis=-1)
    assert leap.max() < 0.15, f"{leap.max() * 1000:.0f} mm in the first frame"


CLAUSES: dict[str, Callable[[Forecaster], None]] = {
    clause.__name__: clause
    for clause in (
        moving, turning, reordering, absent_person, padding, not_a_number, apart_from_others, one_person,
        late_person, frame_rate, seed, question_untouched, gaps, nobody, shorter_and_longer, many_samples,
        rigid_bones, no_step_at_now,
    )
}  # fmt: skip
"""Every clause by name."""
