"""A generalized-momentum observer of what acts on the joints beyond the nominal model."""

from __future__ import annotations

from typing import TYPE_CHECKING

from fotsmc_pin.compiled import kernel

if TYPE_CHECKING:
    from fotsmc_pin.types import Array


@kernel
def observe(
    dt: float, M0: Array, h0: Array, v: Array, last_v: Array, tau: Array, rate: float, d: Array
) -> None:
    """Move the estimate `d` (nv,) [N·m] by one tick.

    Over a tick the momentum that the arm gained, `M0 (v - v_last)`, less what the applied torque
    and the nominal `h0 = C0 v + G0` explain, is what the unknown torque gave it:

        d_k = M0 (v - v_last) / dt + h0 - τ,    ḋ = rate (d_k - d).

    The low-pass takes in no derivative of `M0`: the balance is that of one tick, so that the
    `C0ᵀ v` of the observer in continuous time cancels.

    Args:
        dt: time since the last tick [s].
        M0: nominal mass matrix (nv, nv).
        h0: nominal `C0 v + G0` (nv,).
        v: speed (nv,).
        last_v: speed a tick ago (nv,).
        tau: torque applied over the tick (nv,).
        rate: bandwidth [rad/s].
        d: the estimate, overwritten.

    Source: De Luca and Mattone, IEEE International Conference on Robotics and Automation, 2003,
    the observer; here in the form of one tick.
    """
    share = rate * dt / (1.0 + rate * dt)
    for i in range(v.size):
        gained = 0.0
        for j in range(v.size):
            gained += M0[i, j] * (v[j] - last_v[j])
        d[i] += share * (gained / dt + h0[i] - tau[i] - d[i])
