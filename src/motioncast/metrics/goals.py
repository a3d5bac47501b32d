"""Errors and spread of sampled characteristic poses, as in Diller, Funkhouser and Dai (CVPR 2022), Sec. 3.6.

Poses are ``(samples, goals, joints, 3)`` metres, each centred on its own hip, the most likely goal first. A distance of
two poses is the mean distance of their joints; the paper's Eq. 3.3 prints a square, its code and this have none.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import combinations

import numpy as np

from motioncast.metrics.position import joint_errors

DIVERSITY_WEIGHTS = {"elbow": 2.0, "wrist": 2.0}
"""What the release multiplies distances of these joints of Human3.6M by in its diversity, before the mean."""

PARTS: dict[str, tuple[str, ...]] = {
    "right arm": ("right_shoulder", "right_elbow", "right_wrist"),
    "left arm": ("left_shoulder", "left_elbow", "left_wrist"),
    "right leg": ("right_hip", "right_knee", "right_ankle"),
    "left leg": ("left_hip", "left_knee", "left_ankle"),
    "spine": ("pelvis", "middle_spine", "neck_base"),
    "head": ("nose", "head_top"),
}
"""Parts of the body as the paper's Table 3.9 divides the 17 joints."""


def mpjpe_of_best(poses: np.ndarray, truth: np.ndarray) -> np.ndarray:
    """Mean joint error of the goal that is nearest to the truth, ``(samples,)`` metres: what the paper prints.

    It falls with the number of goals whatever they are; it compares only sets of the same size.

    Args:
        poses: ``(samples, goals, joints, 3)``.
        truth: ``(samples, joints, 3)``.

    Example:
        >>> mpjpe_of_best(np.array([[[[3.0, 4, 0]], [[0, 1, 0]]]]), np.zeros((1, 1, 3)))
        array([1.])
    """
    return joint_errors(poses, truth[:, None]).mean(-1).min(-1)


def mpjpe_of_most_likely(poses: np.ndarray, truth: np.ndarray) -> np.ndarray:
    """Mean joint error of the first goal, ``(samples,)`` metres; shapes as in :func:`mpjpe_of_best`.

    Example:
        >>> mpjpe_of_most_likely(np.array([[[[3.0, 4, 0]], [[0, 1, 0]]]]), np.zeros((1, 1, 3)))
        array([5.])
    """
    return joint_errors(poses[:, 0], truth).mean(-1)


def diversity(poses: np.ndarray, weights: np.ndarray | None = None) -> np.ndarray:
    """Mean distance of the pairs of goals, ``(samples,)`` metres; 0 where there is one goal.

    Args:
        poses: ``(samples, goals, joints, 3)``.
        weights: What each joint's distance is multiplied by before the mean over joints, ``(joints,)``. With
            :func:`diversity_weights` it is most likely what the paper prints.

    Example:
        >>> poses = np.array([0.0, 1.0, 4.0]).reshape(1, 3, 1, 1) * [1.0, 0, 0]
        >>> diversity(poses).round(3), diversity(poses, np.array([2.0])).round(3)  # of 1, 4 and 3
        (array([2.667]), array([5.333]))
    """
    pairs = list(combinations(range(poses.shape[1]), 2))
    if not pairs:
        return np.zeros(len(poses))
    one, other = np.transpose(pairs)
    apart = joint_errors(poses[:, one], poses[:, other])
    return (apart if weights is None else apart * weights).mean((1, 2))


def diversity_weights(landmarks: Sequence[str]) -> np.ndarray:
    """The release's weights of Human3.6M's joints, ``(joints,)``: elbows and wrists count twice.

    Example:
        >>> diversity_weights(["pelvis", "left_wrist"])
        array([1., 2.])
    """
    return np.array([DIVERSITY_WEIGHTS.get(landmark.partition("_")[2], 1.0) for landmark in landmarks])


def conditional_inception_score(probabilities: np.ndarray) -> np.ndarray:
    """How sure a classifier is of each goal and how much its answers differ over the goals of one question.

    exp of the mean over goals of KL(p(y | goal) || p(y)), p(y) the mean over the goals of the same question: from 1,
    all goals alike or none clear, to the smaller of the numbers of goals and classes.

    Args:
        probabilities: Of each class, ``(samples, goals, classes)``.

    Returns:
        ``(samples,)``.

    Example:
        >>> conditional_inception_score(np.array([[[1.0, 0], [0, 1]], [[0.5, 0.5], [0.5, 0.5]]]))
        array([2., 1.])
    """
    p = np.asarray(probabilities, np.float64)
    marginal = p.mean(1, keepdims=True)
    with np.errstate(divide="ignore", invalid="ignore"):
        terms = np.where(p > 0, p * np.log(p / marginal), 0.0)
    return np.exp(terms.sum(-1).mean(-1))


def part_errors(poses: np.ndarray, truth: np.ndarray, landmarks: Sequence[str]) -> Mapping[str, np.ndarray]:
    """Mean joint error of each part of the body, each ``(samples,)`` metres, in the goal whose whole body is nearest.

    Args:
        poses: ``(samples, goals, joints, 3)``.
        truth: ``(samples, joints, 3)``.
        landmarks: What each joint marks.

    Example:
        >>> errors = part_errors(np.ones((1, 1, 2, 3)) * [[3.0], [0]], np.zeros((1, 2, 3)), ["nose", "pelvis"])
        >>> errors["head"].round(3), errors["spine"]
        (array([5.196]), array([0.]))
    """
    errors = joint_errors(poses, truth[:, None])
    best = errors[np.arange(len(errors)), errors.mean(-1).argmin(-1)]
    rows = {part: [landmarks.index(place) for place in places if place in landmarks] for part, places in PARTS.items()}
    return {part: best[:, joints].mean(-1) for part, joints in rows.items() if joints}
