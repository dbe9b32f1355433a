"""Inverse dynamics under torque limits, and memory that does not wind up behind them."""

from __future__ import annotations

from typing import TYPE_CHECKING

from fotsmc_pin.compiled import kernel
from fotsmc_pin.control.functions import clip

if TYPE_CHECKING:
    from fotsmc_pin.types import Array


@kernel
def inverse_dynamics(
    M0: Array, h0: Array, a: Array, effort_limit: Array, tau: Array, excess: Array
) -> None:
    """`τ = M0 a + C0 v + G0` within the limits; `excess` is what was cut off, with its sign."""
    for i in range(a.size):
        wanted = h0[i]
        for j in range(a.size):
            wanted += M0[i, j] * a[j]
        tau[i] = clip(wanted, effort_limit[i])
        excess[i] = wanted - tau[i]


@kernel
def unwound(w: float, excess: float, gain: float) -> float:
    """Return the integrand that the actuator could follow, between 0 and `w`.

    The command was `base - gain * w` and passed its limit by `excess` (signed). Of `w` only as much
    enters the memory as brings the command back to the limit, and never with its sign reversed:
    back-calculation, bounded by conditional integration. At the first sample of an integral the
    gain is 0, and nothing enters whatever it is.
    """
    if gain == 0.0:
        return w
    reduced = w + excess / gain
    if w >= 0.0:
        return min(max(reduced, 0.0), w)
    return max(min(reduced, 0.0), w)


@kernel
def integrated(z: float, rate: float, dt: float, excess: float) -> float:
    """`z` after a tick of `dz/dt = rate`, at rest while that would push further into the limit.

    `z` acts against the command (`a = ... - z`).
    """
    if excess * rate < 0.0:
        return z
    return z + dt * rate
