"""The tool's mobility, its inverse, and what keeps that bounded where the arm loses a direction.

The tool of an arm with the mass matrix `M = L Lᵀ` has the mobility `Λ⁻¹ = J M⁻¹ Jᵀ = Yᵀ Y`, with
`Y = L⁻¹ Jᵀ`, and the dynamically consistent inverse of its Jacobian is `J̄ = M⁻¹ Jᵀ Λ = L⁻ᵀ Y Λ`.
At a singularity `Λ` is infinite in the direction that is lost.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from fotsmc_pin.compiled import kernel

if TYPE_CHECKING:
    from fotsmc_pin.types import Array

SWEEPS, NEGLIGIBLE = 12, 1e-15
"""Most sweeps of Jacobi's method, and the part of the matrix that is left off its diagonal."""
SMALLEST = 1e-12
"""Smallest pivot of a Cholesky factor, over the largest entry of the diagonal."""
NEAR = 0.01
"""Square of a singular value, over its threshold, below which its mobility is not told by it."""


@kernel
def factor(A: Array, n: int, L: Array) -> None:
    """Write the Cholesky factor of the leading (n, n) of `A` into the lower half of `L`.

    On its diagonal stand the reciprocals, so that whoever uses it divides by nothing.
    """
    largest = 0.0
    for j in range(n):
        largest = max(largest, A[j, j])
    least = SMALLEST * largest + 1e-300
    for j in range(n):
        pivot = A[j, j]
        for k in range(j):
            pivot -= L[j, k] * L[j, k]
        reciprocal = 1.0 / math.sqrt(max(pivot, least))
        L[j, j] = reciprocal
        for i in range(j + 1, n):
            entry = A[i, j]
            for k in range(j):
                entry -= L[i, k] * L[j, k]
            L[i, j] = entry * reciprocal


@kernel
def invert_factor(L: Array, n: int, out: Array) -> None:
    """Write `L⁻¹` of what `factor` wrote into the lower half of `out` (n, n)."""
    for c in range(n):
        out[c, c] = L[c, c]
        for i in range(c + 1, n):
            entry = 0.0
            for k in range(c, i):
                entry -= L[i, k] * out[k, c]
            out[i, c] = entry * L[i, i]


@kernel
def solve_factor(L: Array, J: Array, m: int, Y: Array) -> None:
    """Write `Y = L⁻¹ Jᵀ` into the first `m` columns of `Y`, of the first `m` rows of `J`."""
    for i in range(L.shape[0]):
        for c in range(m):
            Y[i, c] = J[c, i]
        for k in range(i):
            share = L[i, k]
            for c in range(m):
                Y[i, c] -= share * Y[k, c]
        for c in range(m):
            Y[i, c] *= L[i, i]


@kernel
def eigen(A: Array, n: int, U: Array) -> None:
    """Bring the symmetric leading (n, n) of `A` to its eigenvalues, and their vectors into `U`.

    Jacobi's method: `A` becomes diagonal, `U` (n, n) holds the vectors in columns.
    """
    for i in range(n):
        for j in range(n):
            U[i, j] = 1.0 if i == j else 0.0
    for _ in range(SWEEPS):
        off, total = 0.0, 0.0
        for i in range(n):
            total += A[i, i] * A[i, i]
            for j in range(i):
                off += A[i, j] * A[i, j]
        if off <= NEGLIGIBLE * NEGLIGIBLE * total:
            return
        for p in range(n - 1):
            for q in range(p + 1, n):
                if A[p, q] == 0.0:
                    continue
                half = (A[q, q] - A[p, p]) / (2.0 * A[p, q])
                t = math.copysign(1.0, half) / (abs(half) + math.hypot(1.0, half))
                c = 1.0 / math.hypot(1.0, t)
                s = t * c
                for k in range(n):
                    x, y = A[k, p], A[k, q]
                    A[k, p], A[k, q] = c * x - s * y, s * x + c * y
                for k in range(n):
                    x, y = A[p, k], A[q, k]
                    A[p, k], A[q, k] = c * x - s * y, s * x + c * y
                    x, y = U[k, p], U[k, q]
                    U[k, p], U[k, q] = c * x - s * y, s * x + c * y


@kernel
def kept_share(s: float) -> float:
    """Return the share of a direction that is kept: 1 where `s = σ/σ_0 ≥ 1`, 0 at `s = 0`."""
    if s >= 1.0:
        return 1.0
    square = s * s
    return square / (square + (1.0 - square) ** 2)


