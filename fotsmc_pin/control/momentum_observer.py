"""A generalized-momentum observer of what acts on the joints beyond the nominal model."""

from __future__ import annotations

from typing import TYPE_CHECKING

from fotsmc_pin.compiled import kernel

if TYPE_CHECKING:
    from fotsmc_pin.types import Array


@kernel
def unexplained(
    dt: float, M0: Array, h0: Array, J: Array, v: Array, last_v: Array, tau: Array, lacking: Array
) -> None:
    """Write the torque `τ - (M0 + J) (v - v_last) / dt - h0` over the last tick into `lacking`.

    Over a tick the momentum that the arm gained is what the applied torque gave it, less the
    nominal `h0 = C0 v + G0` and what the model does not know. The balance is that of one tick, so
    that the `C0ᵀ v` of the observer in continuous time cancels.

    Args:
        dt: time since the last tick [s].
        M0: nominal mass matrix (nv, nv).
        h0: nominal `C0 v + G0` (nv,).
        J: inertia beyond the nominal one on the diagonal (nv,) [kg·m²].
        v: speed (nv,).
        last_v: speed a tick ago (nv,).
        tau: torque applied over the tick (nv,).
        lacking: the result (nv,) [N·m], overwritten.

    Source: De Luca and Mattone, IEEE International Conference on Robotics and Automation, 2003,
    the observer; here in the form of one tick.
    """
    for i in range(v.size):
        gained = J[i] * (v[i] - last_v[i])
        for j in range(v.size):
            gained += M0[i, j] * (v[j] - last_v[j])
        lacking[i] = tau[i] - gained / dt - h0[i]


@kernel
def smooth(dt: float, rate: float, lacking: Array, d: Array) -> None:
    """Move the disturbance torque `d` (nv,) [N·m] by one tick: `ḋ = rate (-lacking - d)`."""
    share = rate * dt / (1.0 + rate * dt)
    for i in range(d.size):
        d[i] -= share * (lacking[i] + d[i])
