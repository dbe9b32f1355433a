"""Fourier series that begin and end every period at rest, for all joints of an arm."""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from scipy.linalg import null_space

if TYPE_CHECKING:
    from fotsmc_pin.types import Array


class RestingSeries:
    """`x(t) = Σ a_k sin(kωt) + b_k cos(kωt)`, `k = 1 … harmonics`, with `ẋ = ẍ = 0` at `t = 0`.

    Rest asks for `Σ k a_k = 0` and `Σ k² b_k = 0`. The free coefficients are those on an
    orthonormal basis of what is left, `2 (harmonics - 1)` of them.

    Args:
        period: of the series [s].
        harmonics: number of frequencies, at least 2.
    """

    def __init__(self, period: float, harmonics: int) -> None:
        self.period, self.harmonics = period, harmonics
        self.omega = 2.0 * np.pi / period * np.arange(1, harmonics + 1)

    @cached_property
    def free(self) -> Array:
        """From free coefficients to `a_1 … a_H, b_1 … b_H`, (2H, 2 (H - 1))."""
        h, k = self.harmonics, np.arange(1.0, self.harmonics + 1)
        table = np.zeros((2 * h, 2 * (h - 1)))
        table[:h, : h - 1] = null_space(k[None])
        table[h:, h - 1 :] = null_space(k[None] ** 2)
        # The sign of a null space's basis is the library's choice; fix it.
        signs = np.sign(table[np.abs(table).argmax(axis=0), np.arange(table.shape[1])])
        table *= signs
        return table

    def basis(self, t: Array) -> tuple[Array, Array, Array]:
        """Return what turns `a, b` into `x`, `ẋ` and `ẍ` at the times `t`, (N, 2H) each."""
        w = self.omega
        phase = np.outer(t, w)
        sine, cosine = np.sin(phase), np.cos(phase)
        return (
            np.hstack([sine, cosine]),
            np.hstack([w * cosine, -w * sine]),
            np.hstack([-(w**2) * sine, -(w**2) * cosine]),
        )