@kernel
def task_inertia(
    J: Array, L: Array, m: int, scale: Array, threshold: float,
    Y: Array, Lambda: Array, work: Array,
) -> float:  # fmt: skip
    """Write `Y` and `Λ`, damped where a singular value of the scaled Jacobian is small.

    With `S = diag(1 or ℓ)`, which makes rotations ways, and `S J Jᵀ S = Σ σ_i² u_i u_iᵀ`,

        Λ = S (S J M⁻¹ Jᵀ S + Σ γ_i u_i u_iᵀ)⁻¹ S
        γ_i = (1 - s²)² (λ_i + ε c) / (s² + ε),   s = σ_i/σ_0 < 1,   ε = 0.01

    and `γ_i = 0` elsewhere. The mobility `λ_i = u_iᵀ S J M⁻¹ Jᵀ S u_i` goes with `σ_i²`, so that
    of an acceleration along `u_i` about the share `s² / (s² + (1 - s²)²)` is kept; `c` is the
    mean of `λ_j / s_j²` over all directions, and keeps `γ_i` continuous through `σ_i = 0`. The
    singular values are computed only where `tr (S J Jᵀ S)⁻¹ ≥ 1/σ_0²`, which every `σ_i < σ_0`
    implies.

    Args:
        J: Jacobian of the directions, its first `m` rows (m, nv).
        L: Cholesky factor of the mass matrix, as `factor` writes it (nv, nv).
        m: number of directions.
        scale: diagonal of `S` (m,).
        threshold: `σ_0` [m].
        Y: its first `m` columns are overwritten (nv, nv).
        Lambda: (m, m), overwritten.
        work: at least (30, 6), overwritten.

    Returns:
        The smallest share of a direction that is kept.
    """
    n = L.shape[0]
    A, G, F, inverse, U = work[:6], work[6:12], work[12:18], work[18:24], work[24:30]
    solve_factor(L, J, m, Y)
    for a in range(m):
        for b in range(a + 1):
            mobility, square = 0.0, 0.0
            for i in range(n):
                mobility += Y[i, a] * Y[i, b]
                square += J[a, i] * J[b, i]
            both = scale[a] * scale[b]
            A[a, b] = A[b, a] = both * mobility
            G[a, b] = G[b, a] = both * square
    factor(G, m, F)
    trace = 0.0
    invert_factor(F, m, inverse)
    for a in range(m):
        for b in range(a + 1):
            trace += inverse[a, b] * inverse[a, b]
    kept = 1.0
    if trace * threshold * threshold >= 1.0:
        eigen(G, m, U)
        mobility, square = 0.0, 0.0
        for a in range(m):
            mobility += A[a, a]
            square += G[a, a]
        mean = mobility / square * threshold * threshold
        for i in range(m):
            s = math.sqrt(max(G[i, i], 0.0)) / threshold
            if s >= 1.0:
                continue
            along = 0.0
            for a in range(m):
                for b in range(m):
                    along += U[a, i] * A[a, b] * U[b, i]
            F[0, i] = (along + NEAR * mean) / (s * s + NEAR) * (1.0 - s * s) ** 2
            kept = min(kept, kept_share(s))
        for i in range(m):
            if G[i, i] >= threshold * threshold:
                continue
            for a in range(m):
                for b in range(m):
                    A[a, b] += F[0, i] * U[a, i] * U[b, i]
    factor(A, m, F)
    invert_factor(F, m, inverse)
    for a in range(m):
        for b in range(a + 1):
            entry = 0.0
            for k in range(a, m):
                entry += inverse[k, a] * inverse[k, b]
            Lambda[a, b] = Lambda[b, a] = scale[a] * scale[b] * entry
    return kept


@kernel(is_part=True)
def to_joints(L: Array, Y: Array, Lambda: Array, m: int, x: Array, out: Array, f: Array) -> None:
    """Write `J̄ x = L⁻ᵀ Y Λ x` (nv,); `f` becomes `Λ x` (m,)."""
    n = L.shape[0]
    for a in range(m):
        f[a] = 0.0
        for b in range(m):
            f[a] += Lambda[a, b] * x[b]
    for i in range(n - 1, -1, -1):
        entry = 0.0
        for a in range(m):
            entry += Y[i, a] * f[a]
        for k in range(i + 1, n):
            entry -= L[k, i] * out[k]
        out[i] = entry * L[i, i]
