"""Where a far goal leads the joints: to the configuration whose tool is nearest to it.

Tracking asks the tool for an acceleration, whatever the joints need for it. With a goal beyond the
arm's reach this is a constant pull at an elbow that stretches: a spring about the singularity,
which nothing damps there, because the tool does not move. So a goal that is far is approached in
the space of the joints, by Newton's steps down the error, which end where it is least.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from fotsmc_pin.compiled import kernel
from fotsmc_pin.control.small_matrices import solve
from fotsmc_pin.control.task_space.mobility import eigen, factor
from fotsmc_pin.control.task_space.tool_rows import SIX

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from fotsmc_pin.control.task_space.tool_rows import GoalRows, PointRows
    from fotsmc_pin.types import Array

TRUST = 1.0
"""Longest step of a joint [rad, m]."""
FLAT = 0.004
"""Least curvature over the largest: what is flat to second order is not so beyond."""
SLIGHT = 0.01
"""Inertia's part of the curvature, over that of a singular value of `σ_0`."""
WORTH = 1e-4
"""Part of the squared error that a step must gain to be made: so joints come to rest."""


@kernel
def weigh(
    X: Array, e: Array, E: Array, kind: NDArray[np.int64], m: int, scale: Array,
    W: Array, pull: Array,
) -> float:  # fmt: skip
    """Write how much of the squared error `E_s = |S e|²` a twist of the tool is, and its pull.

    To second order it changes by `2 f · V + Vᵀ W V`. Of all directions `e` is the way and the turn
    apart, not the screw, whose way grows with the turn: `f = (Rᵀ x, ℓ² θ)`, and `W = diag(1, ℓ²)`,
    no less than the turn's own. Of fewer `f = Eᵀ S² e`, `W = Eᵀ S² E`.

    Args:
        X: pose of the tool in its reference's (4, 3).
        e: error (m,).
        E: its rate (6, 6).
        kind: of the error.
        m: number of directions.
        scale: diagonal of `S` (m,).
        W: (6, 6), overwritten.
        pull: `f` (6,), overwritten.

    Returns:
        The squared error [m²].
    """
    square = 0.0
    if kind[0] == 1:
        for i in range(3):
            pull[i], pull[3 + i] = 0.0, scale[3] * scale[3] * e[3 + i]
            for j in range(3):
                pull[i] += X[j, i] * X[3, j]
            square += X[3, i] * X[3, i] + pull[3 + i] * e[3 + i]
        for i in range(SIX):
            for j in range(SIX):
                W[i, j] = scale[i] * scale[i] if i == j else 0.0
        return square
    for a in range(m):
        square += (scale[a] * e[a]) ** 2
    for i in range(SIX):
        pull[i] = 0.0
        for a in range(m):
            pull[i] += E[a, i] * scale[a] * scale[a] * e[a]
        for j in range(SIX):
            W[i, j] = 0.0
            for a in range(m):
                W[i, j] += scale[a] * scale[a] * E[a, i] * E[a, j]
    return square


@kernel
def curvature(chain: NDArray[np.int64], J: Array, f: Array, C: Array, A: Array, U: Array) -> None:
    """Write how the tool's way bends along its pull: the positive part of `B`.

    As the joints move by `x`, the squared error changes by `2 fᵀ J x + xᵀ (Jᵀ W J + B) x`, with

        B_ij = f_p · (z_i × J_pj) + f_θ · (z_i × z_j) / 2,   i before j,

    which is the stiffness of a chain that hangs in the force `f`. At the end of the reach it is all
    that is left: there the tool moves as `c cos δ`, `J = -c sin δ`, and with `B = c |f| cos δ` a
    step along a long pull is `-δ`. Where `B` is negative, the way bends towards the goal, and is
    taken for straight.

    Args:
        chain: joints that carry the tool (k, 3).
        J: Jacobian of the tool, in the same axes as `f` (6, nv).
        f: the pull (6,).
        C: `B`'s positive part, no less than `FLAT` of its largest (nv, nv), overwritten.
        A: scratch (nv, nv).
        U: scratch (nv, nv).
    """
    n = C.shape[0]
    for i in range(n):
        for j in range(n):
            A[i, j] = C[i, j] = 0.0
    for k in range(chain.shape[0]):
        i = chain[k, 0]
        z0, z1, z2 = J[3, i], J[4, i], J[5, i]
        x0, x1, x2 = f[1] * z2 - f[2] * z1, f[2] * z0 - f[0] * z2, f[0] * z1 - f[1] * z0
        y0, y1, y2 = f[4] * z2 - f[5] * z1, f[5] * z0 - f[3] * z2, f[3] * z1 - f[4] * z0
        for later in range(k, chain.shape[0]):
            j = chain[later, 0]
            bent = x0 * J[0, j] + x1 * J[1, j] + x2 * J[2, j]
            bent += 0.5 * (y0 * J[3, j] + y1 * J[4, j] + y2 * J[5, j])
            A[i, j] = A[j, i] = bent
    eigen(A, n, U)
    largest = 0.0
    for k in range(n):
        largest = max(largest, abs(A[k, k]))
    for k in range(n):
        bent = max(A[k, k], FLAT * largest)
        for i in range(n):
            for j in range(n):
                C[i, j] += bent * U[i, k] * U[j, k]


@kernel
def solve_free(K: Array, held: Array, x: Array) -> None:
    """Replace `x` (nv,) by `K⁻¹ x`, of joints that are not held; `K` as `factor` writes it."""
    for i in range(x.size):
        if held[i] != 0.0:
            x[i] = 0.0
    solve(K, x)


