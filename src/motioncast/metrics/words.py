"""Motion words: short snippets of one person's motion, each in its own frame.

NDMS, UMWR, the Fréchet distance and the realism classifier all read motion as words.
"""

from __future__ import annotations

import numpy as np

WORD = 8
"""Frames of a word of NDMS: 0.32 s at 25 fps."""

HIK29_JOINTS = (0, 1, 2, 4, 5, 7, 8, 16, 17, 18, 19, 20, 21, 26, 27)
"""The joints of Humans in Kitchens' skeleton that its words are made of; hips are 1 and 2 of these, too."""


def motion_words(motion: np.ndarray, hips: tuple[int, int], length: int = WORD, hop: int = 1) -> np.ndarray:
    """All words of a motion, each seen from its own first frame.

    There the middle of the hips is the origin (in x, y and z) and the line from left to right hip runs along x.

    Args:
        motion: ``(..., time, joints, 3)`` metres, z up, one person each.
        hips: Left and right hip.
        length: Frames of a word.
        hop: Frames between the first frames of two words.

    Returns:
        ``(..., words, length, joints, 3)`` of the motion's kind of number.

    Example:
        >>> walk = np.arange(9)[:, None, None] * [0.0, 0.1, 0.0] + [[-0.1, 0, 1], [0.1, 0, 1]]
        >>> words = motion_words(walk, hips=(0, 1))
        >>> words.shape, words[1, 0].round(1).tolist()
        ((2, 8, 2, 3), [[-0.1, 0.0, 0.0], [0.1, 0.0, 0.0]])
    """
    windows = np.lib.stride_tricks.sliding_window_view(motion, length, axis=-3)  # (..., words, joints, 3, length)
    words = np.moveaxis(windows[..., ::hop, :, :, :], -1, -3)
    left, right = (words[..., :1, hip : hip + 1, :] for hip in hips)
    words = words - (left + right) / 2
    across = (right - left)[..., :2]
    length_across = np.linalg.norm(across, axis=-1, keepdims=True)
    # hips straight above one another name no heading: those words stay unturned
    across = np.where(length_across > 1e-9, across / np.maximum(length_across, 1e-9), np.array([1, 0], words.dtype))
    cosine, sine = across[..., 0], across[..., 1]
    x, y, z = np.moveaxis(words, -1, 0)
    return np.stack([cosine * x + sine * y, cosine * y - sine * x, z], -1)


def with_seam(history: np.ndarray, forecast: np.ndarray, length: int = WORD) -> np.ndarray:
    """A forecast after the last ``length - 1`` observed frames, so that its words hold the seam.

    Each forecast frame is then the last frame of one word: word k, counted from 1, ends at frame k.

    Args:
        history: ``(..., time, joints, 3)``, at least ``length - 1`` frames.
        forecast: ``(..., time, joints, 3)``.
        length: Frames of a word.

    Example:
        >>> with_seam(np.zeros((25, 15, 3)), np.zeros((250, 15, 3))).shape
        (257, 15, 3)
    """
    return np.concatenate([history[..., 1 - length :, :, :], forecast], -3)
