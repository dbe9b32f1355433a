"""Linear algebra of mass matrices inside kernels: LAPACK's overhead is larger than the work."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from fotsmc_pin.compiled import kernel

if TYPE_CHECKING:
    from fotsmc_pin.types import Array


@kernel
def cholesky(M: Array, factor: Array) -> None:
    """Write `L` of `M = L Lᵀ`, with the inverse of its diagonal on the diagonal.

    `factor` may be `M` itself.
    """
    for i in range(M.shape[0]):
        for j in range(i):
            entry = M[i, j]
            for k in range(j):
                entry -= factor[i, k] * factor[j, k]
            factor[i, j] = entry * factor[j, j]
        entry = M[i, i]
        for k in range(i):
            entry -= factor[i, k] * factor[i, k]
        factor[i, i] = 1.0 / math.sqrt(entry)


@kernel
def solve(factor: Array, x: Array) -> None:
    """Overwrite `x` by `M⁻¹ x`."""
    n = x.size
    for i in range(n):
        for k in range(i):
            x[i] -= factor[i, k] * x[k]
        x[i] *= factor[i, i]
    for i in range(n - 1, -1, -1):
        for k in range(i + 1, n):
            x[i] -= factor[k, i] * x[k]
        x[i] *= factor[i, i]


@kernel
def invert(factor: Array, inverse: Array) -> None:
    """Write `M⁻¹`."""
    n = factor.shape[0]
    for i in range(n):
        for j in range(n):
            inverse[i, j] = 1.0 if i == j else 0.0
        solve(factor, inverse[i])
