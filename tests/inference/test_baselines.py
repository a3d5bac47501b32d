from __future__ import annotations

import numpy as np
import pytest

from motioncast.core.scene import Scene
from motioncast.core.skeletons import MRT15, SOMOF13
from motioncast.errors import InputError, SceneError
from motioncast.inference.baselines import SimpleGuess
from motioncast.testing import walkers

NECK, PELVIS = MRT15.index("neck"), 0


def ask(name: str, scene: Scene, horizon_s: float = 3.0) -> np.ndarray:
    return SimpleGuess(name).forecast(scene, horizon_s=horizon_s).samples[0]


def test_definitions_at_their_own_rate() -> None:
    scene = walkers(frames=20)
    past, last = scene.positions.astype(np.float64), scene.positions[-1]
    for frame in (0, 4, 44):
        ahead = frame + 1
        expected = {
            "zero-velocity": last,
            "constant-velocity": last + ahead * (past[-1] - past[-2]),
            "neck-velocity": last + ahead * np.diff(past[-4:, :, NECK], axis=0).mean(0)[:, None],
            "root-velocity-damped": last
            + sum(0.95**k for k in range(ahead)) * np.diff(past[-8:, :, PELVIS], axis=0).mean(0)[:, None],
        }
        for name, positions in expected.items():
            np.testing.assert_allclose(ask(name, scene)[frame], positions, atol=1e-4, err_msg=name)


def test_a_replay_runs_back_to_the_first_pose_it_knows_and_forward_again() -> None:
    scene = walkers(frames=20)
    answer, past = ask("replay", scene), scene.positions
    for frame, then in [(1, -2), (7, -8), (14, -15), (15, -14), (27, -2), (28, -1), (29, -2)]:
        np.testing.assert_allclose(answer[frame - 1], past[then], atol=1e-5)


def test_a_replay_knows_of_no_moment_before_somebody_came() -> None:
    scene = walkers(people=2, frames=20)
    late = scene.observed.copy()
    late[:-3, 1] = False
    answer = ask("replay", Scene(scene.positions, MRT15, 15, late))
    for frame, then in [(1, -2), (2, -3), (3, -2), (4, -1), (5, -2)]:
        np.testing.assert_allclose(answer[frame - 1, 1], scene.positions[then, 1], atol=1e-5)


def test_a_skeleton_without_pelvis_moves_by_its_hips() -> None:
    scene = walkers(frames=20).on(SOMOF13)
    hips = scene.positions[:, :, :2].mean(2)
    step = np.diff(hips[-8:], axis=0).mean(0)
    np.testing.assert_allclose(ask("root-velocity-damped", scene)[0], scene.positions[-1] + step[:, None], atol=1e-4)


def test_history_of_one_frame_stays() -> None:
    scene = walkers(frames=20)[-1:]
    for name in ("neck-velocity", "root-velocity-damped", "constant-velocity"):
        np.testing.assert_allclose(ask(name, scene)[-1], scene.positions[-1], atol=1e-5)


def test_nobody_is_refused() -> None:
    scene = walkers(frames=20)
    with pytest.raises(SceneError, match="nobody"):
        ask("zero-velocity", Scene(scene.positions, MRT15, 15, np.zeros_like(scene.observed)))


def test_who_has_just_come_goes_on_as_fast_as_seen() -> None:
    scene = walkers(people=2, frames=20)
    late = scene.observed.copy()
    late[:-3, 1] = False
    positions = np.where(late[..., None], scene.positions, 0)
    answer = ask("root-velocity-damped", Scene(positions, MRT15, 15, late))
    step = (scene.positions[-1, 1, PELVIS] - scene.positions[-3, 1, PELVIS]) / 2
    np.testing.assert_allclose(answer[0, 1], scene.positions[-1, 1] + step, atol=1e-4)


def test_a_joint_that_was_never_seen_stays_with_its_body() -> None:
    scene = walkers(people=1, frames=20)
    unseen = scene.observed.copy()
    unseen[:, 0, 3] = False
    far = Scene(scene.positions + np.float32(30), MRT15, 15, unseen)
    assert np.linalg.norm(ask("zero-velocity", far)[0, 0, 3] - far.positions[-1, 0, 0]) < 1.0


def test_fewer_than_one_future_is_refused() -> None:
    with pytest.raises(InputError, match="at least 1"):
        SimpleGuess("zero-velocity").forecast(walkers(), samples=0)
