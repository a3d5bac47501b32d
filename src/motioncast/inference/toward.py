"""Futures that end in a goal: a model of trajectories led to the poses of a model of goals.

A goal says how a body is held, not where it stands, and not when. Here it is reached at the end of the forecast. The
model of trajectories says how people get there: where they go, which way they look, which foot stands. A denoiser is
led while it denoises; the answer of any other model is turned into the goal, with bones at their length and standing
feet kept.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from motioncast.core.basis_points import hip_frame
from motioncast.core.forecast import Forecast
from motioncast.core.forecaster import Forecaster, Progress
from motioncast.core.goal_poses import GoalPoses
from motioncast.core.limbs import middle_joint
from motioncast.core.skeleton import Skeleton
from motioncast.core.voxels import turned, turned_back
from motioncast.errors import SceneError
from motioncast.inference.denoiser import DiffusionForecaster
from motioncast.inference.lift import keep_lengths, last_pose, rigid_bones

REACH_M_S = 0.8
"""A hand comes to a goal about so fast on average, where no model of trajectories says when."""

QUICKEST_S, LINGER_S = 0.5, 0.5
"""No goal is reached sooner than this, and it is held so long."""

STANDS_M_S = 0.3
"""A foot that is slower than this stands."""

STAYS_M = 0.15
"""A standing foot does not take a step for less than this."""

LIFT_M = 0.06
"""How high a foot is lifted for a step."""


def toward(
    model: Forecaster,
    goals: GoalPoses,
    *,
    horizon_s: float | None = None,
    seed: int = 0,
    progress: Progress | None = None,
) -> Forecast:
    """The futures of a model of trajectories, each led to one of the goals; there are as many as goals.

    Args:
        model: The model of trajectories.
        goals: Where the people of a scene may be heading.
        horizon_s: When a goal is reached. Default: the model's horizon.
        seed: Seed of the model's chance.
        progress: Told how much is done.

    Raises:
        SceneError: If the model forecasts other people than the goals are of.
    """
    scene, count = goals.history, len(goals.poses)
    denoises = isinstance(model, DiffusionForecaster)
    asked = model.led_to(goals) if denoises else model
    answer = asked.forecast(scene, horizon_s=horizon_s, samples=count if denoises else 1, seed=seed, progress=progress)
    if answer.people != goals.people:
        raise SceneError(
            f'"{model.card.name}" forecasts {", ".join(answer.people)}; the goals are of {", ".join(goals.people)}, '
            "so ask both about the same scene"
        )
    samples = answer.samples if denoises else np.stack([ended_in(answer.best, pose, goals) for pose in goals.poses])
    told = f'led to the goals of "{goals.card.name}", which has no word on when they are reached: here at the end'
    return replace(
        answer,
        samples=samples,
        weights=together(goals.weights),
        goals=goals,
        radius_m={},
        warnings=(*answer.warnings, *goals.warnings, told),
    )


def into_goals(goals: GoalPoses) -> Forecast:
    """The body as it is now, turned into each goal on the spot, and held there: to be shown, no forecast of when."""
    scene, now = goals.history, last_pose(goals.history.select(goals.people))
    farthest = np.linalg.norm(goals.poses - now, axis=-1).max((1, 2))  # of each goal
    ways = np.maximum(farthest / REACH_M_S, QUICKEST_S)
    frames = round((float(ways.max()) + LINGER_S) * scene.fps)
    samples = []
    for pose, way in zip(goals.poses, ways.tolist(), strict=True):
        arrival = max(1, round(way * scene.fps))
        led = ended_in(np.repeat(now[None], arrival, 0), pose, goals)
        samples.append(np.concatenate([led, np.repeat(led[-1:], frames - arrival, 0)]))
    return Forecast(
        np.stack(samples), scene, goals.people, goals.card, weights=together(goals.weights), carried=goals.carried,
        guessed=goals.guessed, goals=goals, seed=goals.seed, warnings=goals.warnings,
    )  # fmt: skip


def together(weights: np.ndarray) -> np.ndarray:
    """One probability for each rank of goals ``(goals, people)``: as if everybody chose alone, and equal ranks met.

    Example:
        >>> together(np.array([[0.6, 0.5], [0.4, 0.5]])).round(2).tolist()
        [0.6, 0.4]
    """
    logs = np.log(np.maximum(weights, 1e-12)).sum(1)
    odds = np.exp(logs - logs.max())
    return odds / odds.sum()


def ended_in(future: np.ndarray, goal: np.ndarray, goals: GoalPoses) -> np.ndarray:
    """A future turned into a goal, which it reaches in its last frame.

    The body as seen from its hips goes over into the goal; the way over the ground slows down to a halt.

    Args:
        future: ``(time, people, joints, 3)`` metres.
        goal: ``(people, joints, 3)``.
        goals: What the goal is one of.

    Returns:
        As ``future``.
    """
    history = goals.history.select(goals.people)
    skeleton = history.skeleton
    whole = np.concatenate([last_pose(history)[None], future]).astype(np.float64)
    share = rise(np.linspace(0, 1, len(whole)))
    origin, across = hip_frame(whole, skeleton)
    goal_origin, goal_across = hip_frame(goal.astype(np.float64), skeleton)
    own = turned_back(whole - origin[:, :, None], across[:, :, None])
    wanted = turned_back(goal - goal_origin[:, None], goal_across[:, None])
    held = own + share[:, None, None, None] * (wanted - own)
    halting = (share[1:] + share[:-1])[:, None, None] / 2
    steps = np.diff(origin, axis=0) * (1 - halting)
    place = np.concatenate([origin[:1], origin[:1] + steps.cumsum(0)])
    twist = angle(goal_across) - angle(across[0])
    twist = (twist + np.pi) % (2 * np.pi) - np.pi
    facing = np.unwrap(angle(across), axis=0) + share[:, None] * twist
    axis = np.stack([np.cos(facing), np.sin(facing)], -1)
    led = turned(held, axis[:, :, None]) + place[:, :, None]
    led = keep_lengths(led, skeleton, rigid_bones(history))
    for person in range(led.shape[1]):
        for hip, knee, ankle, beyond in legs(skeleton):
            step_by_step(led[:, person], whole[:, person], (hip, knee, ankle), beyond, history.fps)
    return led[1:].astype(np.float32)


def rise(time: np.ndarray) -> np.ndarray:
    """From 0 to 1 within a time of 0 to 1, at rest at both ends, with the least jerk.

    Example:
        >>> rise(np.array([0.0, 0.5, 1.0])).tolist()
        [0.0, 0.5, 1.0]
    """
    return time**3 * (10 - 15 * time + 6 * time**2)


def angle(across: np.ndarray) -> np.ndarray:
    """Direction of horizontal vectors ``(..., 2)``, in radians."""
    return np.arctan2(across[..., 1], across[..., 0])


def legs(skeleton: Skeleton) -> Iterator[tuple[int, int, int, list[int]]]:
    """Hip, knee and ankle of each leg that the skeleton has, and the joints beyond the ankle."""
    for side in ("left", "right"):
        chain = [skeleton.find(f"{side}_{place}") for place in ("hip", "knee", "ankle")]
        if None not in chain:
            hip, knee, ankle = (joint for joint in chain if joint is not None)
            beyond: list[int] = []
            for joint, parent in enumerate(skeleton.parents):
                if parent == ankle or parent in beyond:
                    beyond.append(joint)
            yield hip, knee, ankle, beyond


def step_by_step(
    body: np.ndarray, before: np.ndarray, leg: tuple[int, int, int], beyond: list[int], fps: float
) -> None:
    """Keeps a foot where it stands, and lifts it where it takes a step; changes the leg of ``body`` in place.

    Args:
        body: One person's motion, ``(time, joints, 3)``.
        before: The motion that it was made of: there the foot stands when it stands.
        leg: Hip, knee and ankle.
        beyond: Joints that go with the ankle.
        fps: Frames a second.
    """
    hip, knee, ankle = leg
    path = body[:, ankle].copy()
    speed = np.linalg.norm(np.gradient(before[:, ankle], axis=0), axis=-1) * fps
    stands = speed < STANDS_M_S
    if stands.all() and np.linalg.norm(path[-1] - path[0]) > STAYS_M:  # the goal asks for a step
        share = rise(np.linspace(0, 1, len(path)))[:, None]
        aside = path[0] + share * (path[-1] - path[0])
        aside[:, 2] += 4 * LIFT_M * (share * (1 - share))[:, 0]
        shift = aside - path
    else:
        shift = where_it_stood(path, stands) - path
    upper, lower = (float(np.linalg.norm(body[0, end] - body[0, start])) for start, end in ((hip, knee), (knee, ankle)))
    bend = body[:, knee] - (body[:, hip] + body[:, ankle]) / 2
    body[:, knee], reached = middle_joint(body[:, hip], path + shift, upper, lower, bend)
    body[:, beyond] += (reached - path)[:, None]
    body[:, ankle] = reached


def where_it_stood(path: np.ndarray, stands: np.ndarray) -> np.ndarray:
    """A path ``(time, 3)`` that stays, while the foot stands, where it began to; what that costs fades in the swing.

    Example:
        >>> path = np.arange(6.0)[:, None] * np.ones(3)
        >>> where_it_stood(path, np.array([1, 1, 1, 0, 0, 0], bool))[:, 0].round(2).tolist()
        [0.0, 0.0, 0.0, 1.67, 3.33, 5.0]
    """
    ends = np.flatnonzero(np.diff(np.concatenate([[False], stands, [False]]).astype(int)))
    kept = path.copy()
    for begin, end in ends.reshape(-1, 2):
        kept[begin:end] = path[begin]
        following = ends[ends > end]
        until = int(following[0]) if len(following) else len(path) - 1
        if end < len(path) and until > end - 1:
            lag = path[begin] - path[end - 1]
            fade = np.linspace(1, 0, until - end + 2)[1:, None]
            kept[end : until + 1] += (lag * fade)[: len(path) - end]
    return kept
