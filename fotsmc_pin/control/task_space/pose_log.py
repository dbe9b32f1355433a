"""The error of a pose: the logarithm on SE(3), or a part of it, and how it moves with the tool.

`X = T_d⁻¹ T` is the tool's pose seen from its reference, with rotation `R` (3, 3) and translation
`x` (3,). A tool that moves with the twist `ν` against its reference, in the tool's own axes and
linear part first, changes it by `Ẋ = X ν^`; an error `e(X)` of `m` directions then moves with
`ė = E(X) ν`.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from fotsmc_pin.compiled import kernel

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from fotsmc_pin.types import Array

SMALL = 1e-3
"""Angle below which series stand in for quotients [rad]; their next term is below 1e-15."""
NEARLY_NONE = 3.0 - 0.03**2
"""Trace of a rotation from which on its angle, 0.03 rad at most, is had from its sine."""
NEARBY = 0.02
"""Error below which the derivative of `E` is that of its series [m, rad]."""
PROBE = 1e-5
"""Length of the step by which `E` is differentiated along a twist [m, rad]."""


@kernel
def cross(a: Array, b: Array, out: Array) -> None:
    """Write `a × b`, (3,)."""
    x = a[1] * b[2] - a[2] * b[1]
    y = a[2] * b[0] - a[0] * b[2]
    out[0], out[1], out[2] = x, y, a[0] * b[1] - a[1] * b[0]


@kernel
def twist_product(a: Array, b: Array, out: Array) -> None:
    """Write the cross product of two twists, `(a_ω × b_v + a_v × b_ω, a_ω × b_ω)` (6,)."""
    for i in range(3):
        j, k = (i + 1) % 3, (i + 2) % 3
        out[i] = a[3 + j] * b[k] - a[3 + k] * b[j] + a[j] * b[3 + k] - a[k] * b[3 + j]
        out[3 + i] = a[3 + j] * b[3 + k] - a[3 + k] * b[3 + j]


@kernel
def rotation_log(R: Array, w: Array) -> None:
    """Write the rotation vector of `R` (3, 3) into `w` (3,), right from 0 to π [rad].

    By way of the quaternion, whose largest entry is found first: none of the roots is ill
    conditioned, neither at 0 nor at π.
    """
    trace = R[0, 0] + R[1, 1] + R[2, 2]
    if trace > NEARLY_NONE:
        # ω = (θ / sin θ) · half of what is odd in R: arcsin's series in sin² θ
        square = 0.0
        for i in range(3):
            j, k = (i + 1) % 3, (i + 2) % 3
            w[i] = 0.5 * (R[k, j] - R[j, k])
            square += w[i] * w[i]
        factor = 1.0 + square * (1.0 / 6.0 + square * (3.0 / 40.0 + square * 15.0 / 336.0))
        for i in range(3):
            w[i] *= factor
        return
    big = 3
    for i in range(3):
        if R[i, i] > (trace if big == 3 else R[big, big]):
            big = i
    if big == 3:
        real = 0.5 * math.sqrt(max(1.0 + trace, 0.0))
        w[0] = (R[2, 1] - R[1, 2]) / (4.0 * real)
        w[1] = (R[0, 2] - R[2, 0]) / (4.0 * real)
        w[2] = (R[1, 0] - R[0, 1]) / (4.0 * real)
    else:
        j, k = (big + 1) % 3, (big + 2) % 3
        own = 0.5 * math.sqrt(max(1.0 + R[big, big] - R[j, j] - R[k, k], 0.0))
        w[big] = own
        w[j] = (R[j, big] + R[big, j]) / (4.0 * own)
        w[k] = (R[k, big] + R[big, k]) / (4.0 * own)
        real = (R[k, j] - R[j, k]) / (4.0 * own)
    sign = -1.0 if real < 0.0 else 1.0
    size = math.sqrt(w[0] * w[0] + w[1] * w[1] + w[2] * w[2])
    half = math.atan2(size, abs(real))
    factor = sign * (2.0 * half / size if size > 1e-12 else 2.0)
    for i in range(3):
        w[i] *= factor


@kernel
def quadratic_factor(angle: float) -> tuple[float, float]:
    """Return `k(θ) = 1/θ² - cot(θ/2) / 2θ` and `k'(θ) / θ`."""
    if angle < 0.05:
        s = angle * angle
        return (
            1.0 / 12.0 + s * (1.0 / 720.0 + s * (1.0 / 30240.0 + s / 1209600.0)),
            1.0 / 360.0 + s * (1.0 / 7560.0 + s * (1.0 / 201600.0 + s / 5987520.0)),
        )
    half = 0.5 * angle
    sine = math.sin(half)
    cotangent = math.cos(half) / sine
    factor = 1.0 / (angle * angle) - cotangent / (2.0 * angle)
    slope = -2.0 / angle**3 + cotangent / (2.0 * angle**2) + 1.0 / (4.0 * angle * sine * sine)
    return factor, slope / angle


@kernel
def rotation_rate(w: Array, k: float, out: Array) -> None:
    """Write `J(ω) = 1 + ½ [ω] + k [ω]²` (3, 3), by which `ω̇ = J(ω) ν_ω`."""
    square = w[0] * w[0] + w[1] * w[1] + w[2] * w[2]
    for i in range(3):
        for j in range(3):
            out[i, j] = k * w[i] * w[j]
        out[i, i] += 1.0 - k * square
    for i in range(3):
        a, b = (i + 1) % 3, (i + 2) % 3
        out[a, b] -= 0.5 * w[i]
        out[b, a] += 0.5 * w[i]


@kernel
def pose_log(R: Array, x: Array, e: Array, E: Array, scratch: Array) -> None:
    """Write `log(X)` into `e` (6,) and its rate into `E` (6, 6).

        e = (V(ω)⁻¹ x, ω),   V(ω)⁻¹ x = x - ½ ω×x + k ω×(ω×x)

    Args:
        R: rotation of `X` (3, 3).
        x: translation of `X` (3,) [m].
        e: overwritten.
        E: overwritten.
        scratch: at least (4, 3), overwritten.
    """
    w, wx, wwx = scratch[0], scratch[1], scratch[2]
    rotation_log(R, w)
    angle = math.sqrt(w[0] * w[0] + w[1] * w[1] + w[2] * w[2])
    k, slope = quadratic_factor(angle)
    cross(w, x, wx)
    cross(w, wx, wwx)
    E[:] = 0.0
    rotation_rate(w, k, E[3:, 3:])
    for i in range(3):
        e[i] = x[i] - 0.5 * wx[i] + k * wwx[i]
        e[3 + i] = w[i]
        for j in range(3):
            E[i, j] = E[3 + i, 3 + j]
    # D = ∂(V(ω)⁻¹ x) / ∂ω, then D J(ω)
    inner = w[0] * x[0] + w[1] * x[1] + w[2] * x[2]
    for j in range(3):
        for i in range(3):
            column = k * (w[i] * x[j] - 2.0 * x[i] * w[j]) + slope * wwx[i] * w[j]
            if i == j:
                column += k * inner
            else:
                third = 3 - i - j
                turn = 0.5 * x[third] if (i + 1) % 3 == j else -0.5 * x[third]
                column -= turn
            for c in range(3):
                E[i, 3 + c] += column * E[3 + j, 3 + c]


@kernel
def swing(R: Array, axis: int, e: Array, E: Array) -> None:
    """Write the shortest turn that brings an axis of the reference onto the tool's, and its rate.

    With `n = R u`, the tool's axis `u` as the reference sees it, it is `θ (u × n) / sin θ`,
    `cos θ = u·n`, whose component along `u` is zero: how far the tool has turned about that axis
    does not matter.

    Args:
        R: rotation of `X` (3, 3).
        axis: number of the axis.
        e: components along the two other axes, in cyclic order (2,), overwritten [rad].
        E: its rate (2, 6), overwritten.
    """
    a, b = (axis + 1) % 3, (axis + 2) % 3
    n_a, n_b, n_c = R[a, axis], R[b, axis], R[axis, axis]
    sine = math.hypot(n_a, n_b)
    angle = math.atan2(sine, n_c)
    if sine < SMALL and n_c > 0.0:
        factor, slope = 1.0 + angle * angle / 6.0, -1.0 / 3.0 - 2.0 / 15.0 * angle * angle
    else:
        sine = max(sine, 1e-9)
        factor = angle / sine
        slope = (n_c * factor - 1.0) / (sine * sine)
    e[0], e[1] = -factor * n_b, factor * n_a
    E[:] = 0.0
    # ṅ = R (ν_ω × u)
    for j, other, sign in ((a, b, -1.0), (b, a, 1.0)):
        d_a, d_b, d_c = sign * R[a, other], sign * R[b, other], sign * R[axis, other]
        E[0, 3 + j] = -factor * d_b - slope * d_c * n_b
        E[1, 3 + j] = factor * d_a + slope * d_c * n_a


@kernel
def error_of(R: Array, x: Array, kind: NDArray[np.int64], e: Array, E: Array, s: Array) -> None:
    """Write the error of the chosen directions and its rate.

    Args:
        R: rotation of `X` (3, 3).
        x: translation of `X` (3,) [m].
        kind: what is chosen, as `Directions.code` has it.
        e: error (m,), overwritten [m, rad].
        E: its rate (m, 6), overwritten.
        s: scratch, at least (10, 6), overwritten.
    """
    if kind[0] == 1:
        pose_log(R, x, e, E, s)
        return
    row = 0
    E[:] = 0.0
    for i in range(3):
        if kind[1 + i] == 1:
            e[row] = x[i]
            for j in range(3):
                E[row, j] = R[i, j]
            row += 1
    if kind[4] == 1:
        pose_log(R, x, s[4], s[5:11], s)
        for i in range(3):
            e[row + i] = s[4, 3 + i]
            for j in range(3):
                E[row + i, 3 + j] = s[8 + i, 3 + j]
    elif kind[4] == 2:
        swing(R, kind[5], e[row:], E[row:])


@kernel
def moved(R: Array, x: Array, nu: Array, step: float, R_out: Array, x_out: Array) -> None:
    """Write `X` moved by `step` along the twist `nu` (6,): the turn exact, the way to first order.

    The second order is the same forward and backward, and cancels in a central difference.
    """
    turn = step * math.sqrt(nu[3] * nu[3] + nu[4] * nu[4] + nu[5] * nu[5])
    a = step * (math.sin(turn) / turn if abs(turn) > 1e-12 else 1.0)
    b = step * step * (0.5 - turn * turn / 24.0)
    for i in range(3):
        x_out[i] = x[i] + step * (R[i, 0] * nu[0] + R[i, 1] * nu[1] + R[i, 2] * nu[2])
        r0, r1, r2 = R[i, 0], R[i, 1], R[i, 2]
        # rows of R [w] and R [w]², with [w] the cross product's matrix
        y0, y1, y2 = r1 * nu[5] - r2 * nu[4], r2 * nu[3] - r0 * nu[5], r0 * nu[4] - r1 * nu[3]
        z0, z1, z2 = y1 * nu[5] - y2 * nu[4], y2 * nu[3] - y0 * nu[5], y0 * nu[4] - y1 * nu[3]
        R_out[i, 0] = r0 + a * y0 + b * z0
        R_out[i, 1] = r1 + a * y1 + b * z1
        R_out[i, 2] = r2 + a * y2 + b * z2


@kernel
def small_rate_of_rate(e: Array, e_dot: Array, x: Array, out: Array, s: Array) -> None:
    """Write `Ė x` of a small error of all directions, for a twist `x` (6,).

    With `ad(a) b = a × b` it is `½ ad(ė) x + (ad(ė) ad(e) + ad(e) ad(ė)) x / 12`, the derivative of
    `E = 1 + ½ ad(e) + ad(e)²/12 - …`, whose next term is of fourth order.

    Args:
        e: the error (6,).
        e_dot: its rate (6,).
        x: the twist (6,).
        out: (6,), overwritten.
        s: scratch, at least (3, 6), overwritten.
    """
    across, first, second = s[0], s[1], s[2]
    twist_product(e_dot, x, across)
    twist_product(e, x, out)
    twist_product(e_dot, out, first)
    twist_product(e, across, second)
    for i in range(6):
        out[i] = 0.5 * across[i] + (first[i] + second[i]) / 12.0


@kernel
def rate_of_rate(
    R: Array, x: Array, nu: Array, kind: NDArray[np.int64], out: Array, s: Array
) -> None:
    """Write `Ė` (m, 6), the derivative of `E(X)` as `X` moves along the twist `nu` (6,).

    By central differences over 1e-5 m or rad, which leaves an error of some 1e-10 of `Ė`.
    """
    size = 0.0
    for i in range(6):
        size += nu[i] * nu[i]
    size = math.sqrt(size)
    out[:] = 0.0
    if size < 1e-12:
        return
    step = PROBE / size
    m = out.shape[0]
    R_near, x_near, e, E, rest = s[:3, :3], s[3, :3], s[4], s[5:11], s[11:22]
    for sign in (-1.0, 1.0):
        moved(R, x, nu, sign * step, R_near, x_near)
        error_of(R_near, x_near, kind, e[:m], E[:m], rest)
        for i in range(m):
            for j in range(6):
                out[i, j] += sign * E[i, j] / (2.0 * step)
