"""Torque limits, and memory that does not wind up behind them."""

from __future__ import annotations

from fotsmc_pin.compiled import kernel


@kernel
def clip(x: float, limit: float) -> float:
    """`x` within ±`limit`."""
    return min(max(x, -limit), limit)


@kernel
def unwound(w: float, excess: float, gain: float) -> float:
    """Return the integrand that the actuator could follow, between 0 and `w`.

    The command was `base - gain * w` and passed its limit by `excess` (signed). Of `w` only as much
    enters the memory as brings the command back to the limit, and never with its sign reversed:
    back-calculation, bounded by conditional integration.
    """
    reduced = w + excess / gain
    if w >= 0.0:
        return min(max(reduced, 0.0), w)
    return max(min(reduced, 0.0), w)