@kernel(is_part=True)
def boxed_step(H: Array, g: GoalRows, K: Array) -> None:
    """Write the step `s` that makes `½ sᵀ H s + gᵀ s` least within `lower ≤ s ≤ upper`.

    Joints that would go beyond their bound are held there, and set free when the others pull them
    back. `K` becomes the factor of `H` without what is held.
    """
    n = g.step.size
    for j in range(n):
        g.held[j] = 0.0
    for _ in range(2 * n):
        for i in range(n):
            is_held = g.held[i] != 0.0
            g.step[i] = 0.0 if is_held else -g.slope[i]
            for j in range(n):
                if is_held or g.held[j] != 0.0:
                    K[i, j] = 1.0 if i == j else 0.0
                    if not is_held:
                        g.step[i] -= H[i, j] * (g.upper[j] if g.held[j] > 0.0 else g.lower[j])
                else:
                    K[i, j] = H[i, j]
        factor(K, n, K)
        solve_free(K, g.held, g.step)
        is_done = True
        for j in range(n):
            if g.held[j] != 0.0:
                g.step[j] = g.upper[j] if g.held[j] > 0.0 else g.lower[j]
            elif g.step[j] > g.upper[j]:
                g.held[j], is_done = 1.0, False
            elif g.step[j] < g.lower[j]:
                g.held[j], is_done = -1.0, False
        if not is_done:
            continue
        for j in range(n):
            slope = g.slope[j]
            for i in range(n):
                slope += H[j, i] * g.step[i]
            if g.held[j] * slope > 0.0:
                g.held[j], is_done = 0.0, False
                break
        if is_done:
            break
    for j in range(n):
        g.step[j] = min(max(g.step[j], g.lower[j]), g.upper[j])


@kernel(is_part=True)
def step_to_nearest(
    g: GoalRows, p: PointRows, chain: NDArray[np.int64], J: Array, M: Array, W: Array, pull: Array,
    square: float, led: Array, drift: Array, threshold: float, posture: float,
    H: Array, C: Array, K: Array,
) -> None:  # fmt: skip
    """Write the step to where the tool is nearest to the goal, and what follows a moving one.

        s = argmin ½ sᵀ H s + (Jᵀ f + ε p M (q ⊖ q_p))ᵀ s,   H = Jᵀ W J + C + ε M

    within the ends of the joints, where `C` is the curvature of the way, and `ε M` is so little
    that only what the tool leaves open is moved by inertia and posture. The step is an honest
    prediction: a joint can brake in time for it. With `Δ` as what it gains of `½ |S e|²`, it is
    scaled down by `1 - w |S e|² / Δ`, so that no joint wanders for next to nothing. Of a goal that
    moves

        lead = H⁻¹ Jᵀ W V_l,   lead_rate = -H⁻¹ Jᵀ W (J̇ v - V̇_l)

    Args:
        g: rows of the goal, overwritten; `lower` and `upper` are given.
        p: rows of the point.
        chain: joints that carry the tool (k, 3).
        J: Jacobian of the point's tool (6, nv).
        M: mass matrix (nv, nv).
        W: weights of a twist (6, 6).
        pull: `f` (6,).
        square: `|S e|²` [m²].
        led: twist of the reference, carried to the tool, `V_l` (6,).
        drift: `J̇ v - V̇_l` (6,).
        threshold: `σ_0` [m].
        posture: `p`, how fast posture is closed over the approach.
        H: overwritten (nv, nv).
        C: overwritten (nv, nv).
        K: overwritten (nv, nv).
    """
    n = g.step.size
    curvature(chain, J, pull, C, H, K)
    heaviest = 0.0
    for i in range(n):
        heaviest = max(heaviest, M[i, i])
    slight = SLIGHT * threshold * threshold / heaviest
    for i in range(n):
        g.slope[i] = g.lead[i] = g.lead_rate[i] = 0.0
        for j in range(n):
            H[i, j] = C[i, j] + slight * M[i, j]
            g.slope[i] += slight * posture * M[i, j] * p.away[j]
    for a in range(SIX):
        for i in range(n):
            g.slope[i] += J[a, i] * pull[a]
            weight = 0.0
            for b in range(SIX):
                weight += W[a, b] * J[b, i]
            g.lead[i] += weight * led[a]
            g.lead_rate[i] -= weight * drift[a]
            for j in range(n):
                H[i, j] += weight * J[a, j]
    boxed_step(H, g, K)
    solve_free(K, g.held, g.lead)
    solve_free(K, g.held, g.lead_rate)
    gain = 0.0
    for i in range(n):
        gain -= g.step[i] * g.slope[i]
        for j in range(n):
            gain -= 0.5 * g.step[i] * H[i, j] * g.step[j]
    gain = max(gain, 0.0)
    for i in range(n):
        g.step[i] *= max(gain - WORTH * square, 0.0) / max(gain, 1e-300)


@kernel(is_part=True)
def approach(
    g: GoalRows, p: PointRows, rate: float, share: float, follow: float, most: float
) -> None:
    """Mix the acceleration of the approach into that of tracking, `p.a`, by its share.

        a = 2ω (r ω/2 s + lead - v),   no more than an approach may ask for,   + follow · lead_rate

    `r ≤ 1` slows all joints alike, so that each keeps to `most` of its velocity limit and can stop
    at the end of its step.
    """
    r = 1.0
    for j in range(g.step.size):
        way = abs(g.step[j])
        if way > 0.0:
            fastest = min(most * p.fastest[j], math.sqrt(p.livest[j] * way))
            r = min(r, 2.0 * fastest / (rate * way))
    for j in range(g.step.size):
        a = rate * (r * rate * g.step[j] + 2.0 * (g.lead[j] - p.v[j]))
        a = min(max(a, -p.livest[j]), p.livest[j]) + follow * g.lead_rate[j]
        p.a[j] = a if share == 1.0 else (1.0 - share) * p.a[j] + share * a
