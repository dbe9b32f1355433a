"""The arithmetic of the safeguard, as kernels: soft start, safe stop, limits."""

from __future__ import annotations

from typing import TYPE_CHECKING

from fotsmc_pin.compiled import kernel
from fotsmc_pin.control.functions import clip

if TYPE_CHECKING:
    from fotsmc_pin.types import Array

SETTLING = 10.0
"""Damping of the safe stop over the joint's inertia: speed dies in a tenth of a second [1/s]."""


@kernel
def faded(t: float, T: float, e: Array, e_dot: Array, v_d: Array, a_d: Array, way: Array) -> None:
    """Fade an offset out of a reference: `SoftStart` says how.

    Args:
        t: time since the start [s], below `T`.
        T: length of the fade [s].
        e: offset of the configuration at the start (nv,) [rad, m].
        e_dot: offset of the velocity at the start (nv,) [rad/s, m/s].
        v_d: reference velocity (nv,), overwritten by the one to follow.
        a_d: reference acceleration (nv,), overwritten by the one to follow.
        way: what is to be added to the reference configuration (nv,) [rad, m], overwritten.
    """
    u = t / T
    p = 1.0 - u * u * u * (10.0 - 15.0 * u + 6.0 * u * u)
    r = u - u * u * u * (6.0 - 8.0 * u + 3.0 * u * u)
    p_dot = -30.0 * u * u * (1.0 - u) * (1.0 - u)
    r_dot = 1.0 - u * u * (18.0 - 32.0 * u + 15.0 * u * u)
    p_ddot = -60.0 * u * (1.0 - u) * (1.0 - 2.0 * u)
    r_ddot = -u * (36.0 - 96.0 * u + 60.0 * u * u)
    for i in range(e.size):
        way[i] = e[i] * p + T * e_dot[i] * r
        v_d[i] += (e[i] * p_dot + T * e_dot[i] * r_dot) / T
        a_d[i] += (e[i] * p_ddot + T * e_dot[i] * r_ddot) / (T * T)


@kernel
def too_fast(v: Array, fastest: Array) -> bool:
    """Whether a joint is faster than it may be."""
    most = 0.0
    for i in range(v.size):
        most = max(most, abs(v[i]) - fastest[i])
    return most > 0.0


@kernel
def stopping(
    share: float,
    before_stop: Array,
    weight: Array,
    inertia: Array,
    v: Array,
    fastest: Array,
    tau: Array,
) -> None:
    """Write a torque of the safe stop into `tau` (nv,), on the way to compensation and damping.

        τ = (1 - ρ) τ_last + ρ (G0 - 10/s diag(M0) v)

    Args:
        share: `ρ`, how much of the way is done.
        before_stop: the last torque before the stop (nv,).
        weight: `G0` (nv,).
        inertia: diagonal of `M0` (nv,).
        v: velocity (nv,); faster ones than `fastest` count as that.
        fastest: largest speed (nv,).
        tau: overwritten (nv,).
    """
    for i in range(tau.size):
        rest = weight[i] - SETTLING * inertia[i] * clip(v[i], fastest[i])
        tau[i] = (1.0 - share) * before_stop[i] + share * rest


@kernel
def within_rate(tau: Array, last: Array, rate: Array, dt: float) -> None:
    """Keep the torque `tau` (nv,) as near to the last one as its rate allows; inf allows all."""
    for i in range(tau.size):
        step = rate[i] * dt
        tau[i] = min(max(tau[i], last[i] - step), last[i] + step)


@kernel
def within_limits(tau: Array, limit: Array) -> None:
    """Keep the torque `tau` (nv,) within its limits."""
    for i in range(tau.size):
        tau[i] = clip(tau[i], limit[i])
