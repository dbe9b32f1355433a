"""What a law makes of a torque that it shares with another law."""

from __future__ import annotations

from typing import TYPE_CHECKING

from fotsmc_pin.compiled import kernel

if TYPE_CHECKING:
    from fotsmc_pin.control.robust_rows import State, Work
    from fotsmc_pin.types import Array

CLOSE = 1e-6
"""Square of the residual over that of the torque, at which the acceleration is close enough."""


@kernel
def accelerated(M0: Array, tau: Array, m: State, w: Work) -> None:
    """Write the acceleration `(M0 + J + δ)⁻¹ τ` that a torque beyond the law's adds, into `w.more`.

    With `M0 + J + δ`, by which the law turns changes of its command into torque, what it learns
    from this acceleration settles at the rate of its observer, whatever the inertias are. Joints
    that friction holds at rest take no part.

    Conjugate gradients: they end after as many steps as there are joints, need no room for a
    matrix, and are not harmed by a mass matrix that is nearly singular.

    Args:
        M0: nominal mass matrix (nv, nv).
        tau: the torque (nv,) [N·m].
        m: state of the law.
        w: work of the law; `S`, `w` and `u` are scratch.
    """
    r, p, Mp = w.S, w.w, w.u
    n = tau.size
    square = 0.0
    for i in range(n):
        w.more[i] = 0.0
        r[i] = 0.0 if m.rest[i] * m.held[i] > 0.0 else tau[i]
        p[i] = r[i]
        square += r[i] * r[i]
    least = CLOSE * square
    for _ in range(n):
        if square <= least:
            return
        along = 0.0
        for i in range(n):
            Mp[i] = 0.0
            if m.rest[i] * m.held[i] > 0.0:
                continue
            Mp[i] = (m.J[i] + m.delta[i]) * p[i]
            for j in range(n):
                Mp[i] += M0[i, j] * p[j]
            along += p[i] * Mp[i]
        step, last, square = square / along, square, 0.0
        for i in range(n):
            w.more[i] += step * p[i]
            r[i] -= step * Mp[i]
            square += r[i] * r[i]
        for i in range(n):
            p[i] = r[i] + square / last * p[i]
