"""The discrete cosine transform over time, as a matrix."""

from __future__ import annotations

import math

import torch
from torch import Tensor


def exact(values: Tensor, matrix: Tensor) -> Tensor:
    """The product ``values @ matrix`` in float32, also where matrices are multiplied in bf16 otherwise.

    A bf16 transform would move joints by a centimetre.
    """
    with torch.autocast(values.device.type, enabled=False):
        return values.float() @ matrix


def dct_matrix(length: int) -> Tensor:
    """The orthonormal DCT-II of Eq. 1-2 (SoMoFormer), ``(coefficients, time)``; its transpose inverts it (Eq. 3).

    Example:
        >>> matrix = dct_matrix(8)
        >>> bool(torch.allclose(matrix @ matrix.T, torch.eye(8), atol=1e-6))
        True
    """
    time = torch.arange(length, dtype=torch.float64)
    order = time[:, None]
    matrix = math.sqrt(2 / length) * torch.cos(math.pi / (2 * length) * (2 * time + 1) * order)
    matrix[0] /= math.sqrt(2)
    return matrix.float()
